"""Ways to places worth a look: numba kernels."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.decider.roads import OPEN, Roads
from modules.decider.travel_kernels import next_step, plan, relax


@njit(cache=True)
def lower_once(
    roads: Roads,
    belief: NDArray[np.uint8],
    near: NDArray[np.float64],
    far: NDArray[np.float64],
) -> None:
    """Let ``far`` be ``near``, or shorter by starting with one corridor that may exist."""
    for place in range(len(near)):
        far[place] = near[place]
        for d in range(4):
            corridor = roads.corridor[place, d]
            if corridor >= 0 and belief[corridor] >= OPEN:
                through = roads.seconds[corridor] + near[roads.neighbour[place, d]]
                far[place] = min(far[place], through)


@njit(cache=True)
def exploratory_step(
    roads: Roads,
    belief: NDArray[np.uint8],
    level: int,
    place: int,
    near: NDArray[np.float64],
    far: NDArray[np.float64],
) -> int:
    """The direction in which a way with one exploratory step still to come leaves ``place``."""
    chosen, least = -1, np.inf
    for d in range(4):
        corridor = roads.corridor[place, d]
        if corridor >= 0 and belief[corridor] >= min(level, OPEN):
            beyond = far if belief[corridor] >= level else near
            through = roads.seconds[corridor] + beyond[roads.neighbour[place, d]]
            if through < least:
                chosen, least = d, through
    return chosen


@njit(cache=True)
def ways_to(
    roads: Roads,
    belief: NDArray[np.uint8],
    level: int,
    place: int,
    candidates: NDArray[np.int64],
) -> NDArray[np.int64]:
    """The shortest way to each candidate with at most one unknown step.

    It uses corridors at ``level`` or above, and at most one more that may exist.
    Shape (candidates, intersections): direction numbers, ended by -1; a row that starts with
    -1 has no such way. A known way is preferred to an equally long one with an unknown step.
    """
    count = len(roads.corridor)
    ways = np.full((len(candidates), count), -1, dtype=np.int64)
    near = np.empty(count)
    far = np.empty(count)
    for row in range(len(candidates)):
        near[:] = np.inf
        near[candidates[row]] = 0.0
        relax(roads, belief, level, near)
        lower_once(roads, belief, near, far)
        relax(roads, belief, level, far)
        at, step = place, 0
        if far[place] == np.inf:
            continue
        while at != candidates[row]:
            if far[at] < near[at]:
                d = exploratory_step(roads, belief, level, at, near, far)
                if belief[roads.corridor[at, d]] < level:
                    far[:] = near
            else:
                far[:] = near
                d = next_step(roads, belief, level, at, near)
            ways[row, step] = d
            at = roads.neighbour[at, d]
            step += 1
    return ways


@njit(cache=True)
def way_to_goal(
    roads: Roads,
    belief: NDArray[np.uint8],
    place: int,
    goal: int,
    unsettled: NDArray[np.bool_],
) -> tuple[NDArray[np.int64], float, int]:
    """The surest plan's way to ``goal``, cut at the first unsettled intersection on it.

    Returns the direction numbers ended by -1 (intersections,), the seconds of the whole way
    and the plan's level: (all -1, inf, 0) where no plan is left.
    """
    way = np.full(len(roads.corridor), -1, dtype=np.int64)
    field = np.empty(len(roads.corridor))
    level = plan(roads, belief, place, goal, field)
    if level == 0:
        return way, np.inf, 0
    at, step = place, 0
    while at != goal and (step == 0 or not unsettled[at]):
        way[step] = next_step(roads, belief, level, at, field)
        at = roads.neighbour[at, way[step]]
        step += 1
    return way, field[place], level
