"""The reactor's own geometry of encounters against the stepped world's."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
import pytest

from modules.reactor.meeting import (
    ACTS,
    Body,
    Walking,
    least_separation_m,
    touches_standing,
    touches_walker,
)
from simworld import people

BODY, WALKING = Body(), Walking()
REACH = 0.55
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
    assert asdict(people.Body()) == asdict(BODY)
    person = people.Person(0.0, 1.0)
    assert all(getattr(person, name) == value for name, value in asdict(WALKING).items())


def test_encounters_end_as_in_the_stepped_world() -> None:
    rng = np.random.default_rng(1)
    compared = touched = 0
    for k in range(180):
        act = people.ACTS[k % len(ACTS)]
        ahead, speed = float(rng.uniform(1.5, 8.0)), float(rng.uniform(0.6, 2.0))
        line, mine = float(rng.uniform(-0.75, 0.75)), float(rng.choice([-0.6, -0.3, 0.0, 0.6]))
        yields = bool(rng.random() < 0.5)
        person = people.Person(0.0, ahead, speed, line, yields)
        least = stepped_separation(act, person, mine, 15.0)
        if abs(least - REACH) < 0.03:
            continue  # the steps are too coarse to tell
        # Who yields looks at the robot in every step, in the closed form only when he notices
        # it; they differ where the robot crosses his line meanwhile.
        if yields and act.startswith("pull aside"):
            continue
        found = touches_walker(
            act, yields, mine, np.array(ahead), np.array(line), np.array(speed), BODY, WALKING
        )
        assert bool(found) == (least < REACH), (act, person, mine, least)
        compared, touched = compared + 1, touched + int(found)
    assert compared > 110
    assert 20 < touched < compared - 20


def test_a_thing_that_stands_is_charged_only_until_it_is_thought_of_again() -> None:
    # Gap 0.3 m at 0.085 m/s: touched after 3.5 s; at half speed after 7.1 s.
    ahead, line = np.array(REACH + 0.3), np.array(0.0)

    def hit(act: str, until_s: float) -> bool:
        return bool(touches_standing(act, 0.0, ahead, line, until_s, BODY, WALKING))

    assert hit("continue", 4.0)
    assert not hit("continue", 3.4)
    assert not hit("slow", 4.0)
    assert not hit("stop", 100.0)
    assert not hit("back up", 100.0)


def test_least_separation_of_a_path_that_passes() -> None:
    # From (3, 1) to (-3, 1): passes at 1. Then on to (-3, 0.5), further away.
    ahead, across = np.array([3.0, -3.0, -3.0]), np.array([1.0, 1.0, 0.5])
    assert least_separation_m(ahead, across) == pytest.approx(1.0)
    still = least_separation_m(np.array([3.0, 3.0]), np.array([4.0, 4.0]))
    assert still == pytest.approx(5.0)


def test_dead_reckoning_across_the_corridor() -> None:
    assert BODY.across_m("pull aside left", 0.0, 1.0) == pytest.approx(0.3)
    assert BODY.across_m("pull aside right", 0.0, 9.0) == pytest.approx(-0.6)
    assert BODY.across_m("continue", -0.6, 1.0) == pytest.approx(-0.3)
    assert BODY.across_m("stop", -0.6, 1.0) == -0.6
