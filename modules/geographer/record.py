"""What has been observed so far: likelihoods of junctions, corridors driven or found absent.

Each visit's likelihood is multiplied in once, when the visit is over (design: only the owner
of a variable multiplies, so nothing is counted twice).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bus.facts import Recalled
from bus.grid import JUNCTION_TYPES, STEP, Grid


@dataclass(frozen=True, eq=False)
class Record:
    """Evidence up to now. ``junctions`` (rows, columns, 16), ``corridors`` (corridors, 2).

    ``log_scale`` is the log of what the likelihoods were divided by: the evidence of two records
    can be compared only with it.
    """

    grid: Grid
    junctions: NDArray[np.float64]
    corridors: NDArray[np.float64]
    log_scale: float = 0.0

    def with_junction(self, place: int, likelihood: NDArray[np.float64]) -> Record:
        """One more visit's likelihood for the junction at an intersection.

        Scaled to a largest entry of one: only ratios matter for the belief of one record.
        """
        x, y = self.grid.place(place)
        junctions = self.junctions.copy()
        junctions[y, x] *= likelihood
        most = float(junctions[y, x].max())
        junctions[y, x] /= most
        return replace(self, junctions=junctions, log_scale=self.log_scale + math.log(most))

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


def recalled(grid: Grid, places: Iterable[Recalled]) -> Record:
    """What is recalled from an earlier day, as likelihoods: the other types share what is left."""
    record = nothing(grid)
    for one in places:
        likelihood = np.full(JUNCTION_TYPES, (1.0 - one.certain) / (JUNCTION_TYPES - 1))
        likelihood[one.junction_type] = one.certain
        record = record.with_junction(one.place, likelihood)
    return record


def neighbour(grid: Grid, place: int, direction: int) -> int:
    """The intersection next to a place; -1 off the grid."""
    x, y = grid.place(place)
    if grid.corridor(x, y, direction) < 0:
        return -1
    dx, dy = STEP[direction]
    return grid.intersection(x + dx, y + dy)
