"""What a wrong type of the junction ahead would cost the errands: said to the classifier.

Sensing is worth its time only for what is decided by its outcome. Whoever concludes type c plans
with the map of least expected cost given c, and keeps to it: the conclusion stays in the map. What
that costs more than the plan for the true type j, over all errands still expected, is the regret.
Beside it, the way out that was decided for c may be the wrong one for j. From these regrets follows
what knowing the type is worth (Howard, *Information value theory*, 1966), in the unit of the
decisions that need it: seconds.
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
    """``regret_s`` (16, 16): what concluding the first type costs more where the second is true.

    Never negative, 0 where the two are the same. Two types of which no map has one get the largest
    regret of all others: such types are less probable than one draw in hundreds.
    """

    regret_s: NDArray[np.float64]
    cells: int


def stakes_of(situation: Situation, maps_per_type: int) -> Stakes:
    """The regrets of later tasks, by at most so many maps of each type at v.

    The maps are those of :func:`by_junction_type`; each task counts as often as it is expected. A
    goal that cannot be reached by what was concluded costs :attr:`Roads.penalty_s`. Raises
    ValueError for no maps.
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
    types = list(found)
    regret_s = np.zeros((len(types), len(types)))
    for column, h in enumerate(found.values()):
        costs = expected_by_plan(roads, tasks, plans, h.maps, h.weights, place)
        # Another type's plan may do better by chance, for it was found with other maps.
        regret_s[:, column] = np.maximum(0.0, costs - costs[column])
    return Stakes(_for_all_types(regret_s, types), cells * len(tasks.start))


def stakes_cells(maps_per_type: int, types: int, tasks: int) -> int:
    """The most cells that :func:`stakes_of` can take: a task, plan and true map is one.

    ``types`` is how many junction types at v are possible, ``tasks`` how many tasks and legs.
    """
    return types * maps_per_type * (maps_per_type + types) * tasks


def most_maps(types: int, tasks: int, cells: int) -> int | None:
    """The most maps a type, of :data:`MAPS`, that so many cells allow; None for none."""
    return max((n for n in MAPS if stakes_cells(n, types, tasks) <= cells), default=None)


def regret_of_leaving(outlook: Outlook) -> NDArray[np.float64]:
    """(16, 16): what the way out decided for one type costs more where another is true, in seconds.

    0 where the true type has no such way, which takes less to find out than a test, and where no
    map has one of the types.
    """
    leaving_s, decided = outlook.leaving_s, outlook.decision.direction
    regret_s = np.zeros((JUNCTION_TYPES, JUNCTION_TYPES))
    for concluded in np.flatnonzero(decided).tolist():
        way_s = leaving_s[:, DIRECTIONS.index(int(decided[concluded]))]
        regret_s[concluded] = np.where(np.isfinite(way_s), way_s - leaving_s.min(axis=1), 0.0)
    regret_s[np.isnan(leaving_s[:, 0])] = 0.0
    np.fill_diagonal(regret_s, 0.0)
    return regret_s


def _for_all_types(regret_s: NDArray[np.float64], types: list[int]) -> NDArray[np.float64]:
    """By all 16 types; what no map tells is taken for the worst."""
    whole = np.full((JUNCTION_TYPES, JUNCTION_TYPES), regret_s.max(initial=0.0))
    np.fill_diagonal(whole, 0.0)
    whole[np.ix_(types, types)] = regret_s
    return whole
