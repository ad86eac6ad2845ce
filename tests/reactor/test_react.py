"""Acts by expected utility: brute force, a second library, and what must hold anyway."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from modules.reactor import Settings, Tracker, compiled, react
from modules.reactor.declared import declare, solve
from modules.reactor.diagram import (
    CART,
    COMES_FAST,
    COMES_SLOWLY,
    DOOR_LEAF,
    ECHO,
    FALSE_ECHO,
    HEARD,
    INTENT,
    KEEPS_ON,
    LEFT_OBJECT,
    PERSON,
    STANDS,
    WHAT,
    change_table,
    intent_table,
    severity_table,
    time_table,
    what_table,
)
from modules.reactor.meeting import ACTS, CONTINUE
from modules.reactor.react import Encounter, encounter, outlook, utilities
from modules.reactor.room import Room, rooms_of
from modules.reactor.sides import Sides
from modules.reactor.tables import (
    ROOMS_M,
    SIDES_M,
    STANDS_EDGES_M,
    TTC_CLASSES,
    TTC_EDGES_S,
    Diagram,
    collision_table,
    loss_table,
)
from modules.reactor.thing import COLUMNS, LINE_PRIOR, LINES_M, SINGLE, SPEEDS_M_S, EchoModel
from tests.reactor.things import born, line_at, reweighed, tracker_with, walker

SETTINGS = Settings()
DIAGRAM = compiled(SETTINGS)
MIDDLE = len(SIDES_M) // 2
SHAPE = (len(HEARD), TTC_CLASSES, COLUMNS)
WIDEST = len(ROOMS_M) - 1
MIRRORED = [*range(SINGLE)[::-1], *(SINGLE + k for k in (0, 2, 1, 4, 3))]


def belief(heard: int, ttc: int, line: int, side: int = MIDDLE) -> Encounter:
    """Certainty of what is heard."""
    table = np.zeros(SHAPE)
    table[heard, ttc, line] = 1.0
    return Encounter(table, side, 0.0)


def random_belief(seed: int, cells: int = 100) -> Encounter:
    """Any belief at all, over so many cells."""
    rng = np.random.default_rng(seed)
    table = np.zeros(int(np.prod(SHAPE)))
    table[rng.choice(len(table), cells, replace=False)] = rng.dirichlet(np.full(cells, 0.3))
    return Encounter(table.reshape(SHAPE), int(rng.integers(len(SIDES_M))), 0.0)


def random_encounter(seed: int, cells: int) -> tuple[Encounter, str, tuple[int, int]]:
    """A belief, what the robot does, and the classes of room left and right."""
    rng = np.random.default_rng([seed, 3])
    left, right = (int(room) for room in rng.integers(len(ROOMS_M), size=2))
    return random_belief(seed, cells), ACTS[int(rng.integers(len(ACTS)))], (left, right)


def as_room(classes: tuple[int, int]) -> Room:
    return Room(*(float(ROOMS_M[k]) for k in classes))


def compiled_answer(met: Encounter, doing: str, room: tuple[int, int]) -> NDArray[np.float64]:
    """Expected utility of each act by the compiled diagram."""
    seen = outlook(met, DIAGRAM, Sides(as_room(room), np.zeros(len(ACTS))))
    return utilities([seen], ACTS.index(doing), DIAGRAM)


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


@pytest.mark.parametrize("seed", range(12))
def test_expected_utility_is_the_sum_over_the_whole_joint_table(seed: int) -> None:
    met, doing, room = random_encounter(seed, 100)
    what, intent = what_table(SETTINGS), intent_table(SETTINGS)
    severity, time = severity_table(SETTINGS), time_table(SETTINGS)
    rooms = rooms_of(as_room(room))
    collision = collision_table(SETTINGS)[met.side]
    by_hand = -change_table(SETTINGS)[ACTS.index(doing)]
    at = [tuple(cell) for cell in np.argwhere(met.heard > 0.0).tolist()]
    for a, w, i, (h, t, n), hit in product(
        range(len(ACTS)), range(len(WHAT)), range(len(INTENT)), at, range(2)
    ):
        p_hit = collision[rooms[a], a, w, i, t, n]
        joint = met.heard[h, t, n] * what[h, w] * intent[w, i] * (p_hit if hit else 1.0 - p_hit)
        by_hand[a] += joint * (-SETTINGS.collision * severity[a, w] * hit - time[a, w, i])
    np.testing.assert_allclose(compiled_answer(met, doing, room), by_hand, atol=1e-9)


@pytest.mark.parametrize("seed", range(30))
def test_pyagrum_solves_the_influence_diagram_alike(seed: int) -> None:
    met, doing, room = random_encounter(seed, 6)
    found = compiled_answer(met, doing, room)
    solved = solve(declare(met.heard, met.side, room, doing, SETTINGS))
    assert solved.expected_utility == pytest.approx(float(found.max()), abs=1e-6)
    assert solved.act == ACTS[int(found.argmax())]


def test_all_five_classes_and_both_intents_can_be() -> None:
    reached = what_table(SETTINGS).max(axis=0)
    assert dict(zip(WHAT, reached > 0.0, strict=True)) == dict.fromkeys(WHAT, True)
    intents = intent_table(SETTINGS)
    assert (intents[[DOOR_LEAF, PERSON]] > 0.0).all()
    assert (intents[[ECHO, LEFT_OBJECT, CART], KEEPS_ON] == 1.0).all()
    # what each is believed to be changes what is done about it
    utilities_by_class = {
        (collision_table(SETTINGS)[MIDDLE, WIDEST, :, w].sum(), time_table(SETTINGS)[:, w].sum())
        for w in range(len(WHAT))
    }
    assert len(utilities_by_class) == len(WHAT)


def test_what_a_change_of_mind_costs() -> None:
    change = change_table(SETTINGS)

    def costs(now: str, then: str) -> float:
        return float(change[ACTS.index(now), ACTS.index(then)])

    assert (np.diag(change) == 0.0).all()
    for one, other in (("left", "right"), ("right", "left")):
        assert costs(f"pull aside {one}", f"pull aside {other}") == SETTINGS.cross_s
        assert costs(f"pass {one}", f"pull aside {other}") == SETTINGS.cross_s
        assert costs(f"pass {one}", f"pass {other}") == SETTINGS.turn_back_s
        assert costs(f"pass {one}", f"pull aside {one}") == SETTINGS.change_s
    assert costs("continue", "slow") == costs("stop", "continue") == SETTINGS.change_s
    assert costs("slow", "continue") == 0.0


def test_to_drive_on_after_driving_slowly_is_no_change_of_mind() -> None:
    beside = belief(STANDS, place_class(1.1), line_at(0.65))
    assert best(beside, "slow") == "continue"


def test_every_probability_of_the_diagram_is_one() -> None:
    assert what_table(SETTINGS).sum(axis=1) == pytest.approx(np.ones(len(HEARD)))
    assert intent_table(SETTINGS).sum(axis=1) == pytest.approx(np.ones(len(WHAT)))
    assert (severity_table(SETTINGS) <= 1.0).all() and (severity_table(SETTINGS) > 0.0).all()


def test_who_comes_slowly_is_more_likely_to_push_a_cart() -> None:
    what = what_table(SETTINGS)
    assert what[COMES_SLOWLY, CART] > 5 * what[COMES_FAST, CART]
    # A cart is broader: aside at 0.65 m the robot is touched by one that comes at 0.08 off.
    table = collision_table(SETTINGS)[MIDDLE, WIDEST, ACTS.index("pull aside left")]
    early, line = ttc_class(5.0), line_at(0.08)
    assert table[CART, KEEPS_ON, early, line] == 1.0
    assert table[PERSON, KEEPS_ON, early, line] == 0.0


def test_the_less_room_the_less_going_aside_helps() -> None:
    early, line = ttc_class(5.0), line_at(-0.12)
    left = ACTS.index("pull aside left")
    risk = [
        collision_table(SETTINGS)[MIDDLE, room, left, PERSON, KEEPS_ON, early, line]
        for room in range(len(ROOMS_M))
    ]
    assert risk == sorted(risk, reverse=True)
    assert risk[0] == 1.0 and risk[-1] == 0.0
    right = collision_table(SETTINGS)[MIDDLE, :, ACTS.index("stop")]
    assert (right == right[0]).all()


def test_a_way_that_was_seen_to_be_open_is_taken() -> None:
    met, wide = belief(STANDS, place_class(0.7), line_at(0.0)), Room(0.65, 0.65)
    for known, act in ((0.0, "pass left"), (1.0, "continue")):
        seen = outlook(met, DIAGRAM, Sides(wide, np.full(len(ACTS), known)))
        assert ACTS[int(utilities([seen], CONTINUE, DIAGRAM).argmax())] == act
    walks = belief(COMES_FAST, ttc_class(2.3), line_at(0.0))
    seen = outlook(walks, DIAGRAM, Sides(wide, np.ones(len(ACTS))))
    # Who comes is not there yet: that the way is open says nothing of him.
    assert seen.risk[CONTINUE] > 0.3


def test_acts_that_anybody_would_choose() -> None:
    soon = ttc_class(2.3)
    assert best(belief(COMES_FAST, soon, line_at(0.35))) == "pull aside right"
    assert best(belief(COMES_FAST, soon, line_at(-0.35))) == "pull aside left"
    assert best(belief(COMES_FAST, soon, line_at(0.65))) == "continue"
    assert best(belief(STANDS, place_class(1.1), line_at(0.22))) == "pass right"
    assert best(belief(STANDS, place_class(1.1), line_at(-0.22))) == "pass left"
    assert best(belief(STANDS, place_class(1.1), line_at(0.65))) == "continue"
    assert best(belief(FALSE_ECHO, soon, line_at(0.0))) == "continue"


def test_a_robot_that_is_aside_already_stays() -> None:
    left = int(np.abs(SIDES_M - 0.65).argmin())
    met = belief(COMES_FAST, ttc_class(1.1), line_at(-0.22), left)
    assert best(met, "pull aside left") == "pull aside left"


def test_a_robot_that_passes_stays_aside_until_the_thing_is_behind() -> None:
    right = 0  # SIDES_M[0] = -0.65
    for ahead_m in (0.7, 0.1, -0.1):
        met = belief(STANDS, place_class(ahead_m), line_at(0.0), right)
        assert best(met, "pass right") == "pass right"
    assert best(belief(STANDS, place_class(-0.58), line_at(0.0), right), "pass right") == "continue"


def test_where_neither_side_is_free_it_creeps_up_to_what_stands_and_stops_for_who_comes() -> None:
    def best_of(heard: int, when: int) -> str:
        wide = [belief(heard, when, line_at(left_m)) for left_m in (-0.35, 0.0, 0.35)]
        together = utilities([outlook(met, DIAGRAM) for met in wide], CONTINUE, DIAGRAM)
        return ACTS[int(together.argmax())]

    half_speed = {"slow", "pass left", "pass right"}
    assert best_of(STANDS, place_class(0.9)) in half_speed
    assert best_of(COMES_FAST, ttc_class(2.6)) not in half_speed


def test_it_does_not_change_its_mind_for_a_trifle() -> None:
    # A person on the centre line, for whom both sides are as good.
    met = belief(COMES_FAST, ttc_class(2.6), line_at(0.0))
    for act in ("pull aside left", "pull aside right"):
        assert best(met, act) == act
    found = expected(met, doing="pull aside left")
    left, right = found[ACTS.index("pull aside left")], found[ACTS.index("pull aside right")]
    assert left - right == pytest.approx(SETTINGS.cross_s)


def test_who_comes_down_the_middle_makes_the_robot_pull_aside() -> None:
    assert best(belief(COMES_FAST, ttc_class(2.6), line_at(0.0))).startswith("pull aside")
    # Room takes 0.5 / 0.3 = 1.67 s: with a second left it is too late for that.
    table = collision_table(SETTINGS)[MIDDLE, WIDEST]
    late, timely = ttc_class(0.7), ttc_class(2.6)
    assert table[ACTS.index("pull aside left"), PERSON, KEEPS_ON, late, line_at(0.0)] == 1.0
    assert table[ACTS.index("pull aside left"), PERSON, KEEPS_ON, timely, line_at(0.0)] == 0.0


def test_collision_probabilities_follow_from_the_geometry() -> None:
    table = collision_table(SETTINGS)
    shape = (len(WHAT), len(INTENT), TTC_CLASSES, COLUMNS)
    assert table.shape == (len(SIDES_M), len(ROOMS_M), len(ACTS), *shape)
    assert ((table >= 0.0) & (table <= 1.0)).all()
    assert (table[:, :, :, ECHO] == 0.0).all()  # a false echo hits nobody
    head_on = table[MIDDLE, WIDEST, CONTINUE, PERSON, KEEPS_ON]
    assert (head_on[:, line_at(0.0)] == 1.0).all()
    assert (head_on[:, :SINGLE][:, np.abs(LINES_M) > 0.5] == 0.0).all()
    against_a_wall = table[MIDDLE, WIDEST, CONTINUE, LEFT_OBJECT, KEEPS_ON]
    assert (against_a_wall[:, :SINGLE][:, np.abs(LINES_M) > 0.75] == 0.0).all()


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10_000), st.floats(0.0, 1.0))
def test_more_likely_collision_never_raises_the_utility_of_continue(
    seed: int, share: float
) -> None:
    met = random_belief(seed)
    risk = DIAGRAM.risk[met.side, WIDEST, CONTINUE]
    # A share of the belief moves from one cell to another that is at least as dangerous.
    rng = np.random.default_rng(seed)
    walkers = [(COMES_FAST, t, n) for t, n in np.ndindex(SHAPE[1:])]
    a, b = (walkers[k] for k in rng.choice(len(walkers), 2, replace=False))
    safe, dangerous = (a, b) if risk[a] <= risk[b] else (b, a)
    worse = met.heard.copy()
    worse[dangerous] += share * worse[safe]
    worse[safe] *= 1.0 - share
    assert expected(replace(met, heard=worse))[CONTINUE] <= expected(met)[CONTINUE] + 1e-9


@settings(max_examples=10, deadline=None)
@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0), st.integers(0, 1000))
def test_fewer_who_yield_never_raise_the_utility_of_continue(
    one: float, two: float, seed: int
) -> None:
    met = random_belief(seed)
    shares = sorted([round(one), round(two)])
    makes_room = [(0.0, 0.0, 0.8, p, 0.0) for p in shares]
    utility = [expected(met, compiled(Settings(makes_room=m)))[CONTINUE] for m in makes_room]
    assert utility[0] <= utility[1] + 1e-9


def test_two_things_threaten_together() -> None:
    # One person on either side: what is safe for the one is not for the other.
    soon = ttc_class(2.6)
    apart = [belief(COMES_FAST, soon, line_at(left_m)) for left_m in (-0.35, 0.35)]
    assert [best(met) for met in apart] == ["pull aside left", "pull aside right"]
    both = utilities([outlook(met, DIAGRAM) for met in apart], CONTINUE, DIAGRAM)
    one, two = expected(apart[0]), expected(apart[1])
    assert (both <= np.minimum(one, two) + 1e-9).all()
    assert (both >= one + two - 1e-9).all()


def test_left_and_right_are_alike_to_the_last_bit() -> None:
    table = collision_table(SETTINGS)
    mirrored = np.ascontiguousarray(table[-1][:, [0, 1, 2, 4, 3, 6, 5, 7]][..., MIRRORED])
    assert table[0].tobytes() == mirrored.tobytes()


def test_the_encounter_is_the_same_belief_in_classes() -> None:
    thing = born(0, 6.0, 0.07, 0.0, 1.0, EchoModel())
    met = encounter(thing.belief, thing.false, 0.13, SETTINGS)
    assert met.heard.sum() == pytest.approx(1.0)
    np.testing.assert_allclose(
        [met.heard[0].sum(), met.heard[1].sum(), met.heard[2:].sum()],
        [thing.false, thing.standing, thing.approaching],
    )
    np.testing.assert_allclose(met.heard[2:].sum(axis=(0, 1)), thing.weight[1:].sum(axis=0))
    assert SIDES_M[met.side] == pytest.approx(0.15)
    # 6.25 m away, gap 5.75 m: at 2.085 m/s it is here in 2.76 s.
    walks = met.heard[2:].sum(axis=(0, 2))
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
