"""Where in its corridor the robot is, by a line through the echoes of its walls."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from simworld.following import (
    FAR,
    Glimpse,
    InCorridor,
    located,
    offset_m,
    steering_rad,
    stray_share,
)

HALF_M = 1.0


def straight_on(left_m: float, askew_rad: float, half_m: float = HALF_M) -> list[Glimpse]:
    """Glimpses of a robot that drives 1.2 m without turning, and counts it."""
    glimpses = []
    for forward_m in np.arange(0.0, 1.2, 0.03):
        y_m = left_m + forward_m * math.tan(askew_rad)
        glimpses.append(Glimpse(float(forward_m), 0.0, 0.0, half_m - y_m, half_m + y_m))
    return glimpses


@pytest.mark.parametrize("left_m", [-0.2, 0.0, 0.15])
@pytest.mark.parametrize("askew_deg", [-4.0, 0.0, 3.0])
def test_offset_and_heading_are_those_of_the_drive(left_m: float, askew_deg: float) -> None:
    glimpses = straight_on(left_m, math.radians(askew_deg), half_m=0.9)
    place = located(glimpses, HALF_M)
    ends_m = left_m + glimpses[-1].forward_m * math.tan(math.radians(askew_deg))
    # The assumption about the slope holds it towards 0 by a few hundredths.
    assert place.left_m == pytest.approx(ends_m, abs=0.01)
    assert math.degrees(place.askew_rad) == pytest.approx(askew_deg, rel=0.1, abs=1e-9)


def test_a_stray_echo_turns_nobody() -> None:
    glimpses = straight_on(0.0, 0.0)
    glimpses[5] = replace(glimpses[5], to_left_m=0.4)
    place = located(glimpses, HALF_M)
    assert (place.left_m, place.askew_rad) == pytest.approx((0.0, 0.0), abs=0.001)


def test_one_wall_is_enough() -> None:
    assert offset_m(Glimpse(0.0, 0.0, 0.0, 0.8, math.nan), HALF_M) == pytest.approx(0.2)
    assert offset_m(Glimpse(0.0, 0.0, 0.0, FAR * HALF_M + 0.1, 0.9), HALF_M) == pytest.approx(-0.1)
    assert math.isnan(offset_m(Glimpse(0.0, 0.0, 0.0, math.nan, math.nan), HALF_M))


def test_it_steers_back_to_the_middle() -> None:
    assert steering_rad(InCorridor(0.1, 0.0)) < 0.0 < steering_rad(InCorridor(-0.1, 0.0))
    assert steering_rad(InCorridor(0.0, 0.0)) == 0.0
    assert abs(steering_rad(InCorridor(5.0, 0.0))) < math.radians(5.0)


def test_what_is_not_of_one_straight_wall_on_each_side_is_stray() -> None:
    glimpses = straight_on(0.1, math.radians(3.0))
    assert stray_share(glimpses) == 0.0
    glimpses[3] = replace(glimpses[3], to_right_m=math.nan)
    glimpses[7:11] = [replace(g, to_left_m=g.to_left_m + 0.15) for g in glimpses[7:11]]
    assert stray_share(glimpses) == pytest.approx(5 / (2 * len(glimpses)))
    deaf = [replace(g, to_left_m=math.nan) for g in straight_on(0.0, 0.0)]
    assert stray_share(deaf) == 0.5


def test_a_robot_that_turned_on_its_way_hears_smooth_walls_all_the_same() -> None:
    swerved = [
        Glimpse(x_m, y_m, 0.0, HALF_M - y_m, HALF_M + y_m)
        for x_m, y_m in ((0.03 * k, 0.1 * math.sin(0.1 * k)) for k in range(40))
    ]
    assert stray_share(swerved) == 0.0
