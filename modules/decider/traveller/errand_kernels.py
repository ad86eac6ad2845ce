"""Errands in turn, driven by a cheap policy that keeps what it learns: numba kernels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.decider.roads import Roads
from modules.decider.traveller.way_kernels import follow, set_prices


class Errands(NamedTuple):
    """Goals to visit in turn, for numba."""

    goals: NDArray[np.int64]
    """(k,): vertices; from each the next is made for."""
    weight: NDArray[np.float64]
    """(k,): what a second on the way to each counts, above 0."""
    news_s: float
    """What looking takes, in the edges' unit, wherever arriving teaches anything."""


@njit(cache=True)
def next_stage(errands: Errands, stage: int, place: int) -> int:
    """The number of the first goal from ``stage`` on that ``place`` does not settle."""
    while stage < len(errands.goals) and errands.goals[stage] == place:
        stage += 1
    return stage


@njit(cache=True)
def drive_on(
    roads: Roads,
    errands: Errands,
    world: NDArray[np.uint8],
    stage: int,
    place: int,
    seen: NDArray[np.uint8],
    price: NDArray[np.float64],
    field: NDArray[np.float64],
    queue: NDArray[np.int64],
) -> float:
    """Weighted cost of all goals from ``stage`` on, by :func:`follow`; ``seen`` is changed."""
    total = 0.0
    for s in range(stage, len(errands.goals)):
        spent, lessons = follow(roads, world, place, errands.goals[s], seen, price, field, queue)
        total += errands.weight[s] * (spent + errands.news_s * lessons)
        place = errands.goals[s]
    return total


@njit(cache=True)
def mean_cost(
    roads: Roads,
    errands: Errands,
    worlds: NDArray[np.uint8],
    odds: NDArray[np.float64],
    known: NDArray[np.uint8],
    hope: NDArray[np.float64],
    place: int,
) -> float:
    """Mean over ``worlds``, each weighed by its odds, of :func:`drive_on` from the start."""
    price, driven, seen = np.empty(len(known)), np.empty(len(known)), np.empty_like(known)
    field = np.empty(len(roads.corridor))
    queue = np.empty(len(roads.corridor), dtype=np.int64)
    set_prices(roads, known, hope, price)
    total, mass = 0.0, 0.0
    for j in range(len(worlds)):
        driven[:] = price
        seen[:] = known
        total += odds[j] * drive_on(roads, errands, worlds[j], 0, place, seen, driven, field, queue)
        mass += odds[j]
    return total / mass
