"""What errands cost once a junction's type was concluded, right or wrong: numba kernels."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.decider.roads import Roads
from modules.decider.travel_kernels import relax, task_cost
from modules.decider.value_kernels import Tasks


@njit(cache=True)
def expected_by_plan(
    roads: Roads,
    tasks: Tasks,
    plans: NDArray[np.uint8],
    truths: NDArray[np.uint8],
    weights: NDArray[np.float64],
    place: int,
) -> NDArray[np.float64]:
    """(plans,): sum_m weights[m] times what all tasks cost by M_plan where M_m is true.

    A corridor at ``place`` that the plan does not have is never driven: what was concluded is not
    looked at again. One that the plan has and the building has not is found out by going there.
    """
    places, corridors = len(roads.corridor), plans.shape[1]
    expected = np.zeros(len(plans))
    fields = np.empty((places, places))
    ready = np.empty(places, dtype=np.bool_)
    belief, truth = np.empty(corridors, dtype=np.uint8), np.empty(corridors, dtype=np.uint8)
    field = np.empty(places)
    for p in range(len(plans)):
        ready[:] = False
        for m in range(len(truths)):
            truth[:] = truths[m]
            for corridor in roads.corridor[place]:
                if corridor >= 0 and not plans[p, corridor]:
                    truth[corridor] = 0
            expected[p] += weights[m] * all_tasks(
                roads, tasks, plans[p], truth, truths[m], fields, ready, belief, field
            )
    return expected


@njit(cache=True)
def all_tasks(
    roads: Roads,
    tasks: Tasks,
    plan: NDArray[np.uint8],
    open_to_it: NDArray[np.uint8],
    truth: NDArray[np.uint8],
    fields: NDArray[np.float64],
    ready: NDArray[np.bool_],
    belief: NDArray[np.uint8],
    field: NDArray[np.float64],
) -> float:
    """sum_T E|T| Cost(T, M_plan, M), where M is ``truth`` less what is never driven.

    A goal that cannot be reached like that is found out by the first task that needs it: once it
    costs the penalty, and from then on what the way to it takes. The rest is scratch.
    """
    total, missed = 0.0, 0.0
    for t in range(len(tasks.start)):
        start, goal = tasks.start[t], tasks.goal[t]
        if not ready[goal]:
            ready[goal] = True
            fields[goal] = np.inf
            fields[goal, goal] = 0.0
            relax(roads, plan, 1, fields[goal])
        cost = task_cost(roads, plan, open_to_it, start, goal, fields[goal], belief, field)
        if cost == roads.penalty_s:
            missed += tasks.expected[t]
            field[:] = np.inf
            field[goal] = 0.0
            relax(roads, truth, 1, field)
            cost = min(field[start], roads.penalty_s)
        total += tasks.expected[t] * cost
    return total + min(1.0, missed) * roads.penalty_s
