"""The grid as the kernels see it, and how firmly each corridor is believed in."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bus.grid import DIRECTIONS, STEP, Grid

SEEN_ABSENT = 0
"""Level of a corridor that was looked for and is not there: no plan uses it."""
IMPROBABLE = 1
"""Level of a corridor that is as good as known to be absent: a plan of last resort."""
OPEN = 2
"""Level of a corridor that may or may not exist."""
PLANNED = 3
"""Level of a corridor that belongs to the map in use: known, seen, or assumed."""


class Roads(NamedTuple):
    """Corridors as a graph, for numba.

    A corridor is named by an intersection and a direction number (0..3 = N, E, S, W).
    """

    corridor: NDArray[np.int64]
    """(intersections, 4): index in a map, -1 off the grid."""
    neighbour: NDArray[np.int64]
    """(intersections, 4): the intersection at the far end, -1 off the grid."""
    seconds: NDArray[np.float64]
    """(corridors,): time to traverse each."""
    penalty_s: float
    """What a goal that cannot be reached costs: every corridor of the grid driven both ways,
    the longest that a depth-first search of the whole building can take."""


def roads_of(grid: Grid, corridor_s: NDArray[np.float64]) -> Roads:
    """The graph of a grid whose corridors take ``corridor_s`` seconds, shape (corridors,)."""
    neighbour = np.full((grid.intersections, 4), -1, dtype=np.int64)
    for v in range(grid.intersections):
        x, y = grid.place(v)
        for number, direction in enumerate(DIRECTIONS):
            if grid.corridor(x, y, direction) >= 0:
                dx, dy = STEP[direction]
                neighbour[v, number] = grid.intersection(x + dx, y + dy)
    seconds = np.array(corridor_s, dtype=np.float64)
    return Roads(grid.corridor_table, neighbour, seconds, 2.0 * float(sum(seconds.tolist())))
