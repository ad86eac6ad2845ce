"""Driving with a map that may be wrong: numba kernels for plans, walks and their times.

A *belief* holds one level a corridor (see roads.py). A *field* holds the seconds from every
intersection to one goal; a plan is a field and the level it was made at. Sums run in a fixed
order and ties go to the first of N, E, S, W, so that every run gives the same bits.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.decider.roads import IMPROBABLE, OPEN, PLANNED, SEEN_ABSENT, Roads


@njit(cache=True)
def relax(roads: Roads, belief: NDArray[np.uint8], level: int, field: NDArray[np.float64]) -> None:
    """Lower ``field`` until no corridor at ``level`` or above makes any way shorter."""
    last = len(field) - 1
    changed, northward = True, False
    while changed:
        changed, northward = False, not northward
        for k in range(last + 1):
            # to and fro: one sweep follows a way as long as it keeps going that way
            place = k if northward else last - k
            for d in range(4):
                corridor = roads.corridor[place, d]
                if corridor >= 0 and belief[corridor] >= level:
                    through = roads.seconds[corridor] + field[roads.neighbour[place, d]]
                    if through < field[place]:
                        field[place] = through
                        changed = True


@njit(cache=True)
def plan(
    roads: Roads, belief: NDArray[np.uint8], place: int, goal: int, field: NDArray[np.float64]
) -> int:
    """Fill ``field`` with the surest plan from ``place``: its level, or 0 where none is left.

    First the map in use alone; then with every corridor that may exist; then with the
    improbable ones too.
    """
    for level in (PLANNED, OPEN, IMPROBABLE):
        field[:] = np.inf
        field[goal] = 0.0
        relax(roads, belief, level, field)
        if field[place] < np.inf:
            return level
    return 0


@njit(cache=True)
def next_step(
    roads: Roads, belief: NDArray[np.uint8], level: int, place: int, field: NDArray[np.float64]
) -> int:
    """The direction number in which the plan leaves ``place``; -1 where it has no way."""
    chosen, least = -1, np.inf
    for d in range(4):
        corridor = roads.corridor[place, d]
        if corridor >= 0 and belief[corridor] >= level:
            through = roads.seconds[corridor] + field[roads.neighbour[place, d]]
            if through < least:
                chosen, least = d, through
    return chosen


@njit(cache=True)
def learn(roads: Roads, belief: NDArray[np.uint8], truth: NDArray[np.uint8], place: int) -> None:
    """See the true corridors of one intersection."""
    for d in range(4):
        corridor = roads.corridor[place, d]
        if corridor >= 0:
            belief[corridor] = PLANNED if truth[corridor] else SEEN_ABSENT


@njit(cache=True)
def follow(
    roads: Roads,
    belief: NDArray[np.uint8],
    truth: NDArray[np.uint8],
    place: int,
    goal: int,
    level: int,
    field: NDArray[np.float64],
) -> tuple[int, float]:
    """Drive the plan to the goal or until its next corridor is missing: (where, seconds).

    Every intersection left is learnt, but only after the step from it was chosen: what is
    newly found there does not change a plan that still holds.
    """
    spent = 0.0
    while place != goal:
        d = next_step(roads, belief, level, place, field)
        learn(roads, belief, truth, place)
        corridor = roads.corridor[place, d]
        if not truth[corridor]:
            break
        spent += roads.seconds[corridor]
        place = roads.neighbour[place, d]
    return place, spent


@njit(cache=True)
def travel(
    roads: Roads,
    belief: NDArray[np.uint8],
    truth: NDArray[np.uint8],
    place: int,
    goal: int,
    field: NDArray[np.float64],
) -> float:
    """Seconds to the goal, planning anew on each contradiction; -1 where no plan is left.

    It ends: each contradiction rules out one more corridor for good.
    """
    spent = 0.0
    while place != goal:
        level = plan(roads, belief, place, goal, field)
        if level == 0:
            return -1.0
        place, more = follow(roads, belief, truth, place, goal, level, field)
        spent += more
    return spent


@njit(cache=True)
def errand(
    roads: Roads,
    belief: NDArray[np.uint8],
    truth: NDArray[np.uint8],
    place: int,
    goals: NDArray[np.int64],
    field: NDArray[np.float64],
) -> float:
    """Seconds to visit the goals in turn, keeping what was learnt on the way.

    The penalty alone where one cannot be reached; 0 with no goals.
    """
    spent = 0.0
    for goal in goals:
        more = travel(roads, belief, truth, place, goal, field)
        if more < 0.0:
            return roads.penalty_s
        learn(roads, belief, truth, goal)
        spent += more
        place = goal
    return spent


@njit(cache=True)
def task_cost(
    roads: Roads,
    plan_map: NDArray[np.uint8],
    truth: NDArray[np.uint8],
    start: int,
    goal: int,
    plan_field: NDArray[np.float64],
    belief: NDArray[np.uint8],
    field: NDArray[np.float64],
) -> float:
    """Cost(T, M_plan, M_true) in seconds; the penalty where the goal cannot be reached.

    ``plan_field`` is the plan map's field to ``goal``, reckoned once for many tasks and truths;
    ``belief`` and ``field`` are scratch.
    """
    for corridor in range(len(belief)):
        belief[corridor] = PLANNED if plan_map[corridor] else OPEN
    place, spent = start, 0.0
    if plan_field[start] < np.inf:
        place, spent = follow(roads, belief, truth, start, goal, PLANNED, plan_field)
    more = travel(roads, belief, truth, place, goal, field)
    return roads.penalty_s if more < 0.0 else spent + more
