"""Acts by expected utility: brute force, a second library, and what must hold anyway."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pyagrum
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from modules.reactor.meeting import ACTS
from modules.reactor.react import Encounter, decide, encounter, react
from modules.reactor.tables import (
    SIDES_M,
    TTC_CLASSES,
    TTC_EDGES_S,
    WHAT,
    Settings,
    collision_table,
    loss_table,
)
from modules.reactor.thing import LINES_M, EchoModel, Thing, born
from modules.reactor.track import Tracker

SETTINGS = Settings()
gum: Any = pyagrum  # it has no types
MIDDLE = len(SIDES_M) // 2
SHAPE = (len(WHAT), TTC_CLASSES, len(LINES_M))


def belief(what: int, ttc: int, line: int, side: int = MIDDLE) -> Encounter:
    """Certainty."""
    table = np.zeros(SHAPE)
    table[what, ttc, line] = 1.0
    return Encounter(table, side)


def random_belief(seed: int) -> Encounter:
    """Any belief at all."""
    rng = np.random.default_rng(seed)
    table = rng.dirichlet(np.full(int(np.prod(SHAPE)), 0.05)).reshape(SHAPE)
    return Encounter(table, int(rng.integers(len(SIDES_M))))


def ttc_class(seconds: float) -> int:
    return int(np.searchsorted(TTC_EDGES_S, seconds, side="right")) - 1


@pytest.mark.parametrize("seed", range(3))
def test_expected_utility_is_the_sum_over_the_whole_joint_table(seed: int) -> None:
    met = random_belief(seed)
    odds = (1.0 - SETTINGS.yields, SETTINGS.yields)
    collision = collision_table(SETTINGS)[met.side]
    loss = loss_table(SETTINGS)
    expected = [0.0] * len(ACTS)
    for a, w, y, t, n, hit in product(
        range(len(ACTS)), range(3), range(2), range(SHAPE[1]), range(SHAPE[2]), range(2)
    ):
        p_hit = collision[a, w, y, t, n]
        joint = met.what[w, t, n] * odds[y] * (p_hit if hit else 1.0 - p_hit)
        expected[a] += joint * (-SETTINGS.collision * hit - loss[a, w])
    found = decide(met, SETTINGS)
    np.testing.assert_allclose(found.expected_utility, expected, atol=1e-9)
    assert found.act == ACTS[int(np.argmax(expected))]


@pytest.mark.parametrize("seed", range(5))
def test_pyagrum_solves_the_influence_diagram_alike(seed: int) -> None:
    met = random_belief(seed)
    diagram = gum.InfluenceDiagram()
    states = int(np.prod(SHAPE))
    seen = diagram.addChanceNode(gum.RangeVariable("seen", "what, ttc, line", 0, states - 1))
    yields = diagram.addChanceNode(gum.RangeVariable("yields", "", 0, 1))
    hit = diagram.addChanceNode(gum.RangeVariable("hit", "", 0, 1))
    act = diagram.addDecisionNode(gum.LabelizedVariable("act", "", list(ACTS)))
    crash = diagram.addUtilityNode(gum.RangeVariable("crash", "", 0, 0))
    time = diagram.addUtilityNode(gum.RangeVariable("time", "", 0, 0))
    arcs = [(seen, hit), (yields, hit), (act, hit), (hit, crash), (act, time), (seen, time)]
    for tail, head in arcs:
        diagram.addArc(tail, head)
    diagram.cpt(seen)[:] = met.what.ravel()
    diagram.cpt(yields)[:] = [1.0 - SETTINGS.yields, SETTINGS.yields]
    collision = collision_table(SETTINGS)[met.side]  # act, what, yields, ttc, line
    loss = loss_table(SETTINGS)
    for a, name in enumerate(ACTS):
        for k, (w, t, n) in enumerate(np.ndindex(SHAPE)):
            diagram.utility(time)[{"act": name, "seen": k}] = -loss[a, w]
            for y in range(2):
                p = float(collision[a, w, y, t, n])
                diagram.cpt(hit)[{"act": name, "seen": k, "yields": y}] = [1.0 - p, p]
    diagram.utility(crash)[:] = np.array([[0.0], [-SETTINGS.collision]])
    solver = gum.ShaferShenoyLIMIDInference(diagram)
    solver.makeInference()
    found = decide(met, SETTINGS)
    assert solver.MEU()["mean"] == pytest.approx(float(found.expected_utility.max()), abs=1e-6)
    best = solver.optimalDecision("act").argmax()[0][0]["act"]
    assert ACTS[best] == found.act


def test_acts_that_anybody_would_choose() -> None:
    soon = ttc_class(2.3)
    at = {round(float(line), 2): k for k, line in enumerate(LINES_M)}
    assert decide(belief(2, soon, at[0.4]), SETTINGS).act == "pull aside right"
    assert decide(belief(2, soon, at[-0.4]), SETTINGS).act == "pull aside left"
    assert decide(belief(2, soon, at[0.65]), SETTINGS).act == "continue"
    assert decide(belief(1, ttc_class(1.6), at[0.0]), SETTINGS).act == "stop"
    assert decide(belief(1, ttc_class(12.0), at[0.0]), SETTINGS).act == "continue"
    assert decide(belief(0, soon, at[0.0]), SETTINGS).act == "continue"


def test_a_robot_that_is_aside_already_stays() -> None:
    left = int(np.abs(SIDES_M - 0.6).argmin())
    met = belief(2, ttc_class(1.1), 2, left)  # a person on the line at -0.2
    assert decide(met, SETTINGS).act == "pull aside left"


def test_who_comes_down_the_middle_makes_the_robot_pull_aside() -> None:
    found = decide(belief(2, ttc_class(2.6), 4), SETTINGS)
    assert found.act.startswith("pull aside")
    assert found.side in ("left", "right")
    # Room takes 0.55 / 0.3 = 1.83 s: with a second left it is too late for that.
    table = collision_table(SETTINGS)[MIDDLE]
    late, timely = ttc_class(0.7), ttc_class(2.6)
    assert table[ACTS.index("pull aside left"), 2, 0, late, 4] == 1.0
    assert table[ACTS.index("pull aside left"), 2, 0, timely, 4] == 0.0


def test_collision_probabilities_follow_from_the_geometry() -> None:
    table = collision_table(SETTINGS)
    assert table.shape == (len(SIDES_M), len(ACTS), 3, 2, TTC_CLASSES, len(LINES_M))
    assert ((table >= 0.0) & (table <= 1.0)).all()
    assert (table[:, :, 0] == 0.0).all()  # a false echo hits nobody
    assert (table[MIDDLE, 0, 2, 0, :, 4] == 1.0).all()  # head on, does not yield
    assert (table[MIDDLE, 0, 2, 0, :, [0, 8]] == 0.0).all()  # beyond 0.55 m
    # Left and right are alike: mirror the side, the act and the line.
    mirror = [
        ACTS.index(a.replace("left", "?").replace("right", "left").replace("?", "right"))
        for a in ACTS
    ]
    seen = table[:, :, :, 0]
    np.testing.assert_allclose(seen, seen[::-1, mirror][..., ::-1], atol=1e-12)


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10_000), st.floats(0.0, 1.0))
def test_more_likely_collision_never_raises_the_utility_of_continue(
    seed: int, share: float
) -> None:
    met = random_belief(seed)
    odds = np.array([1.0 - SETTINGS.yields, SETTINGS.yields])
    risk = np.einsum("wytl,y->wtl", collision_table(SETTINGS)[met.side, 0], odds)
    # A share of the belief moves from one cell to another that is at least as dangerous.
    rng = np.random.default_rng(seed)
    walkers = [(2, t, n) for t, n in np.ndindex(SHAPE[1:])]
    a, b = (walkers[k] for k in rng.choice(len(walkers), 2, replace=False))
    safe, dangerous = (a, b) if risk[a] <= risk[b] else (b, a)
    worse = met.what.copy()
    worse[dangerous] += share * worse[safe]
    worse[safe] *= 1.0 - share
    before = decide(met, SETTINGS).expected_utility[0]
    after = decide(replace(met, what=worse), SETTINGS).expected_utility[0]
    assert after <= before + 1e-9


@settings(max_examples=20, deadline=None)
@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0), st.integers(0, 1000))
def test_fewer_who_yield_never_raise_the_utility_of_continue(
    one: float, two: float, seed: int
) -> None:
    met = random_belief(seed)
    few, many = sorted([round(one, 1), round(two, 1)])
    utility: list[NDArray[np.float64]] = [
        decide(met, Settings(yields=p)).expected_utility for p in (few, many)
    ]
    assert utility[0][0] <= utility[1][0] + 1e-9


def test_the_encounter_is_the_same_belief_in_classes() -> None:
    thing = born(0, 6.0, 0.07, 0.0, 1.0, EchoModel())
    met = encounter(thing, 0.13, SETTINGS)
    assert met.what.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(
        met.what.sum(axis=(1, 2)), [thing.false, thing.standing, thing.approaching]
    )
    np.testing.assert_allclose(met.what[2].sum(axis=0), thing.weight[1:].sum(axis=0))
    assert SIDES_M[met.side] == pytest.approx(0.15)
    # 6.25 m away, gap 5.7 m: at 1.4 + 0.085 m/s 3.8 s, at 2.085 m/s 2.7 s.
    walks = met.what[2].sum(axis=1)
    assert walks[: ttc_class(2.6)].sum() == 0.0
    assert walks[ttc_class(2.6)] > 0.0


def tracker_with(thing: Thing, time_s: float = 1.0) -> Tracker:
    return Tracker(time_s=time_s, things=(thing,), last_alert_s=time_s)


def test_one_echo_is_not_acted_on_and_two_are() -> None:
    thing = replace(born(0, 3.0, 0.04, 0.0, 1.0, EchoModel()), false=0.0)
    weight = np.zeros_like(thing.weight)
    weight[4, 7] = 1.0  # 1.2 m/s on the line at 0.4 m
    thing = replace(thing, weight=weight)
    assert react(tracker_with(thing), SETTINGS) is None
    acted = react(tracker_with(replace(thing, pings=2)), SETTINGS)
    assert acted is not None
    assert (acted.act, acted.side) == ("pull aside right", "right")
    assert acted.approaching == pytest.approx(1.0)
    assert acted.cells == len(ACTS)


def test_an_act_waits_for_another_ping_while_it_can() -> None:
    far = born(0, 9.0, 0.1, 0.0, 1.0, EchoModel())
    weight = far.weight.copy()
    weight[0] = 0.0
    unsure = replace(far, weight=0.9 * weight / weight.sum(), false=0.1, pings=2)
    assert react(tracker_with(unsure), SETTINGS) is None
    hasty = replace(SETTINGS, sure=0.0)
    decided = react(tracker_with(unsure), hasty)
    assert decided is not None and decided.act.startswith("pull aside")


def test_with_nothing_ahead_the_robot_goes_on() -> None:
    said = react(Tracker(), SETTINGS)
    assert said is not None and said.act == "continue"
    waiting = Tracker(time_s=10.0, last_alert_s=8.0)
    assert react(waiting, SETTINGS) is None
    over = react(replace(waiting, time_s=11.0), SETTINGS)
    assert over is not None and over.act == "continue"
