"""Which path to take: P_K or P_U, for every junction type that may be found (paper, section 3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import JUNCTION_TYPES
from modules.decider.futures import FutureTable
from modules.decider.hypotheses import Hypotheses, by_junction_type
from modules.decider.options import Options, first_step, levels_at, options_at, some_step
from modules.decider.roads import Roads, roads_of
from modules.decider.situation import Decision, Situation
from modules.decider.value_kernels import Tasks, expectations, immediate_costs

ROUNDING = 1e-9
"""Relative difference below which two expected costs count as equal, so that the order of a sum
never decides."""


def decide(situation: Situation, hypotheses_per_type: int | None = None) -> Decision:
    """Choose the next corridor for each junction type at v by least expected cost.

    For each type that a map in H has, H is conditioned on it (and on the errands being
    possible, see :func:`by_junction_type`), using at most ``hypotheses_per_type`` maps (all for
    None; ValueError below 1). Then, with perfect classification:

    - E[P_K] = sum_j Pr(M_j) [Cost(T*, M*, M_j) + Futures(M_j, E)], infinite where M* does not
      lead to the goals. In spare time P_K is to stay, at no immediate cost.
    - E[P_U] = sum_j Pr(M_j) Cost(T*', M*, M_j)
      + sum_i Pr(O_i) sum_j Pr(M_j given O_i) Futures(M_j, [O_i, E]), the least over the
      candidates of :func:`options_at`.

    Choices where the paper leaves a case open: T*' drives to the candidate, senses there and
    goes on to the goals with M* and all it learnt on the way. Where the way to the candidate
    turns out to be missing, the one exploratory step is used up: it senses where it stands.
    O_i is the place where it sensed and the junction type there. Sensing takes ``sensing_s``
    once, and nothing where all maps agree. P_U must be truly better than P_K to be chosen;
    ties between candidates go to the first. A type that no map has gets the first step of the
    shortest path that is consistent with what is known.

    No choice repeats for ever: as long as a step teaches nothing, what the chosen option costs
    from the next intersection is less by the corridor just driven, and each corridor can be
    learnt only once.
    """
    if hypotheses_per_type is not None and hypotheses_per_type < 1:
        raise ValueError(f"hypotheses_per_type is {hypotheses_per_type}, expected at least 1")
    problem = Problem.of(situation)
    found = by_junction_type(situation, problem.roads, hypotheses_per_type)
    branches = [
        _by_value(problem, t, found[t]) if t in found else _by_hope(problem, t)
        for t in range(JUNCTION_TYPES)
    ]
    return Decision(
        np.array([b.direction for b in branches], dtype=np.uint8),
        np.array([b.known_s for b in branches]),
        np.array([b.unknown_s for b in branches]),
        np.array([b.explores for b in branches]),
        sum(b.cells for b in branches),
        sum(len(h.maps) for h in found.values()),
    )


@dataclass(frozen=True)
class Problem:
    """A situation with what the kernels need of it, made once for all junction types."""

    situation: Situation
    roads: Roads
    tasks: Tasks
    goals: NDArray[np.int64]

    @classmethod
    def of(cls, situation: Situation) -> Problem:
        """The problem of a situation."""
        tasks = Tasks(
            np.array(situation.tasks[:, 0], dtype=np.int64),
            np.array(situation.tasks[:, 1], dtype=np.int64),
            np.array(situation.expected, dtype=np.float64),
        )
        roads = roads_of(situation.grid, situation.corridor_s)
        return cls(situation, roads, tasks, np.array(situation.goals, dtype=np.int64))


@dataclass(frozen=True)
class _Branch:
    """The decision for one junction type."""

    direction: int
    known_s: float = np.inf
    unknown_s: float = np.inf
    explores: bool = False
    cells: int = 0


def _by_value(problem: Problem, junction_type: int, hypotheses: Hypotheses) -> _Branch:
    situation = problem.situation
    unsettled = hypotheses.unsettled(situation.grid)
    levels = levels_at(situation, junction_type)
    options = options_at(situation, problem.roads, levels, unsettled)
    expected, cells = expected_costs(problem, hypotheses, options, unsettled)
    known = expected[0] if options.known else np.inf
    best, unknown = 0, np.inf
    for option in range(1, len(expected)):
        if _less(expected[option], unknown):
            best, unknown = option, expected[option]
    explores = _less(unknown, known)
    direction = options.direction(best if explores else 0)
    if not direction and situation.goals:
        direction = some_step(situation, junction_type)
    return _Branch(direction, known, unknown, explores, cells)


def _by_hope(problem: Problem, junction_type: int) -> _Branch:
    situation = problem.situation
    if not situation.goals:
        return _Branch(direction=0)
    levels = levels_at(situation, junction_type)
    direction = first_step(problem.roads, levels, situation.place, situation.goals[0])
    return _Branch(direction or some_step(situation, junction_type))


def expected_costs(
    problem: Problem,
    hypotheses: Hypotheses,
    options: Options,
    unsettled: NDArray[np.bool_],
) -> tuple[list[float], int]:
    """The expected cost of each option, and the cells it took to reckon them."""
    seconds, observed = immediate_costs(
        problem.roads,
        options.beliefs,
        options.ways,
        hypotheses.maps,
        problem.situation.place,
        problem.goals,
        np.where(unsettled, problem.situation.sensing_s, 0.0),
    )
    futures = FutureTable(problem.roads, problem.tasks, hypotheses)
    plans = futures.plans_given(observed)
    expected = expectations(hypotheses.weights, seconds, plans, futures.table)
    legs = max(1, len(problem.goals))
    cells = seconds.size * legs + futures.reckoned * len(problem.tasks.start)
    return expected.tolist(), cells


def _less(a: float, b: float) -> bool:
    """Whether a cost is truly less than another, beyond rounding."""
    return a < b and (b == np.inf or b - a > ROUNDING * abs(b))
