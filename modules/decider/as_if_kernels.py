"""Driving as if the robot were somewhere that it may not be: numba kernels.

Several registrations put the robot on several intersections of one grid; between any two of them
there is a shift. A plan is made in the grid as one registration has it, and driven in a map that is
true as another has it. A registration is given up where what is seen contradicts what it is sure
of, and at its goal, if nobody waits there.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.decider.roads import OPEN, PLANNED, SEEN_ABSENT, Roads
from modules.decider.travel_kernels import next_step, plan


class Frames(NamedTuple):
    """The registrations, for numba: what each is sure of, and how they lie to one another."""

    corridor: NDArray[np.int64]
    """(intersections, 4): index in a map, -1 off the grid; the same for all."""
    neighbour: NDArray[np.int64]
    """(intersections, 4): the intersection at the far end, -1 off the grid."""
    seconds: NDArray[np.float64]
    """(registrations, corridors): time to traverse each."""
    levels: NDArray[np.uint8]
    """(registrations, corridors): what is known of each, see roads.py."""
    place: NDArray[np.int64]
    """(from, to, intersections): what an intersection of one is in another, -1 off the grid."""
    source: NDArray[np.int64]
    """(of, in, corridors): which corridor of one's map is a corridor of another's, or -1."""
    sensing_s: float
    """What each arrival takes beside the drive."""
    penalty_s: float
    """What a goal that cannot be reached costs."""


@njit(cache=True)
def see(
    frames: Frames, belief: NDArray[np.uint8], truth: NDArray[np.uint8], place: int
) -> tuple[bool, bool]:
    """See the corridors of an intersection: whether they are news, and whether they contradict."""
    news, contradicts = False, False
    for d in range(4):
        corridor = frames.corridor[place, d]
        if corridor < 0:
            continue
        known = belief[corridor]
        belief[corridor] = PLANNED if truth[corridor] else SEEN_ABSENT
        news = news or known != belief[corridor]
        contradicts = contradicts or (
            known != OPEN and (known == PLANNED) != (truth[corridor] == 1)
        )
    return news, contradicts


@njit(cache=True)
def drive_as_if(
    frames: Frames,
    a: int,
    r: int,
    truth: NDArray[np.uint8],
    place: int,
    goal: int,
) -> tuple[int, float, bool]:
    """Drive to the goal as if at ``a`` where ``r`` and its map are true, until that is given up.

    ``place`` is where the robot is as ``r`` has it; (where it ends, seconds, whether it found the
    true goal). Where ``a`` is ``r`` it is never given up: a goal without a way costs the penalty.
    """
    at, true_goal = frames.place[r, a, place], frames.place[r, a, goal]
    if at < 0:
        return place, 0.0, False
    shifted = np.zeros_like(truth)
    for corridor in range(len(truth)):
        source = frames.source[r, a, corridor]
        if source >= 0:
            shifted[corridor] = truth[source]
    roads = Roads(frames.corridor, frames.neighbour, frames.seconds[a], frames.penalty_s)
    belief = frames.levels[a].copy()
    field = np.empty(len(frames.corridor))
    level, spent = -1, 0.0
    while at != goal and at != true_goal:
        news, contradicts = see(frames, belief, shifted, at)
        if contradicts and a != r:
            break
        if news or level < 0:
            level = plan(roads, belief, at, goal, field)
        if level == 0:
            if a == r:
                return place, spent + frames.penalty_s, True
            break
        d = next_step(roads, belief, level, at, field)
        spent += roads.seconds[roads.corridor[at, d]] + frames.sensing_s
        at = roads.neighbour[at, d]
    return frames.place[a, r, at], spent, at == true_goal


@njit(cache=True)
def order_costs(
    frames: Frames,
    orders: NDArray[np.int64],
    of: NDArray[np.int64],
    maps: NDArray[np.uint8],
    places: NDArray[np.int64],
    goal: int,
    spent_s: NDArray[np.float64],
    costs_s: NDArray[np.float64],
) -> int:
    """Fill ``costs_s`` (orders, cases): the errand's time as if at each of an order in turn.

    In case k the registration ``of[k]`` and ``maps[k]`` are true, the robot is at ``places[k]`` as
    that registration has it, and has spent ``spent_s[k]`` already. Returns the drives made.
    """
    drives = 0
    for o in range(len(orders)):
        for k in range(len(of)):
            place, total = places[k], spent_s[k]
            for a in orders[o]:
                place, more, done = drive_as_if(frames, a, of[k], maps[k], place, goal)
                total += more
                drives += 1
                if done:
                    break
            costs_s[o, k] = total
    return drives


@njit(cache=True)
def look_along(
    frames: Frames,
    route: NDArray[np.int64],
    r: int,
    truth: NDArray[np.uint8],
    place: int,
    goal: int,
) -> tuple[int, float, int, bool]:
    """Drive direction numbers to the end or to a missing corridor.

    (Where it ends, seconds, corridors driven, whether it passed the goal).
    """
    spent, driven, passed = 0.0, 0, False
    for d in route:
        corridor = frames.corridor[place, d]
        if corridor < 0 or not truth[corridor]:
            break
        spent += frames.seconds[r, corridor] + frames.sensing_s
        place = frames.neighbour[place, d]
        driven += 1
        passed = passed or place == goal
    return place, spent, driven, passed
