"""The reflexes that keep the robot in the middle of a real corridor and off its walls."""

from __future__ import annotations

import math

import numpy as np
import pytest

from simworld.building import build
from simworld.floor_plan import Cells, FloorPlan
from simworld.keeping import BUMPER_M, in_the_middle, room_beside
from simworld.motion import Pose

RESOLUTION_M = 0.05
CORRIDOR = build([0.0, 20.0], [0.0], np.ones(1, np.uint8), 2.0)


def plan_of(low_m: float, high_m: float, box: bool = False) -> FloorPlan:
    """A corridor along y = 0 from x = 0 to 20, free from ``low_m`` to ``high_m``."""
    y = (np.arange(80) + 0.5) * RESOLUTION_M - 2.0
    x = (np.arange(400) + 0.5) * RESOLUTION_M
    free = ((y > low_m) & (y < high_m))[:, None] & np.ones(400, bool)
    if box:
        free &= ~((np.abs(y) < 0.15)[:, None] & (np.abs(x - 10.0) < 0.15))
    return FloorPlan(Cells(~free, free, RESOLUTION_M), (0.0, -2.0), 0.0)


@pytest.mark.parametrize("off_m", [-0.45, 0.0, 0.3])
@pytest.mark.parametrize("heading_rad", [0.0, math.pi])
def test_the_middle_is_where_the_walls_leave_it(off_m: float, heading_rad: float) -> None:
    plan = plan_of(off_m - 0.9, off_m + 0.9)
    found = in_the_middle(plan, Pose(10.0, 0.0, heading_rad))
    assert found.y_m == pytest.approx(off_m, abs=0.06)
    assert found.x_m == pytest.approx(10.0)
    assert found.heading_rad == heading_rad


def test_a_box_in_the_way_is_not_what_the_reflex_avoids() -> None:
    assert abs(in_the_middle(plan_of(-0.9, 0.9, box=True), Pose(10.0, 0.0, 0.0)).y_m) < 0.15


def test_aside_there_is_room_up_to_the_bumper() -> None:
    middle = Pose(10.0, 0.0, 0.0)
    for low_m, high_m in ((-0.7, 0.7), (-0.9, 0.55)):
        left_m, right_m, clear = room_beside(plan_of(low_m, high_m), middle)
        assert clear
        assert left_m == pytest.approx(high_m - BUMPER_M, abs=RESOLUTION_M + 1e-9)
        assert right_m == pytest.approx(-low_m - BUMPER_M, abs=RESOLUTION_M + 1e-9)


def test_beside_a_box_there_is_room_behind_its_sides() -> None:
    left_m, right_m, clear = room_beside(plan_of(-0.9, 0.9, box=True), Pose(10.0, 0.0, 0.0))
    assert not clear
    assert left_m == right_m == pytest.approx(0.9 - BUMPER_M, abs=RESOLUTION_M + 1e-9)
    assert room_beside(plan_of(-0.2, 0.2), Pose(10.0, 0.0, 0.0)) == (0.0, 0.0, False)


def test_a_building_of_straight_corridors_is_left_as_it_is() -> None:
    pose = Pose(10.0, 0.0, 0.0)
    assert in_the_middle(CORRIDOR, pose) is pose
    assert room_beside(CORRIDOR, pose) == pytest.approx((0.7, 0.7, True))
