"""What a wrong type of the junction ahead would cost the errands: said to the classifier.

Sensing is worth its time only for what is decided by its outcome. Whoever concludes type c plans
with the map of least expected cost given c, and keeps to it: the conclusion stays in the map. What
that costs more than the plan for the true type j, over all errands still expected, is one part of
the regret. Another is the way out that was decided for c where j is true. And who leaves without
knowing the type may have to come back for it: the regret is at least the way there and back. From
these follows what knowing the type is worth (Howard, *Information value theory*, 1966), in the unit
of the decisions that need it: seconds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import DIRECTIONS, JUNCTION_TYPES
from modules.decider.decision import Problem
from modules.decider.hypotheses import by_junction_type
from modules.decider.outlook import Outlook
from modules.decider.situation import Situation
from modules.decider.stakes_kernels import expected_by_plan

MAPS = (1, 2, 4, 8, 16, 32)
"""The sizes of problem to choose from: maps for each junction type at v."""


@dataclass(frozen=True, eq=False)
class Stakes:
    """``later_s`` (types, types): regret of concluding the first where the second is true.

    ``types`` are those that a map has, in order. Never negative, 0 where the two are the same.
    """

    types: tuple[int, ...]
    later_s: NDArray[np.float64]
    cells: int


def stakes_of(situation: Situation, maps_per_type: int) -> Stakes:
    """What a wrong type at v costs later errands, by at most so many maps of each type.

    The maps are those of :func:`by_junction_type`; each task counts as often as it is expected. A
    goal that cannot be reached by what was concluded is found out by the first task that needs it,
    and costs :attr:`Roads.penalty_s` once. Raises ValueError for no maps.
    """
    if maps_per_type < 1:
        raise ValueError(f"maps_per_type is {maps_per_type}, expected at least 1")
    problem = Problem.of(situation)
    roads, tasks = problem.roads, problem.tasks
    found = by_junction_type(situation, roads, maps_per_type)
    place, cells = situation.place, 0
    plans = np.empty((len(found), situation.grid.corridors), np.uint8)
    for row, h in enumerate(found.values()):
        expected = expected_by_plan(roads, tasks, h.maps, h.maps, h.weights, place)
        plans[row] = h.maps[expected.argmin()]
        cells += len(h.maps) * (len(h.maps) + len(found))
    later_s = np.zeros((len(found), len(found)))
    for column, h in enumerate(found.values()):
        costs = expected_by_plan(roads, tasks, plans, h.maps, h.weights, place)
        # Another type's plan may do better by chance, for it was found with other maps.
        later_s[:, column] = np.maximum(0.0, costs - costs[column])
    return Stakes(tuple(found), later_s, cells * len(tasks.start))


def stakes_cells(maps_per_type: int, types: int, tasks: int) -> int:
    """The most cells that :func:`stakes_of` can take: a task, plan and true map is one.

    ``types`` is how many junction types at v are possible, ``tasks`` how many tasks may come.
    """
    return types * maps_per_type * (maps_per_type + types) * tasks


def most_maps(types: int, tasks: int, cells: int) -> int | None:
    """The most maps a type, of :data:`MAPS`, that so many cells allow; None for none."""
    return max((n for n in MAPS if stakes_cells(n, types, tasks) <= cells), default=None)


def regret_s(situation: Situation, stakes: Stakes, outlook: Outlook) -> NDArray[np.float64]:
    """What concluding each type costs more where each is true, over all: (16, 16), in seconds.

    Never negative, 0 where the two are the same. Types of which no map has one are less probable
    than one draw in hundreds; with them, the regret is the largest of the others.
    """
    among = np.ix_(stakes.types, stakes.types)
    found = np.maximum(stakes.later_s + regret_of_leaving(outlook)[among], coming_back_s(situation))
    whole = np.full((JUNCTION_TYPES, JUNCTION_TYPES), found.max(initial=0.0))
    whole[among] = found
    np.fill_diagonal(whole, 0.0)
    return whole


def regret_of_leaving(outlook: Outlook) -> NDArray[np.float64]:
    """(16, 16): what the way out decided for one type costs more where another is true, in seconds.

    0 where the true type has no such way, which takes less to find out than a test, and where no
    map has one of the types.
    """
    leaving_s, decided = outlook.leaving_s, outlook.decision.direction
    regret = np.zeros((JUNCTION_TYPES, JUNCTION_TYPES))
    for concluded in np.flatnonzero(decided).tolist():
        way_s = leaving_s[:, DIRECTIONS.index(int(decided[concluded]))]
        regret[concluded] = np.where(np.isfinite(way_s), way_s - leaving_s.min(axis=1), 0.0)
    regret[:, np.isnan(leaving_s[:, 0])] = 0.0
    regret[np.isnan(leaving_s[:, 0])] = 0.0
    np.fill_diagonal(regret, 0.0)
    return regret


def unsettled_at(situation: Situation) -> bool:
    """Whether v has a corridor of which it is not known (``known_at``) if it exists."""
    at = situation.grid.place(situation.place)
    corridors = [situation.grid.corridor(*at, direction) for direction in DIRECTIONS]
    p = situation.corridor_probability[[c for c in corridors if c >= 0]]
    return bool(((p > 1.0 - situation.known_at) & (p < situation.known_at)).any())


def coming_back_s(situation: Situation) -> float:
    """Seconds to leave v and come back to it, by its shortest corridor."""
    at = situation.grid.place(situation.place)
    corridors = [situation.grid.corridor(*at, direction) for direction in DIRECTIONS]
    return 2.0 * min(float(situation.corridor_s[c]) for c in corridors if c >= 0)
