"""The body counts its wheels both ways, and steps miss what was commanded by a little."""

from __future__ import annotations

import math

import numpy as np
import pytest

from simworld.body import Body
from simworld.building import build
from simworld.motion import Drive, Ping, Pose, Turn
from simworld.sonar import SonarRing


def _body() -> Body:
    building = build((0.0, 20.0), (0.0,), np.ones(1, np.uint8), 2.0)
    return Body(SonarRing(), building, 0.085, np.random.default_rng(3))


def test_what_is_driven_back_is_counted_back() -> None:
    body = _body()
    body.step(Drive(1.0))
    body.place(body.pose, -0.4, 0.0)  # backing up from somebody
    body.step(Drive(-0.6))
    distance_m, turn_rad = body.odometry()
    assert distance_m == pytest.approx(0.0, abs=1e-9)
    assert abs(turn_rad) < math.radians(2.0)
    assert body.odometry()[0] == pytest.approx(0.0, abs=1e-9), "a report starts a new count"


def test_steps_end_near_where_they_were_commanded_to() -> None:
    body = _body()
    body.place(Pose(5.0, 0.0, 0.0), 0.0, 0.0)
    body.step(Drive(1.0))
    body.step(Turn(math.pi / 2))
    assert (body.pose.x_m, body.pose.y_m) == pytest.approx((6.0, 0.0), abs=0.05)
    assert body.pose.heading_rad == pytest.approx(math.pi / 2, abs=0.1)
    assert (body.pose.x_m, body.pose.heading_rad) != (6.0, math.pi / 2), "nothing is exact"


def test_steps_take_what_they_take() -> None:
    body = _body()
    assert body.takes_ns(Ping(2)) == 2 * 24 * 40_000_000
    assert body.takes_ns(Drive(0.85)) == pytest.approx(10e9, abs=2)
    assert body.takes_ns(Turn(-math.pi / 2)) == pytest.approx(6e9, abs=2)
