"""A door leaf that swings into the corridor: by hand, and what echoes of it."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simworld.door import EDGE_M, Door, apart_m, echoing, meets_in_s, touches
from simworld.drive import CorridorDrive
from simworld.people import Body, EncounterError, RobotInCorridor

DOOR = Door(begins_s=10.0, at_m=5.0, leaf_m=0.8, opens_s=2.0, stays_s=6.0)
ROBOT = RobotInCorridor(4.0)


def test_it_swings_out_stays_and_swings_back() -> None:
    quarter = math.pi / 2
    found = [DOOR.angle_rad(t) for t in (9.0, 10.0, 11.0, 12.0, 18.0, 19.0, 20.0, 30.0)]
    assert found == pytest.approx([0, 0, quarter / 2, quarter, quarter, quarter / 2, 0, 0])
    assert DOOR.ends(10.0) == pytest.approx((5.0, 1.0, 4.2, 1.0))
    assert DOOR.ends(15.0) == pytest.approx((5.0, 1.0, 5.0, 0.2))
    right = Door(10.0, 5.0, "right", opens_s=2.0)
    assert right.ends(15.0) == pytest.approx((5.0, -1.0, 5.0, -0.2))


@given(st.floats(0.0, 40.0), st.floats(3.0, 7.0), st.floats(-0.6, 0.6))
def test_the_leaf_is_as_far_as_its_nearest_point(time_s: float, s_m: float, y_m: float) -> None:
    s0, y0, s1, y1 = DOOR.ends(time_s)
    points = [(s0 + k / 2000 * (s1 - s0), y0 + k / 2000 * (y1 - y0)) for k in range(2001)]
    nearest = min(math.hypot(s - s_m, y - y_m) for s, y in points)
    assert apart_m(DOOR, RobotInCorridor(s_m, y_m), time_s) == pytest.approx(nearest, abs=1e-3)


def test_closed_it_is_not_heard_and_open_it_is_a_mirror_with_an_edge() -> None:
    assert echoing(DOOR, ROBOT, 9.0) == ()
    ((s_m, y_m, radius_m),) = echoing(DOOR, ROBOT, 15.0)  # its edge; the foot is beyond it
    assert (s_m, y_m, radius_m) == pytest.approx((5.0, 0.2, EDGE_M))
    edge, foot = echoing(DOOR, RobotInCorridor(4.0, 0.5), 15.0)
    assert edge == pytest.approx((5.0, 0.2, EDGE_M))
    assert foot == pytest.approx((5.0, 0.5, EDGE_M))


def test_a_robot_that_drives_on_touches_the_leaf_when_it_says() -> None:
    # The edge is 0.2 m beside its way, its reach 0.28: 0.196 m before the leaf.
    due_s = meets_in_s(DOOR, ROBOT)
    assert due_s == pytest.approx((1.0 - math.sqrt(0.28**2 - 0.2**2)) / 0.085)
    before, after = (RobotInCorridor(4.0 + 0.085 * (due_s + d)) for d in (-0.05, 0.05))
    assert not touches(DOOR, before, 15.0) and touches(DOOR, after, 15.0)
    assert meets_in_s(DOOR, RobotInCorridor(4.0, -0.1)) == math.inf
    assert meets_in_s(DOOR, RobotInCorridor(4.0, speed_m_s=0.0)) == math.inf


@pytest.mark.parametrize(("stays_s", "touched"), [(1.0, False), (30.0, True)])
def test_a_drive_meets_it_and_goes_on_when_it_has_closed(stays_s: float, touched: bool) -> None:
    drive = CorridorDrive(0, 10.0, Body())
    drive.enter(1, Door(0.0, 1.0, stays_s=stays_s))
    assert drive.heard() == ()
    drive.advance_to(2 * 10**9)
    assert len(drive.heard()) >= 1
    (meeting,) = drive.meetings
    due_ns = drive.react_by_ns(meeting)
    assert due_ns is not None and 9.0 < due_ns / 1e9 < 10.0
    drive.advance_to(60 * 10**9)
    (met,) = drive.met
    assert (met.number, met.collided) == (1, touched)
    assert drive.meetings == []


def test_a_door_that_cannot_be_is_refused() -> None:
    with pytest.raises(EncounterError, match="leaf_m > 0"):
        Door(0.0, 1.0, leaf_m=0.0)
