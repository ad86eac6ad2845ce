"""Paths ordered by a price and, where that ties, by their seconds: numba kernels."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.decider.roads import Roads

ROUNDING = 1e-12
"""Relative difference below which two sums count as equal."""


@njit(cache=True)
def is_less(a: float, b: float) -> bool:
    """Whether a sum is truly less than another, beyond rounding."""
    return bool(a < b and (b == np.inf or b - a > ROUNDING * max(1.0, abs(b))))


@njit(cache=True)
def comes_before(first: float, second: float, than_first: float, than_second: float) -> bool:
    """Whether a path comes before another: less by the first price, or equal and shorter."""
    if is_less(first, than_first):
        return True
    return not is_less(than_first, first) and is_less(second, than_second)


@njit(cache=True)
def cheapest(roads: Roads, price: NDArray[np.float64], goal: int) -> NDArray[np.float64]:
    """Price and seconds of the best path from every intersection: (intersections, 2).

    ``price`` (corridors,) is at least 0, infinite where no path may go.
    """
    fields = np.full((len(roads.corridor), 2), np.inf)
    fields[goal] = 0.0
    changed = True
    while changed:
        changed = False
        for place in range(len(fields)):
            for d in range(4):
                corridor = roads.corridor[place, d]
                if corridor < 0 or price[corridor] == np.inf:
                    continue
                beyond = fields[roads.neighbour[place, d]]
                first = price[corridor] + beyond[0]
                second = roads.seconds[corridor] + beyond[1]
                if comes_before(first, second, fields[place, 0], fields[place, 1]):
                    fields[place, 0] = first
                    fields[place, 1] = second
                    changed = True
    return fields


@njit(cache=True)
def cheapest_step(
    roads: Roads, price: NDArray[np.float64], fields: NDArray[np.float64], place: int
) -> int:
    """The direction number in which the best path leaves ``place``; -1 where it has none."""
    chosen, least, shortest = -1, np.inf, np.inf
    for d in range(4):
        corridor = roads.corridor[place, d]
        if corridor < 0 or price[corridor] == np.inf:
            continue
        beyond = fields[roads.neighbour[place, d]]
        first = price[corridor] + beyond[0]
        second = roads.seconds[corridor] + beyond[1]
        if comes_before(first, second, least, shortest):
            chosen, least, shortest = d, first, second
    return chosen


def path(
    roads: Roads,
    price: NDArray[np.float64],
    fields: NDArray[np.float64],
    place: int,
    goal: int,
) -> tuple[int, ...]:
    """Direction numbers of the best path from ``place``, which must have one."""
    steps = []
    while place != goal:
        steps.append(int(cheapest_step(roads, price, fields, place)))
        place = int(roads.neighbour[place, steps[-1]])
    return tuple(steps)
