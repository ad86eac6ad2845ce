"""What each way out is expected to cost: to judge a choice that was made with less."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bus.grid import DIRECTIONS, JUNCTION_TYPES
from modules.decider.decision import Problem, expected_costs
from modules.decider.hypotheses import Hypotheses, by_junction_type
from modules.decider.options import levels_at, options_at
from modules.decider.situation import Situation


def excess_s(
    situation: Situation, direction: NDArray[np.uint8], hypotheses_per_type: int | None = None
) -> NDArray[np.float64]:
    """How much more each type's direction costs than the best, in expected seconds: (16,).

    ``direction`` (16,) as in :class:`Decision`; expected costs are those of :func:`decide` with
    ``hypotheses_per_type`` maps (all for None). A direction costs what the best option that
    begins with it does, or at most: there, back, and the best option of all. nan for the types
    that no map has, and where no option leads to the goals.
    """
    problem = Problem.of(situation)
    found = by_junction_type(situation, problem.roads, hypotheses_per_type)
    excess = np.full(JUNCTION_TYPES, np.nan)
    for junction_type, hypotheses in found.items():
        costs = _by_direction(problem, junction_type, hypotheses)
        best = min(costs.values())
        if best < np.inf:
            excess[junction_type] = costs[int(direction[junction_type])] - best
    return excess


def _by_direction(problem: Problem, junction_type: int, hypotheses: Hypotheses) -> dict[int, float]:
    """Expected cost by direction bit, 0 for staying."""
    situation = problem.situation
    unsettled = hypotheses.unsettled(situation.grid)
    options = options_at(situation, problem.roads, levels_at(situation, junction_type), unsettled)
    expected, _ = expected_costs(problem, hypotheses, options, unsettled)
    costs = dict.fromkeys((0, *DIRECTIONS), np.inf)
    for option, cost in enumerate(expected):
        if option or options.known:
            direction = options.direction(option)
            costs[direction] = min(costs[direction], cost)
    best = min(costs.values())
    for direction in DIRECTIONS:
        corridor = situation.grid.corridor(*situation.grid.place(situation.place), direction)
        if corridor >= 0:
            there_and_back_s = 2.0 * float(situation.corridor_s[corridor])
            costs[direction] = min(costs[direction], best + there_and_back_s)
    return costs
