"""The words that every module shares about the map: grid, corridors, junction types.

A *map* is a non-empty set of corridors of the grid. It is written as one row of 0 and 1
per corridor: first the corridors that run east, row by row from the south, then those that
run north (:attr:`Grid.corridors`). A *junction type* is four bits: N=1, E=2, S=4, W=8.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Maps: TypeAlias = NDArray[np.uint8]
"""One map a row, one corridor a column: shape (maps, corridors)."""

NORTH, EAST, SOUTH, WEST = 1, 2, 4, 8
DIRECTIONS = (NORTH, EAST, SOUTH, WEST)
JUNCTION_TYPES = 16
STEP = {NORTH: (0, 1), EAST: (1, 0), SOUTH: (0, -1), WEST: (-1, 0)}
"""(dx, dy) of one step in a direction, y northward."""

OPPOSITE = {NORTH: SOUTH, EAST: WEST, SOUTH: NORTH, WEST: EAST}
LEFT_OF = {NORTH: WEST, EAST: NORTH, SOUTH: EAST, WEST: SOUTH}
RIGHT_OF = {NORTH: EAST, EAST: SOUTH, SOUTH: WEST, WEST: NORTH}
LETTER = {NORTH: "N", EAST: "E", SOUTH: "S", WEST: "W"}


def type_name(junction_type: int) -> str:
    """The corridors of a junction type as letters, ``"NES"`` say; ``"-"`` for none."""
    return "".join(LETTER[d] for d in DIRECTIONS if junction_type & d) or "-"


@dataclass(frozen=True)
class Grid:
    """The grid lines a building is registered on (paper, section 3).

    Intersections are (x, y) with x from the west and y from the south, or one number
    ``y * columns + x``. Raises ValueError for fewer than one line or a single intersection.
    """

    columns: int
    rows: int

    def __post_init__(self) -> None:
        if self.columns < 1 or self.rows < 1 or self.columns * self.rows < 2:
            raise ValueError(
                f"a grid needs at least one line each way and two intersections, "
                f"got columns={self.columns}, rows={self.rows}"
            )

    @property
    def intersections(self) -> int:
        """How many intersections there are."""
        return self.columns * self.rows

    @property
    def east_corridors(self) -> int:
        """How many corridors run east; they come first in a map."""
        return self.rows * (self.columns - 1)

    @property
    def north_corridors(self) -> int:
        """How many corridors run north; they come last in a map."""
        return (self.rows - 1) * self.columns

    @property
    def corridors(self) -> int:
        """How many corridors there can be: the length of a map."""
        return self.east_corridors + self.north_corridors

    def intersection(self, x: int, y: int) -> int:
        """The number of intersection (x, y)."""
        return y * self.columns + x

    def place(self, intersection: int) -> tuple[int, int]:
        """(x, y) of an intersection's number."""
        return intersection % self.columns, intersection // self.columns

    def corridor(self, x: int, y: int, direction: int) -> int:
        """The index in a map of the corridor that leaves (x, y), or -1 off the grid."""
        if direction == WEST:
            x, direction = x - 1, EAST
        elif direction == SOUTH:
            y, direction = y - 1, NORTH
        if direction == EAST:
            inside = 0 <= x < self.columns - 1 and 0 <= y < self.rows
            return y * (self.columns - 1) + x if inside else -1
        inside = 0 <= x < self.columns and 0 <= y < self.rows - 1
        return self.east_corridors + y * self.columns + x if inside else -1

    def ends(self, corridor: int) -> tuple[int, int]:
        """The two intersections that a corridor joins, the south or west one first."""
        if corridor < self.east_corridors:
            y, x = divmod(corridor, self.columns - 1)
            first = self.intersection(x, y)
            return first, first + 1
        first = corridor - self.east_corridors
        return first, first + self.columns

    @cached_property
    def corridor_table(self) -> NDArray[np.int64]:
        """Corridor index by (intersection, direction number 0..3 = N, E, S, W); -1 off the grid."""
        table = [
            [self.corridor(*self.place(v), direction) for direction in DIRECTIONS]
            for v in range(self.intersections)
        ]
        return np.array(table, dtype=np.int64)

    def possible_types(self, x: int, y: int) -> NDArray[np.bool_]:
        """Which of the 16 junction types fit on the grid at (x, y): no corridor leads off it."""
        off = sum(d for d in DIRECTIONS if self.corridor(x, y, d) < 0)
        return np.array([not t & off for t in range(JUNCTION_TYPES)])

    def junction_types(self, maps: Maps) -> NDArray[np.uint8]:
        """Junction type of every intersection of every map: (maps, corridors) -> (maps, y * x)."""
        padded = np.concatenate([maps, np.zeros((len(maps), 1), np.uint8)], axis=1)
        bits = np.array(DIRECTIONS, dtype=np.uint8)
        present = padded[:, self.corridor_table]
        types: NDArray[np.uint8] = (present * bits).sum(axis=2, dtype=np.uint8)
        return types

    def connected(self, corridors: NDArray[np.uint8]) -> bool:
        """Whether a map is non-empty and its corridors form one component."""
        present = [self.ends(c) for c in range(self.corridors) if corridors[c]]
        if not present:
            return False
        reached = {present[0][0]}
        grew = True
        while grew:
            before = len(reached)
            for a, b in present:
                if a in reached or b in reached:
                    reached |= {a, b}
            grew = len(reached) > before
        return all(a in reached for a, _ in present)
