"""Where the page says the robot was, against drives whose positions are known."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus import messages as m
from logs.page.trail import NEAR_M, Knot, Trail
from tests.logs.conftest import BUILDING, S, Speaker

EAST_RAD, NORTH_RAD = 0.0, math.pi / 2


def _trail(speaker: Speaker) -> Trail:
    trail = Trail()
    for sent in speaker.said:
        trail.hear(sent)
    return trail


def _at(trail: Trail, at_s: float) -> tuple[float, float]:
    times = [knot.at_ns / S for knot in trail.knots]
    x = np.interp(at_s, times, [knot.x_m for knot in trail.knots])
    y = np.interp(at_s, times, [knot.y_m for knot in trail.knots])
    return float(x), float(y)


def _drive(speaker: Speaker, at_s: int, steps_m: list[float]) -> None:
    """Odometry every second, first one second after ``at_s``."""
    for number, step_m in enumerate(steps_m, start=1):
        speaker.say(at_s + number, m.Odometry(step_m, 0.0, 1.0))


def _over_the_corner() -> Speaker:
    """10 m north up to the port of (0, 1), then over its centre, east, in 20 s."""
    speaker = Speaker()
    speaker.say(0, BUILDING)
    speaker.say(0, m.Departure(0, 1))
    _drive(speaker, 0, [1.0] * 10)
    speaker.say(10, m.TruePose(0.0, 29.0, NORTH_RAD, 2))
    speaker.say(12, m.Departure(1, 2))
    _drive(speaker, 12, [1.0] * 10)
    speaker.say(32, m.TruePose(9.0, 30.0, EAST_RAD, 3))
    return speaker


def test_the_first_drive_begins_as_far_away_as_the_wheels_counted() -> None:
    trail = _trail(_over_the_corner())
    assert _at(trail, 0) == pytest.approx((0, 19))
    assert _at(trail, 4) == pytest.approx((0, 23))


def test_a_drive_leads_over_the_centre_of_the_junction() -> None:
    trail = _trail(_over_the_corner())
    assert _at(trail, 12) == pytest.approx((0, 29))  # stood from 10 s on
    assert _at(trail, 13) == pytest.approx((0, 30), abs=NEAR_M)
    assert _at(trail, 17) == pytest.approx((4, 30), abs=NEAR_M)
    assert _at(trail, 22) == _at(trail, 30) == pytest.approx((9, 30), abs=NEAR_M)
    assert {round(k.heading_rad, 2) for k in trail.knots if k.at_ns > 14 * S} == {0.0}


def test_standing_for_somebody_is_seen() -> None:
    speaker = Speaker()
    speaker.say(0, BUILDING)
    speaker.say(0, m.Departure(0, 2))
    _drive(speaker, 0, [1.0] * 5 + [0.0] * 10 + [1.0] * 5)
    speaker.say(20, m.TruePose(10.0, 0.0, EAST_RAD, 1))
    trail = _trail(speaker)
    assert _at(trail, 5)[0] == _at(trail, 14.9)[0] == pytest.approx(5, abs=NEAR_M)
    assert len(trail.knots) < 8  # a straight way needs no knot a second


def test_while_sensing_the_robot_is_where_its_steps_lead() -> None:
    speaker = Speaker()
    speaker.say(0, m.TruePose(2.0, 0.0, EAST_RAD, 0))
    steps = np.array(
        [[m.DRIVE, 1.0], [m.TURN, NORTH_RAD], [m.PING, 1], [m.DRIVE, 3.0], [m.PING, 1]]
    )
    speaker.say(10, m.Motion(1, 0, 4, 7, steps))
    for at_s in (20, 30):
        speaker.say(at_s, m.Sonar(1, 4, at_s * S, np.full(4, 1.0)))
    speaker.say(40, m.ActionEnded(4))
    first, second = _trail(speaker).knots[2:4]
    assert (first.at_ns, first.x_m, first.y_m) == (20 * S, 3.0, 0.0)
    assert first.heading_rad == pytest.approx(NORTH_RAD)
    assert (second.x_m, second.y_m) == pytest.approx((3.0, 3.0))


@given(st.lists(st.floats(-0.01, 2.0), min_size=1, max_size=40), st.integers(0, 3))
def test_knots_never_go_back_in_time_and_end_where_the_robot_was(
    steps_m: list[float], place: int
) -> None:
    speaker = Speaker()
    speaker.say(0, BUILDING)
    for number in range(3):
        at_s = number * 50
        speaker.say(at_s, m.Departure(number, 1))
        _drive(speaker, at_s, steps_m)
        speaker.say(at_s + 45, m.TruePose(5.0 * number, 1.0, EAST_RAD, place))
    knots = _trail(speaker).knots
    assert all(a.at_ns <= b.at_ns for a, b in pairwise(knots))
    assert knots[-1] == Knot(145 * S, 10.0, 1.0, EAST_RAD)
    assert all(math.isfinite(k.x_m) and math.isfinite(k.y_m) for k in knots)
