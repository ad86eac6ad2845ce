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

from modules.reactor import Settings, Tracker, compiled, react
from modules.reactor.meeting import ACTS, CONTINUE
from modules.reactor.react import Encounter, encounter, outlook, utilities
from modules.reactor.tables import (
    SIDES_M,
    STANDS_EDGES_M,
    TTC_CLASSES,
    TTC_EDGES_S,
    WHAT,
    Diagram,
    collision_table,
    loss_table,
)
from modules.reactor.thing import LINE_PRIOR, LINES_M, SPEEDS_M_S, EchoModel
from tests.reactor.things import born, line_at, reweighed, tracker_with, walker

SETTINGS = Settings()
DIAGRAM = compiled(SETTINGS)
gum: Any = pyagrum  # it has no types
MIDDLE = len(SIDES_M) // 2
SHAPE = (len(WHAT), TTC_CLASSES, len(LINES_M))


def belief(what: int, ttc: int, line: int, side: int = MIDDLE) -> Encounter:
    """Certainty."""
    table = np.zeros(SHAPE)
    table[what, ttc, line] = 1.0
    return Encounter(table, side, 0.0)


def random_belief(seed: int) -> Encounter:
    """Any belief at all."""
    rng = np.random.default_rng(seed)
    table = rng.dirichlet(np.full(int(np.prod(SHAPE)), 0.05)).reshape(SHAPE)
    return Encounter(table, int(rng.integers(len(SIDES_M))), 0.0)


def expected(
    met: Encounter, diagram: Diagram = DIAGRAM, doing: str = "continue"
) -> NDArray[np.float64]:
    """Expected utility of each act."""
    return utilities([outlook(met, diagram)], ACTS.index(doing), diagram)


def best(met: Encounter, doing: str = "continue") -> str:
    """The best act."""
    return ACTS[int(expected(met, doing=doing).argmax())]


def ttc_class(seconds: float) -> int:
    return int(np.searchsorted(TTC_EDGES_S, seconds, side="right")) - 1


def place_class(ahead_m: float) -> int:
    return int(np.searchsorted(STANDS_EDGES_M, ahead_m, side="right")) - 1


@pytest.mark.parametrize("seed", range(3))
def test_expected_utility_is_the_sum_over_the_whole_joint_table(seed: int) -> None:
    met = random_belief(seed)
    odds = (1.0 - SETTINGS.yields, SETTINGS.yields)
    collision = collision_table(SETTINGS)[met.side]
    loss = loss_table(SETTINGS)
    by_hand = [0.0 if act == "continue" else -SETTINGS.change_s for act in ACTS]
    for a, w, y, t, n, hit in product(
        range(len(ACTS)), range(3), range(2), range(SHAPE[1]), range(SHAPE[2]), range(2)
    ):
        p_hit = collision[a, w, y, t, n]
        joint = met.what[w, t, n] * odds[y] * (p_hit if hit else 1.0 - p_hit)
        by_hand[a] += joint * (-SETTINGS.collision * hit - loss[a, w])
    np.testing.assert_allclose(expected(met), by_hand, atol=1e-9)


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
            change = 0.0 if name == "continue" else SETTINGS.change_s
            diagram.utility(time)[{"act": name, "seen": k}] = -loss[a, w] - change
            for y in range(2):
                p = float(collision[a, w, y, t, n])
                diagram.cpt(hit)[{"act": name, "seen": k, "yields": y}] = [1.0 - p, p]
    diagram.utility(crash)[:] = np.array([[0.0], [-SETTINGS.collision]])
    solver = gum.ShaferShenoyLIMIDInference(diagram)
    solver.makeInference()
    assert solver.MEU()["mean"] == pytest.approx(float(expected(met).max()), abs=1e-6)
    assert ACTS[solver.optimalDecision("act").argmax()[0][0]["act"]] == best(met)


def test_acts_that_anybody_would_choose() -> None:
    soon = ttc_class(2.3)
    assert best(belief(2, soon, line_at(0.35))) == "pull aside right"
    assert best(belief(2, soon, line_at(-0.35))) == "pull aside left"
    assert best(belief(2, soon, line_at(0.65))) == "continue"
    assert best(belief(1, place_class(1.1), line_at(0.22))) == "pass right"
    assert best(belief(1, place_class(1.1), line_at(-0.22))) == "pass left"
    assert best(belief(1, place_class(1.1), line_at(0.65))) == "continue"
    assert best(belief(0, soon, line_at(0.0))) == "continue"


def test_a_robot_that_is_aside_already_stays() -> None:
    left = int(np.abs(SIDES_M - 0.65).argmin())
    met = belief(2, ttc_class(1.1), line_at(-0.22), left)
    assert best(met, "pull aside left") == "pull aside left"


def test_a_robot_that_passes_stays_aside_until_the_thing_is_behind() -> None:
    right = 0  # SIDES_M[0] = -0.65
    for ahead_m in (0.7, 0.1, -0.1):
        met = belief(1, place_class(ahead_m), line_at(0.0), right)
        assert best(met, "pass right") == "pass right"
    assert best(belief(1, place_class(-0.58), line_at(0.0), right), "pass right") == "continue"


def test_where_neither_side_is_free_it_stops() -> None:
    wide = [belief(1, place_class(0.9), line_at(left_m)) for left_m in (-0.45, 0.0, 0.45)]
    together = utilities([outlook(met, DIAGRAM) for met in wide], CONTINUE, DIAGRAM)
    assert ACTS[int(together.argmax())] == "stop"


def test_it_does_not_change_its_mind_for_a_trifle() -> None:
    # A person on the centre line, for whom both sides are as good.
    met = belief(2, ttc_class(2.6), line_at(0.0))
    for act in ("pull aside left", "pull aside right"):
        assert best(met, act) == act
    found = expected(met, doing="pull aside left")
    left, right = found[ACTS.index("pull aside left")], found[ACTS.index("pull aside right")]
    assert left - right == pytest.approx(SETTINGS.cross_s)


def test_who_comes_down_the_middle_makes_the_robot_pull_aside() -> None:
    assert best(belief(2, ttc_class(2.6), line_at(0.0))).startswith("pull aside")
    # Room takes 0.5 / 0.3 = 1.67 s: with a second left it is too late for that.
    table = collision_table(SETTINGS)[MIDDLE]
    late, timely = ttc_class(0.7), ttc_class(2.6)
    assert table[ACTS.index("pull aside left"), 2, 0, late, line_at(0.0)] == 1.0
    assert table[ACTS.index("pull aside left"), 2, 0, timely, line_at(0.0)] == 0.0


def test_collision_probabilities_follow_from_the_geometry() -> None:
    table = collision_table(SETTINGS)
    assert table.shape == (len(SIDES_M), len(ACTS), 3, 2, TTC_CLASSES, len(LINES_M))
    assert ((table >= 0.0) & (table <= 1.0)).all()
    assert (table[:, :, 0] == 0.0).all()  # a false echo hits nobody
    assert (table[MIDDLE, 0, 2, 0, :, line_at(0.0)] == 1.0).all()  # head on, does not yield
    assert (table[MIDDLE, 0, 2, 0, :, [0, -1]] == 0.0).all()  # beyond 0.5 m
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
    assert expected(replace(met, what=worse))[CONTINUE] <= expected(met)[CONTINUE] + 1e-9


@settings(max_examples=20, deadline=None)
@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0), st.integers(0, 1000))
def test_fewer_who_yield_never_raise_the_utility_of_continue(
    one: float, two: float, seed: int
) -> None:
    met = random_belief(seed)
    few, many = sorted([round(one, 1), round(two, 1)])
    utility = [expected(met, compiled(Settings(yields=p)))[CONTINUE] for p in (few, many)]
    assert utility[0] <= utility[1] + 1e-9


def test_two_things_threaten_together() -> None:
    # One person on either side: what is safe for the one is not for the other.
    soon = ttc_class(2.6)
    apart = [belief(2, soon, line_at(left_m)) for left_m in (-0.35, 0.35)]
    assert [best(met) for met in apart] == ["pull aside left", "pull aside right"]
    both = utilities([outlook(met, DIAGRAM) for met in apart], CONTINUE, DIAGRAM)
    one, two = expected(apart[0]), expected(apart[1])
    assert (both <= np.minimum(one, two) + 1e-9).all()
    assert (both >= one + two - 1e-9).all()


def test_left_and_right_are_alike_to_the_last_bit() -> None:
    table = collision_table(SETTINGS)
    assert (
        table[0].tobytes()
        == np.ascontiguousarray(table[-1][[0, 1, 2, 4, 3, 6, 5, 7]][..., ::-1]).tobytes()
    )


def test_the_encounter_is_the_same_belief_in_classes() -> None:
    thing = born(0, 6.0, 0.07, 0.0, 1.0, EchoModel())
    met = encounter(thing.belief, thing.false, 0.13, SETTINGS)
    assert met.what.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(
        met.what.sum(axis=(1, 2)), [thing.false, thing.standing, thing.approaching]
    )
    np.testing.assert_allclose(met.what[2].sum(axis=0), thing.weight[1:].sum(axis=0))
    assert SIDES_M[met.side] == pytest.approx(0.15)
    # 6.25 m away, gap 5.75 m: at 2.085 m/s it is here in 2.76 s.
    walks = met.what[2].sum(axis=1)
    assert walks[: ttc_class(2.6)].sum() == 0.0
    assert walks[ttc_class(2.6)] > 0.0
    assert encounter(thing.belief, thing.false, 0.0, replace(SETTINGS, soon_s=2.7)).soon == 0.0
    hasty = encounter(thing.belief, thing.false, 0.0, replace(SETTINGS, soon_s=1e9))
    assert hasty.soon == pytest.approx(1.0 - thing.false)


def tracked(ahead_m: float, speed_m_s: float, left_m: float, p: float, pings: int = 4) -> Tracker:
    """A tracker that knows of one person, but for a probability of 1 - p."""
    return tracker_with(walker(ahead_m, speed_m_s, left_m, p, pings))


def test_one_echo_is_not_acted_on_and_two_are() -> None:
    assert react(tracked(3.0, 1.2, 0.35, 1.0, pings=1), "continue", DIAGRAM) is None
    acted = react(tracked(3.0, 1.2, 0.35, 1.0, pings=2), "continue", DIAGRAM)
    assert acted is not None and acted.due
    assert acted.act == "pull aside right"
    assert acted.approaching == pytest.approx(1.0)
    assert acted.cells == len(ACTS)


def test_an_act_waits_for_another_ping_while_it_can() -> None:
    far = tracked(9.0, 1.2, 0.35, 0.9)
    waits = react(far, "continue", DIAGRAM)
    assert waits is not None and waits.act == "pull aside right" and not waits.due
    assert waits.cells > 0  # thinking is work, whether or not it comes to anything
    hasty = react(far, "continue", compiled(replace(SETTINGS, sure=0.5)))
    assert hasty is not None and hasty.due
    near = react(tracked(2.5, 1.2, 0.35, 0.9), "continue", DIAGRAM)
    assert near is not None and near.due


def test_an_act_waits_while_the_side_is_not_known() -> None:
    thing = born(0, 7.0, 0.04, 0.0, 1.0, EchoModel())
    weight = np.zeros_like(thing.weight)
    row = int(np.abs(SPEEDS_M_S - 1.2).argmin())
    weight[row, [line_at(-0.22), line_at(0.22)]] = 0.2, 0.8
    waits = react(tracker_with(reweighed(thing, weight, 3)), "continue", DIAGRAM)
    assert waits is not None and waits.act == "pull aside right" and not waits.due
    weight[row, [line_at(-0.22), line_at(0.22)]] = 0.0, 1.0
    knows = react(tracker_with(reweighed(thing, weight, 3)), "continue", DIAGRAM)
    assert knows is not None and knows.due


def test_going_on_is_a_decision_too() -> None:
    said = react(tracked(6.0, 1.2, 0.65, 1.0), "continue", DIAGRAM)
    assert said is not None
    assert (said.act, said.due, said.newest_s) == ("continue", True, 1.0)
    unsure = react(tracked(6.0, 1.2, 0.65, 0.9), "continue", DIAGRAM)
    assert unsure is not None and not unsure.due
    assert unsure.newest_s == -np.inf


def test_what_most_likely_is_a_false_echo_holds_nobody_up() -> None:
    thing = born(0, 0.8, 0.04, -0.65, 1.0, EchoModel())
    weight = np.zeros_like(thing.weight)
    weight[0] = 0.03 * LINE_PRIOR  # stands, beside the robot, where no cone will ever hear it
    known = tracker_with(reweighed(thing, weight, 2), time_s=20.0, stands_at_m=0.8)
    over = react(replace(known, last_alert_s=10.0), "pull aside right", DIAGRAM)
    assert over is not None and over.due and over.act == "continue"


def test_with_nothing_ahead_there_is_nothing_to_think_about() -> None:
    assert react(Tracker(), "continue", DIAGRAM) is None
    waiting = Tracker(time_s=10.0, last_alert_s=8.0)
    assert react(waiting, "pull aside left", DIAGRAM) is None
    over = react(replace(waiting, time_s=11.0), "pull aside left", DIAGRAM)
    assert over is not None and over.due and over.act == "continue"
    np.testing.assert_allclose(over.expected_utility, -loss_table(SETTINGS)[:, 0])


def test_it_stays_aside_until_it_is_clear_whatever_is_best() -> None:
    past = tracked(6.0, 1.2, 0.65, 0.9)  # nothing says any more that he is in the way
    stays = react(past, "stop", compiled(replace(SETTINGS, change_s=0.0)))
    assert stays is not None and stays.act == "continue" and not stays.due
