"""The maps that remain possible once the junction type at v is known."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import Grid, Maps
from modules.decider.roads import Roads
from modules.decider.situation import Situation
from modules.decider.value_kernels import reached_from


@dataclass(frozen=True)
class Hypotheses:
    """Distinct maps with their probabilities: H conditioned on something."""

    maps: Maps
    """(n, corridors), no two equal, n > 0."""
    weights: NDArray[np.float64]
    """(n,): they sum to 1."""
    log_probability: NDArray[np.float64]
    """(n,): as in :class:`Situation`."""

    def unsettled(self, grid: Grid) -> NDArray[np.bool_]:
        """(intersections,): where the maps differ about the junction type."""
        types = grid.junction_types(self.maps)
        differs: NDArray[np.bool_] = (types != types[0]).any(axis=0)
        return differs


def by_junction_type(
    situation: Situation, roads: Roads, limit: int | None
) -> dict[int, Hypotheses]:
    """H given each junction type at v that is possible, with at most ``limit`` maps a type.

    A type is possible where a map of positive weight has it and it includes ``came_from``.
    That the robot has errands tells something too: H is conditioned on every waypoint and
    every end of a task being joined to v, or where no map has that, on the waypoints alone,
    or else on nothing more. Of what remains the first ``limit`` maps are taken (all for
    None), and equal ones merged, their weights added.
    """
    types = situation.grid.junction_types(situation.maps)[:, situation.place]
    possible = (types & situation.came_from == situation.came_from) & (situation.weights > 0)
    joined = reached_from(
        roads, np.array(situation.maps, dtype=np.uint8, order="C"), situation.place
    )
    way = joined[:, list(situation.goals)].all(axis=1)
    ends = joined[:, situation.tasks.ravel()].all(axis=1)
    found = {}
    for junction_type in np.unique(types[possible]).tolist():
        have = possible & (types == junction_type)
        for condition in (have & way & ends, have & way, have):
            rows = np.flatnonzero(condition)[:limit]
            if len(rows):
                found[junction_type] = _merged(situation, rows)
                break
    return found


def _merged(situation: Situation, rows: NDArray[np.int64]) -> Hypotheses:
    maps = np.array(situation.maps[rows], dtype=np.uint8, order="C")
    number: dict[bytes, int] = {}
    which = [number.setdefault(row.tobytes(), len(number)) for row in maps]
    first = np.unique(which, return_index=True)[1]
    weights = np.bincount(which, weights=situation.weights[rows], minlength=len(number))
    log_probability = np.array(situation.log_probability[rows[first]], dtype=np.float64)
    return Hypotheses(maps[first], weights / math.fsum(weights), log_probability)
