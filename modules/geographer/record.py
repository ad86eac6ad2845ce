"""What has been observed so far: likelihoods of junctions, corridors driven or found absent.

Each visit's likelihood is multiplied in once, when the visit is over (design: only the owner
of a variable multiplies, so nothing is counted twice).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bus.grid import JUNCTION_TYPES, STEP, Grid


@dataclass(frozen=True, eq=False)
class Record:
    """Evidence up to now. ``junctions`` (rows, columns, 16), ``corridors`` (corridors, 2)."""

    grid: Grid
    junctions: NDArray[np.float64]
    corridors: NDArray[np.float64]

    def with_junction(self, place: int, likelihood: NDArray[np.float64]) -> Record:
        """One more visit's likelihood for the junction at an intersection.

        Scaled to a largest entry of one: only ratios matter for the belief.
        """
        x, y = self.grid.place(place)
        junctions = self.junctions.copy()
        junctions[y, x] *= likelihood
        junctions[y, x] /= junctions[y, x].max()
        return replace(self, junctions=junctions)

    def with_corridor(self, corridor: int, exists: bool) -> Record:
        """A corridor was driven, or a wall was found in its place."""
        corridors = self.corridors.copy()
        corridors[corridor, int(not exists)] = 0.0
        return replace(self, corridors=corridors)


def nothing(grid: Grid) -> Record:
    """The record before anything was observed."""
    return Record(
        grid,
        np.ones((grid.rows, grid.columns, JUNCTION_TYPES)),
        np.ones((grid.corridors, 2)),
    )


def neighbour(grid: Grid, place: int, direction: int) -> int:
    """The intersection next to a place. Raises ValueError off the grid."""
    x, y = grid.place(place)
    if grid.corridor(x, y, direction) < 0:
        raise ValueError(f"direction {direction} leads off the grid at ({x}, {y})")
    dx, dy = STEP[direction]
    return grid.intersection(x + dx, y + dy)
