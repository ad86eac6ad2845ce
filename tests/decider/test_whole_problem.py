"""The joint problem of tiny worlds against other solvers, and what splitting it costs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.decomposition import ROWS, WORLDS, rules, world
from benchmarks.joint_problem import EndlessError, JointProblem, Rules
from benchmarks.modules_rules import ClassifierRule, stand_aside_unless_long
from benchmarks.tiny_world import Detector, Encounter, Info, TinyWorld
from bus.grid import Grid
from tests.decider.tiny_reference import (
    best_policy_s,
    influence_diagram_s,
    policies,
    tiny,
    value_iteration,
)


@pytest.mark.parametrize("seed", [1, 2, 4])
def test_one_junction_and_one_way_by_four_solvers(seed: int) -> None:
    here = tiny(seed, (3,), wall_s=90.0)
    found = JointProblem(here).cost_s()
    assert found == pytest.approx(value_iteration(here), abs=1e-8)
    assert found == pytest.approx(best_policy_s(here), abs=1e-8)
    assert found == pytest.approx(influence_diagram_s(here), abs=1e-8)
    untested = JointProblem(here, Rules(sensing=lambda *_: -1)).cost_s()
    assert found < untested - 1.0  # it is a problem where tests save time


def test_every_policy_was_tried() -> None:
    # No first test: 9 seconds; a first test: the other or none, after either answer: 4 each.
    assert sum(1 for _ in policies(tiny(0, (3,)))) == 16 * (9 + 4 + 4)


@pytest.mark.parametrize("goals", [(3, 0), (3, 0, 1)])
def test_several_errands_by_value_iteration_over_single_steps(goals: tuple[int, ...]) -> None:
    here = tiny(5, goals)
    assert JointProblem(here).cost_s() == pytest.approx(value_iteration(here), abs=1e-8)


def test_a_larger_world_by_value_iteration_over_single_steps() -> None:
    corridor_s = np.random.default_rng(2).uniform(100, 300, 7)
    here = TinyWorld(Grid(3, 2), corridor_s, 1, (5,), (Detector(1, 0, 10.0),))
    assert JointProblem(here).cost_s() == pytest.approx(value_iteration(here), abs=1e-8)


def test_somebody_half_way_by_hand() -> None:
    people = Encounter(0.5, (10.0, 1000.0))
    one = TinyWorld(Grid(2, 1), np.array([100.0]), 0, (1,), encounter=people)
    # Nobody: 100. One that lets by: 110. One that does not: 50 back out, 50 back, 100 again.
    assert JointProblem(one).cost_s() == pytest.approx(0.5 * 100 + 0.5 * (110 + 200) / 2)
    aside = JointProblem(one, Rules(reacting=lambda *_: False)).cost_s()
    assert aside == pytest.approx(0.5 * 100 + 0.5 * (110 + 1100) / 2)
    alone = JointProblem(one, Rules(reacting=stand_aside_unless_long)).cost_s()
    assert alone == pytest.approx(JointProblem(one).cost_s())


def test_with_certain_tests_nothing_is_lost_by_knowing_the_truth() -> None:
    sure = (Detector(0, 0, 0.0, 1.0), Detector(0, 1, 0.0, 1.0))
    sees = replace(tiny(1, (3,)), detectors=())
    assert JointProblem(replace(sees, detectors=sure)).cost_s() == pytest.approx(
        JointProblem(sees).cost_s()
    )


def test_rules_never_beat_the_joint_problem_and_those_of_the_modules_end() -> None:
    here = world(WORLDS[0], 0)
    best = JointProblem(here).cost_s()
    for row in ROWS:
        assert JointProblem(here, rules(row)).cost_s() >= best - 1e-9, row


def test_rules_that_go_round_in_circles_are_refused() -> None:
    here = TinyWorld(Grid(2, 1), np.array([100.0]), 0, (1,), (Detector(0, 1, 10.0),))

    def nowhere(_world: TinyWorld, _info: Info, _place: int) -> int:
        return -1

    with pytest.raises(EndlessError, match="never get to the goals"):
        JointProblem(here, Rules(leaving=nowhere)).cost_s()


def test_the_price_of_a_wrong_type_is_what_the_stop_rule_loses_by() -> None:
    here = world(WORLDS[0], 1)
    best = JointProblem(here).cost_s()
    dear, fair = (
        JointProblem(here, Rules(sensing=ClassifierRule(price))).cost_s() - best
        for price in (100_000.0, 50.0)
    )
    assert dear > fair >= -1e-9


def test_a_stop_rule_that_is_told_what_the_type_is_needed_for_loses_less() -> None:
    here = world(WORLDS[0], 2)
    best = JointProblem(here).cost_s()
    alone, told = (
        JointProblem(here, Rules(sensing=rule)).cost_s() - best
        for rule in (ClassifierRule(), ClassifierRule(heeds_stakes=True))
    )
    assert -1e-9 <= told < 0.5 * alone
