"""The sensor compares each ping with the one before, unless the robot has turned in between."""

from __future__ import annotations

import math

import numpy as np

from bus.costs import CostModel
from bus.facts import Facts
from bus.messages import Odometry, Ranges, Sonar
from bus.turns import Turn
from modules.sensor.process import Sensor, build
from modules.sensor.settings import Settings

SECOND_NS = 10**9


def _turn() -> Turn:
    return Turn(0, CostModel("free"), ("world", 0))


def _ping(sensor: Sensor, at_s: int, range_m: float) -> Ranges:
    turn = _turn()
    sonar = Sonar(at_s, 0, at_s * SECOND_NS, np.full(24, range_m))
    sensor.handlers["percept/sonar"](sonar, turn)
    said = turn.said[0][0]
    assert isinstance(said, Ranges)
    return said


def _echo_after(turned_rad: float) -> float:
    """How real an echo looks that came again after such a turn of the wheels."""
    sensor = build(Facts(3, 3, 0, 1, 0.085), Settings(), 1)
    _ping(sensor, 1, 1.0)
    sensor.handlers["percept/odometry"](Odometry(0.0, turned_rad, 2.0), _turn())
    return float(_ping(sensor, 3, 1.0).echo[0])


def test_an_echo_that_comes_again_is_surer_though_the_wheels_miscount_a_little() -> None:
    assert _echo_after(math.radians(0.5)) > 0.998
    assert _echo_after(math.radians(0.5)) == _echo_after(0.0)


def test_after_a_turn_nothing_is_expected() -> None:
    assert _echo_after(math.radians(90)) < _echo_after(0.0)
