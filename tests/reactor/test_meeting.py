"""The reactor's own geometry of encounters against the stepped world's."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
import pytest

from modules.reactor.meeting import (
    ACTS,
    BEHIND_M,
    Body,
    Walking,
    least_separation_m,
    touches_standing,
    touches_walker,
)
from simworld import people

BODY, WALKING = Body(), Walking()
REACH = 0.5
DT_S = 0.01


def stepped_separation(
    act: people.Act, person: people.Person, lateral_m: float, lasts_s: float
) -> float:
    """Least separation by small steps of the simulated world."""
    robot = people.RobotInCorridor(0.0, lateral_m)
    walker = people.position(person, 0.0)
    least = np.inf
    for k in range(round(lasts_s / DT_S)):
        if walker is None:
            break
        least = min(least, people.separation(walker, robot))
        following = people.walked(person, walker, robot, k * DT_S, DT_S)
        robot = people.advance(robot, act, DT_S)
        walker = following
    return least


def test_words_and_figures_are_those_of_the_world() -> None:
    assert people.ACTS == ACTS
    assert asdict(people.Body()) == BODY._asdict()
    person = people.Person(0.0, 1.0)
    assert all(getattr(person, name) == value for name, value in WALKING._asdict().items())


def test_encounters_end_as_in_the_stepped_world() -> None:
    rng = np.random.default_rng(1)
    compared = touched = 0
    for k in range(180):
        act = people.ACTS[k % len(ACTS)]
        ahead, speed = float(rng.uniform(1.5, 8.0)), float(rng.uniform(0.6, 2.0))
        line, mine = float(rng.uniform(-0.75, 0.75)), float(rng.choice([-0.65, -0.3, 0.0, 0.65]))
        yields = bool(rng.random() < 0.5)
        person = people.Person(0.0, ahead, speed, line, yields)
        least = stepped_separation(act, person, mine, 15.0)
        if abs(least - REACH) < 0.03:
            continue  # the steps are too coarse to tell
        # Who yields looks at the robot in every step, in the closed form only when he notices it;
        # they differ where the robot comes from the far side meanwhile.
        if yields and act.startswith("pull aside") and mine != 0.0:
            continue
        motion = BODY.motion(act, mine)
        found = touches_walker(motion, yields, ahead, line, speed, BODY, WALKING)
        assert bool(found) == (least < REACH), (act, person, mine, least)
        compared, touched = compared + 1, touched + int(found)
    assert compared > 110
    assert 20 < touched < compared - 20


def hits(act: str, ahead_m: float, line_m: float, mine_m: float = 0.0) -> bool:
    """Whether an act ends at a thing that stands."""
    return bool(touches_standing(BODY.motion(act, mine_m), ahead_m, line_m, BODY, WALKING))


def test_a_thing_that_stands_is_in_the_way_until_it_is_passed() -> None:
    for line in (-0.49, 0.0, 0.49):
        assert hits("continue", 1.5, line) and hits("slow", 1.5, line)
        assert not any(hits(act, 1.5, line) for act in ("stop", "back up", "pull aside left"))
    assert not hits("continue", 1.5, 0.51)
    # It is passed on the side that it leaves free: 0.65 - 0.5 = 0.15.
    assert not hits("pass left", 1.5, 0.15) and not hits("pass right", 1.5, -0.15)
    assert hits("pass left", 1.5, 0.16) and hits("pass right", 1.5, -0.16)
    # Abreast of it the robot that is aside stays so; behind it returns.
    assert hits("continue", 0.1, 0.0, -0.65) and not hits("pass right", 0.1, 0.0, -0.65)
    assert not hits("continue", -BEHIND_M, 0.0, -0.65)


def test_passing_a_thing_ends_as_in_the_stepped_world() -> None:
    rng = np.random.default_rng(3)
    told = 0
    for k in range(24):
        act = people.ACTS[k % len(ACTS)]
        line, mine = float(rng.uniform(-0.75, 0.75)), float(rng.choice([-0.65, 0.0, 0.65]))
        least = stepped_separation(act, people.Person(0.0, 1.2, 0.0, line), mine, 60.0)
        if abs(least - REACH) > 0.03:
            assert hits(act, 1.2, line, mine) == (least < REACH), (act, line, mine, least)
            told += 1
    assert told > 16


def test_who_walks_near_the_centre_line_is_missed_on_whichever_side() -> None:
    for act in ("pull aside left", "pull aside right"):
        for line in (-0.15, 0.0, 0.15):
            motion = BODY.motion(act, 0.0)
            assert not touches_walker(motion, False, 6.0, line, 1.3, BODY, WALKING)
    assert touches_walker(BODY.motion("pull aside left", 0.0), False, 6.0, 0.16, 1.3, BODY, WALKING)


def test_least_separation_of_a_straight_piece() -> None:
    # From (3, 1) to (-3, 1): passes at 1.
    assert least_separation_m(3.0, 1.0, -3.0, 1.0) == pytest.approx(1.0)
    assert least_separation_m(3.0, 4.0, 3.0, 4.0) == pytest.approx(5.0)
    assert least_separation_m(-3.0, 4.0, -6.0, 4.0) == pytest.approx(5.0)  # from its beginning


def test_dead_reckoning_across_the_corridor() -> None:
    assert BODY.across_m("pull aside left", 0.0, 1.0) == pytest.approx(0.3)
    assert BODY.across_m("pull aside right", 0.0, 9.0) == pytest.approx(-0.65)
    assert BODY.across_m("continue", -0.6, 1.0) == pytest.approx(-0.3)
    assert BODY.across_m("stop", -0.6, 1.0) == -0.6
