"""Whether to make sure that this is the same intersection: by hand, by policies, by a diagram."""

from __future__ import annotations

import importlib
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.familiar_place import asked
from modules.decider.familiar import Familiar, FamiliarError, decide_detour


def store(look_s: float) -> Familiar:
    """The chain store, with a detour that takes so long."""
    return Familiar.there_and_back(
        probability=np.array([0.5, 0.5]),
        act_s=np.array([[100.0, 700.0], [700.0, 100.0]]),
        look_s=look_s,
        shows=np.array([[0.9, 0.1], [0.1, 0.9]]),
    )


STORE = store(120.0)
"""Here or elsewhere, even chances; a wrong answer costs 600 s; a restaurant tells nine to one."""


def test_a_detour_that_pays_by_hand() -> None:
    found = decide_detour(STORE)
    # At once: 100, and 600 more half of the time. After the detour wrong one time in ten.
    assert found.now_s == pytest.approx(400)
    assert found.look_s == pytest.approx(120 + 100 + 0.1 * 600)
    assert found.worth_s == pytest.approx(120)
    assert found.pays and found.act == 0 and found.acts == (0, 1)


def test_a_detour_that_costs_what_it_saves_is_not_made() -> None:
    assert decide_detour(store(239.0)).pays
    assert not decide_detour(store(240.0)).pays


def test_what_is_sure_needs_no_detour() -> None:
    # Right at odds of 19: 100 + 0.05 * 600 = 130; either answer of the restaurant leaves it so.
    found = decide_detour(replace(STORE, probability=np.array([0.95, 0.05])))
    assert found.now_s == pytest.approx(130)
    assert found.acts == (0, 0)
    assert found.worth_s == pytest.approx(-120)


def test_time_pressure_by_hand() -> None:
    # 300 s left, each late second costs two more. At once: right 100, wrong 700 + 2 * 400 = 1500.
    hurried = replace(STORE, left_s=300.0, late_price=2.0)
    found = decide_detour(hurried)
    assert found.now_s == pytest.approx((100 + 1500) / 2)
    # After the detour: right 220, wrong 820 + 2 * 520 = 1860, one time in ten.
    assert found.look_s == pytest.approx(0.9 * 220 + 0.1 * 1860)
    # With 150 s left only who acts at once, and is right, is in time.
    found = decide_detour(replace(hurried, left_s=150.0))
    assert found.now_s == pytest.approx((100 + 700 + 2 * 550) / 2)
    assert found.look_s == pytest.approx(0.9 * (220 + 2 * 70) + 0.1 * (820 + 2 * 670))


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"probability": np.array([0.5, 0.6])}, "probability: found a sum of 1.1"),
        ({"act_s": np.ones((2, 3))}, r"act_s: found shape \(2, 3\)"),
        ({"after_s": np.ones((1, 2))}, r"after_s: found shape \(1, 2\)"),
        ({"shows": np.ones((2, 2))}, "shows: found a sum"),
        ({"probability": np.array([1.5, -0.5])}, "negative"),
    ],
)
def test_questions_that_do_not_fit_are_refused(change: dict[str, Any], says: str) -> None:
    with pytest.raises(FamiliarError, match=says):
        replace(STORE, **change)


def some_question(seed: int) -> Familiar:
    rng = np.random.default_rng(seed)
    places, acts, outcomes = (int(n) for n in rng.integers(2, 4, 3))
    probability, act_s = rng.dirichlet(np.ones(places)), rng.uniform(50, 900, (acts, places))
    return Familiar(
        probability,
        act_s,
        # not back where it was: what is left may be more or less by each act
        np.maximum(0.0, act_s + rng.uniform(-200, 300, (acts, places))),
        rng.dirichlet(np.full(outcomes, 0.5), places).T,
        float(rng.uniform(100, 900)),
        float(rng.uniform(0, 5)),
    )


def every_policy(question: Familiar) -> float:
    """The least expected cost of acting at once or of any plan after the detour, one by one."""
    places = range(len(question.probability))
    costs = [
        sum(question.probability[r] * float(question.cost_s(question.act_s[a, r])) for r in places)
        for a in range(len(question.act_s))
    ]
    for plan in product(range(len(question.act_s)), repeat=len(question.shows)):
        costs.append(
            sum(
                question.probability[r]
                * question.shows[o, r]
                * float(question.cost_s(question.after_s[a, r]))
                for r in places
                for o, a in enumerate(plan)
            )
        )
    return float(min(costs))


def diagram(question: Familiar) -> float:
    """The same as an influence diagram, solved by pyAgrum."""
    gum: Any = importlib.import_module("pyagrum")
    acts, places = question.act_s.shape
    found = gum.InfluenceDiagram()
    found.addChanceNode(gum.LabelizedVariable("place", "", places))
    found.addChanceNode(gum.LabelizedVariable("shown", "", len(question.shows) + 1))
    found.addDecisionNode(gum.LabelizedVariable("look", "", 2))
    found.addDecisionNode(gum.LabelizedVariable("act", "", acts))
    found.addUtilityNode(gum.LabelizedVariable("time", "", 1))
    for parent, child in (
        ("place", "shown"), ("look", "shown"), ("shown", "act"), ("look", "act"),
        ("place", "time"), ("look", "time"), ("act", "time"),
    ):  # fmt: skip
        found.addArc(parent, child)
    found.cpt("place").fillWith(question.probability.tolist())
    nothing = [1.0] + [0.0] * len(question.shows)
    for r, look in product(range(places), range(2)):
        told = [0.0, *question.shows[:, r].tolist()] if look else nothing
        found.cpt("shown")[{"place": r, "look": look}] = told
        for a in range(acts):
            taken = (question.after_s if look else question.act_s)[a, r]
            where = {"place": r, "look": look, "act": a}
            found.utility("time")[where] = [-float(question.cost_s(taken))]
    solver = gum.ShaferShenoyLIMIDInference(found)
    solver.addNoForgettingAssumption(["look", "act"])
    solver.makeInference()
    return -float(solver.MEU()["mean"])


@pytest.mark.parametrize("seed", range(20))
def test_the_decision_is_that_of_the_influence_diagram_and_of_the_best_policy(seed: int) -> None:
    question = some_question(seed)
    detour = decide_detour(question)
    best = detour.look_s if detour.pays else detour.now_s
    assert best == pytest.approx(every_policy(question), abs=1e-9)
    assert best == pytest.approx(diagram(question), abs=1e-9)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6))
def test_a_free_look_never_hurts_and_never_beats_the_truth(seed: int) -> None:
    question = some_question(seed)
    question = replace(question, after_s=question.act_s)
    detour = decide_detour(question)
    truth = float(question.cost_s(question.act_s).min(axis=0) @ question.probability)
    assert detour.worth_s >= -1e-9
    assert detour.look_s >= truth - 1e-9


def test_the_shipped_example_turns_with_the_stakes_and_with_the_time() -> None:
    assert asked(0.0).probability[0] > 0.5  # the evidence speaks for the familiar place
    assert not decide_detour(asked(2400.0)).pays
    assert decide_detour(asked(14400.0)).pays
    # No time for it, time enough for it, time enough for a mistake.
    pays = [decide_detour(asked(3600.0, left, 10.0)).pays for left in (900.0, 1800.0, 6000.0)]
    assert pays == [False, True, False]
