"""What each method takes to be the best way, where not every corridor is known (section 4).

Every method but the random one is an order of paths: a first price, summed along the path, and a
second one that breaks ties. Paths equal in both go to the first of N, E, S, W.

| method | first price of a corridor | second |
| --- | --- | --- |
| ``section 4`` | minus the log of its weight: the largest product of weights | seconds |
| ``shortest`` | none: any corridor that may exist will do | seconds |
| ``avoid known`` | seconds of known corridors | seconds |
| ``random`` | any corridor that is there, but back only from a dead end | |
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from bus.grid import Maps
from modules.decider.methods.order_kernels import cheapest, path
from modules.decider.roads import IMPROBABLE, OPEN, PLANNED, Roads

Method: TypeAlias = Literal["section 4", "shortest", "avoid known", "random"]
METHODS: tuple[Method, ...] = get_args(Method)


def corridor_weights(
    levels: NDArray[np.uint8], maps: Maps, probability: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Weight of each corridor: 1 if known to exist, 0 if known not to, else (m+1)/(|H|+1).

    ``levels`` (corridors,) is what is known, see roads.py; ``maps`` (n, corridors) the hypotheses
    and ``probability`` (n,) theirs, summing to 1. m is how many of the |H| maps have the corridor,
    which for maps of unequal probability is their share times |H|. With no map every unknown
    corridor has weight 1. Raises ValueError for shapes that do not fit.
    """
    n = len(maps)
    if maps.shape != (n, len(levels)) or probability.shape != (n,):
        raise ValueError(
            f"maps and probability have shapes {maps.shape} and {probability.shape}, "
            f"expected (n, {len(levels)}) and (n,)"
        )
    guess = (n * (probability @ maps) + 1.0) / (n + 1.0)
    return np.where(levels == PLANNED, 1.0, np.where(levels == OPEN, np.minimum(guess, 1.0), 0.0))


@dataclass(frozen=True)
class Way:
    """The best path of a method from one place to a goal."""

    steps: tuple[int, ...]
    """Direction numbers 0..3 = N, E, S, W; empty where there is no way, or none is needed."""
    known: bool
    """Whether every corridor of it is known."""
    first: float
    """Its first price: for ``section 4`` minus the log of the product of weights."""
    seconds: float
    """How long it takes to drive, if it exists."""


def prices(
    method: Method,
    levels: NDArray[np.uint8],
    weights: NDArray[np.float64],
    seconds: NDArray[np.float64],
) -> NDArray[np.float64]:
    """First price of each corridor, (corridors,): infinite where its weight is 0."""
    there = weights > 0.0
    if method == "section 4":
        return -np.log(weights, where=there, out=np.full(len(weights), -np.inf))
    if method == "avoid known":
        return np.where(there, np.where(levels == PLANNED, seconds, 0.0), np.inf)
    return np.where(there, 0.0, np.inf)


def best_way(
    roads: Roads,
    method: Method,
    levels: NDArray[np.uint8],
    weights: NDArray[np.float64],
    place: int,
    goal: int,
) -> Way:
    """The way that ``method`` would take. Its product of weights is ``exp(-way.first)``.

    Where no path is left, corridors as good as known to be absent (:data:`roads.IMPROBABLE`) may
    be used too, at a thousandth of the least weight of those that may exist. Values that differ
    by less than :data:`order_kernels.ROUNDING` of themselves are equal, so that the order of a
    sum never decides. Raises ValueError for ``random``, which has no way.
    """
    if method == "random":
        raise ValueError("method: found 'random', expected one that follows a way")
    for usable in (weights, _last_resort(levels, weights)):
        first = prices(method, levels, usable, roads.seconds)
        fields = cheapest(roads, first, goal)
        if fields[place, 0] < np.inf:
            steps = path(roads, first, fields, place, goal)
            known = all(levels[c] == PLANNED for c in corridors_of(roads, place, steps))
            return Way(steps, known, float(fields[place, 0]), float(fields[place, 1]))
    return Way((), False, np.inf, np.inf)


def corridors_of(roads: Roads, place: int, steps: tuple[int, ...]) -> list[int]:
    """The corridors that steps from ``place`` lead through."""
    corridors = []
    for step in steps:
        corridors.append(int(roads.corridor[place, step]))
        place = int(roads.neighbour[place, step])
    return corridors


def _last_resort(levels: NDArray[np.uint8], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    open_weights = weights[levels == OPEN]
    least = float(open_weights.min(initial=1.0)) * 1e-3
    return np.where(levels == IMPROBABLE, least, weights)
