"""The order in which the frontier method meets a grid's intersections and corridors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import DIRECTIONS, EAST, JUNCTION_TYPES, NORTH, SOUTH, WEST, Grid

Indices = NDArray[np.int64]

_SWAPPED = {NORTH: EAST, EAST: NORTH, SOUTH: WEST, WEST: SOUTH}


@dataclass(frozen=True)
class Sweep:
    """A sweep along the longer side, so that the frontier runs along the shorter one.

    On a grid with more columns than rows the sweep's north is the grid's east and the other
    way round. By step: `intersections` (steps,) numbers, `north` and `east` (steps,) the map's
    index of the corridors that leave forward, -1 off the grid. `types` (16,) is the grid's
    junction type for each of the sweep's.
    """

    width: int
    intersections: Indices
    types: Indices
    north: Indices
    east: Indices

    @property
    def steps(self) -> int:
        """How many intersections there are to sweep."""
        return len(self.intersections)

    def step_of(self, intersection: int) -> int:
        """The step at which an intersection is met."""
        return int(np.flatnonzero(self.intersections == intersection)[0])

    @classmethod
    def of(cls, grid: Grid) -> Sweep:
        """The sweep of a grid."""
        turned = grid.columns > grid.rows
        numbers = np.arange(grid.intersections).reshape(grid.rows, grid.columns)
        order = (numbers.T if turned else numbers).ravel()
        to_grid = {d: _SWAPPED[d] if turned else d for d in DIRECTIONS}
        types = [sum(to_grid[d] for d in DIRECTIONS if t & d) for t in range(JUNCTION_TYPES)]
        leaving = {d: grid.corridor_table[order, DIRECTIONS.index(to_grid[d])] for d in to_grid}
        width = min(grid.columns, grid.rows)
        return cls(width, order, np.array(types), leaving[NORTH], leaving[EAST])

    def to_steps(self, by_intersection: NDArray[np.float64]) -> NDArray[np.float64]:
        """(intersections, 16) by the grid's types -> (steps, 4, 4) by enter and leave code."""
        return by_intersection[self.intersections][:, self.types].reshape(-1, 4, 4)

    def to_grid(self, by_step: NDArray[np.float64]) -> NDArray[np.float64]:
        """(steps, 4, 4) by enter and leave code -> (intersections, 16) by the grid's types."""
        result = np.empty((self.steps, JUNCTION_TYPES))
        result[self.intersections[:, None], self.types] = by_step.reshape(-1, JUNCTION_TYPES)
        return result

    def to_maps(self, leaves: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Leave codes (maps, steps) -> maps (maps, corridors)."""
        corridors = int(max(self.north.max(), self.east.max())) + 1
        maps = np.zeros((len(leaves), corridors), np.uint8)
        for bit, corridor in enumerate((self.north, self.east)):
            inside = corridor >= 0
            maps[:, corridor[inside]] = leaves[:, inside] >> bit & 1
        return maps

    def to_leaves(self, maps: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Maps (maps, corridors) -> leave codes (maps, steps)."""
        padded = np.concatenate([maps, np.zeros((len(maps), 1), np.uint8)], axis=1)
        leaves: NDArray[np.uint8] = padded[:, self.north] + 2 * padded[:, self.east]
        return leaves

    def to_types(self, leaves: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Leave codes (maps, steps) -> the sweep's junction types (maps, steps)."""
        south = np.pad(leaves, ((0, 0), (self.width, 0)))[:, : self.steps] & 1
        west = np.pad(leaves, ((0, 0), (1, 0)))[:, : self.steps] >> 1
        types: NDArray[np.uint8] = leaves + 4 * south + 8 * west
        return types

    def corridor_probabilities(self, by_step: NDArray[np.float64]) -> NDArray[np.float64]:
        """Probability of each corridor of the map, from (steps, 4, 4) of junction types."""
        leave = by_step.sum(axis=1)
        result = np.empty(int(max(self.north.max(), self.east.max())) + 1)
        for bit, corridor in ((1, self.north), (2, self.east)):
            inside = corridor >= 0
            result[corridor[inside]] = leave[inside, bit] + leave[inside, 3]
        return result
