"""Several at once on a drive, walls that nobody walks through, crossed readings."""

from __future__ import annotations

import math

import numpy as np
import pytest

from simworld.drive import CorridorDrive
from simworld.keeping import Beside
from simworld.people import Body, Person
from simworld.settings import FalseEchoSettings
from simworld.sonar import SonarRing
from simworld.travel import crossed_share

SECOND = 10**9


def narrow(_at_m: float) -> Beside:
    """A corridor with 0.3 m of room to the left and 0.1 m to the right."""
    return Beside(0.3, 0.1)


def test_two_at_once_are_met_each_by_itself() -> None:
    drive = CorridorDrive(0, 30.0, Body())
    drive.enter(1, Person(0.0, 8.0, 1.0, 0.6, yields=False))
    drive.enter(2, Person(0.0, 6.0, 1.0, -0.3, yields=False))
    assert [round(s) for s, _, _ in drive.heard()] == [8, 6]
    drive.advance_to(20 * SECOND)
    assert [(met.number, met.collided) for met in drive.met] == [(2, True), (1, False)]
    assert drive.met[0].closest_m < 0.5 < drive.met[1].closest_m


def test_walls_keep_the_robot_and_who_walks() -> None:
    drive = CorridorDrive(0, 30.0, Body(), narrow)
    drive.enter(1, Person(0.0, 8.0, 1.0, 0.7, yields=False))
    drive.enter(2, Person(0.0, 8.0, 1.0, -0.7, yields=False, radius_m=0.35))
    drive.act("pull aside left", 0)
    drive.advance_to(4 * SECOND)
    # A person walks 5 cm nearer to the wall than the robot goes, a broad one less.
    assert [y for _, y, _ in drive.heard()] == pytest.approx([0.35, -0.05])
    assert drive.robot.y_m == pytest.approx(0.3)
    drive.act("pull aside right", 4 * SECOND)
    drive.advance_to(8 * SECOND)
    assert drive.robot.y_m == pytest.approx(-0.1)


def test_it_goes_as_far_aside_as_it_was_told() -> None:
    drive = CorridorDrive(0, 30.0, Body())
    drive.act("pull aside left", 0, 0.4)
    drive.advance_to(5 * SECOND)
    assert drive.robot.y_m == pytest.approx(0.4)


@pytest.mark.parametrize(
    ("room", "passes"),
    [
        (Beside(0.3, 0.3), True),
        (Beside(0.6, 0.0), True),
        (Beside(0.2, 0.2), False),
        (Beside(0.9, 0.9, clear=False), False),
    ],
)
def test_where_two_can_pass_each_other(room: Beside, passes: bool) -> None:
    def worse_at_five(at_m: float) -> Beside:
        return room if 4.9 < at_m < 5.2 else Beside(0.6, 0.6)

    drive = CorridorDrive(0, 30.0, Body(), worse_at_five)
    assert drive.two_can_pass(6.0) is passes
    assert drive.two_can_pass(4.0)


def test_a_thing_beside_the_way_asks_for_no_decision_and_a_person_does() -> None:
    drive = CorridorDrive(0, 30.0, Body())
    for number, speed_m_s, offset_m in ((1, 0.0, 0.7), (2, 0.0, 0.2), (3, 1.0, 0.7)):
        drive.enter(number, Person(0.0, 5.0, speed_m_s, offset_m))
    asks = [drive.react_by_ns(meeting) is not None for meeting in drive.meetings]
    assert asks == [False, True, True]


def test_crossed_readings_are_of_some_transducers_for_a_while() -> None:
    ring = SonarRing()
    echo = FalseEchoSettings(at_s=10.0, lasts_s=2.0, transducers=(0, 23), share=0.7)
    assert crossed_share(ring, (echo,), 9 * SECOND) is None
    assert crossed_share(ring, (echo,), 12 * SECOND) is None
    during = crossed_share(ring, (echo,), 11 * SECOND)
    assert during is not None
    assert during[[0, 23]].tolist() == [0.7, 0.7]
    assert (np.delete(during, [0, 23]) == ring.cross_talk).all()
    assert math.isclose(ring.cross_talk, 0.01)
