"""Immediate and future costs of options over a set of maps: numba kernels."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.decider.roads import Roads
from modules.decider.travel_kernels import errand, learn, relax, task_cost


class Tasks(NamedTuple):
    """The expected future tasks T_j, for numba."""

    start: NDArray[np.int64]
    goal: NDArray[np.int64]
    expected: NDArray[np.float64]


@njit(cache=True)
def look(
    roads: Roads,
    belief: NDArray[np.uint8],
    truth: NDArray[np.uint8],
    place: int,
    way: NDArray[np.int64],
) -> tuple[int, float]:
    """Drive a way to its end or to the first missing corridor: (where, seconds)."""
    spent = 0.0
    for d in way:
        if d < 0:
            break
        learn(roads, belief, truth, place)
        corridor = roads.corridor[place, d]
        if not truth[corridor]:
            break
        spent += roads.seconds[corridor]
        place = roads.neighbour[place, d]
    learn(roads, belief, truth, place)
    return place, spent


@njit(cache=True)
def immediate_costs(
    roads: Roads,
    beliefs: NDArray[np.uint8],
    ways: NDArray[np.int64],
    maps: NDArray[np.uint8],
    place: int,
    goals: NDArray[np.int64],
    sensing_s: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Cost(T*', M*, M_j) and what is observed, for each option and map.

    ``beliefs`` (options, corridors) and ``ways`` (options, intersections) say with which map
    and by which way an option starts, ``sensing_s`` (intersections,) how long it senses where
    its way ended. Returns seconds and observations, both (options, maps); an observation is the
    place and the junction type found there as one number, ``16 * place + type``.
    """
    seconds = np.empty((len(ways), len(maps)))
    observed = np.empty((len(ways), len(maps)), dtype=np.int64)
    belief = np.empty(beliefs.shape[1], dtype=np.uint8)
    field = np.empty(len(roads.corridor))
    for option in range(len(ways)):
        for j in range(len(maps)):
            belief[:] = beliefs[option]
            at, spent = look(roads, belief, maps[j], place, ways[option])
            junction = 0
            for d in range(4):
                corridor = roads.corridor[at, d]
                if corridor >= 0 and maps[j, corridor]:
                    junction |= 1 << d
            observed[option, j] = 16 * at + junction
            spent += sensing_s[at]
            seconds[option, j] = spent + errand(roads, belief, maps[j], at, goals, field)
    return seconds, observed


@njit(cache=True)
def table_entry(
    roads: Roads,
    tasks: Tasks,
    plan_map: NDArray[np.uint8],
    truth: NDArray[np.uint8],
    fields: NDArray[np.float64],
    ready: NDArray[np.bool_],
    belief: NDArray[np.uint8],
    field: NDArray[np.float64],
) -> float:
    """sum_j E|T_j| Cost(T_j, M_plan, M_true) for one pair of maps.

    ``fields`` (goals, intersections) and ``ready`` (goals,) keep the plan map's fields.
    """
    total = 0.0
    for t in range(len(tasks.start)):
        goal = tasks.goal[t]
        if not ready[goal]:
            ready[goal] = True
            fields[goal] = np.inf
            fields[goal, goal] = 0.0
            relax(roads, plan_map, 1, fields[goal])
        cost = task_cost(roads, plan_map, truth, tasks.start[t], goal, fields[goal], belief, field)
        total += tasks.expected[t] * cost
    return total


@njit(cache=True)
def fill_entries(
    roads: Roads,
    tasks: Tasks,
    maps: NDArray[np.uint8],
    plans: NDArray[np.int64],
    table: NDArray[np.float64],
    fields: NDArray[np.float64],
    ready: NDArray[np.bool_],
) -> int:
    """Reckon the entries (plans[option, j], j) of the table that are not there yet (NaN).

    Returns how many were reckoned.
    """
    belief = np.empty(maps.shape[1], dtype=np.uint8)
    field = np.empty(len(roads.corridor))
    reckoned = 0
    for option in range(len(plans)):
        for j in range(plans.shape[1]):
            p = plans[option, j]
            if np.isnan(table[p, j]):
                table[p, j] = table_entry(
                    roads, tasks, maps[p], maps[j], fields[p], ready[p], belief, field
                )
                reckoned += 1
    return reckoned


@njit(cache=True)
def most_probable_given(
    observed: NDArray[np.int64], log_probability: NDArray[np.float64], places: int
) -> NDArray[np.int64]:
    """For each option and map, the most probable of the maps that show what this one shows.

    Ties go to the lowest index.
    """
    plans = np.empty_like(observed)
    best = np.empty(16 * places, dtype=np.int64)
    for option in range(len(observed)):
        best[:] = -1
        for j in range(observed.shape[1]):
            o = observed[option, j]
            if best[o] < 0 or log_probability[j] > log_probability[best[o]]:
                best[o] = j
        for j in range(observed.shape[1]):
            plans[option, j] = best[observed[option, j]]
    return plans


@njit(cache=True)
def expectations(
    weights: NDArray[np.float64],
    seconds: NDArray[np.float64],
    plans: NDArray[np.int64],
    table: NDArray[np.float64],
) -> NDArray[np.float64]:
    """sum_j weights[j] (seconds[option, j] + table[plans[option, j], j]) for each option."""
    expected = np.zeros(len(plans))
    for option in range(len(plans)):
        for j in range(len(weights)):
            expected[option] += weights[j] * (seconds[option, j] + table[plans[option, j], j])
    return expected


@njit(cache=True)
def reached_from(roads: Roads, maps: NDArray[np.uint8], place: int) -> NDArray[np.bool_]:
    """Which intersections each map joins to ``place``: (maps, intersections)."""
    reached = np.empty((len(maps), len(roads.corridor)), dtype=np.bool_)
    field = np.empty(len(roads.corridor))
    for j in range(len(maps)):
        field[:] = np.inf
        field[place] = 0.0
        relax(roads, maps[j], 1, field)
        reached[j] = field < np.inf
    return reached
