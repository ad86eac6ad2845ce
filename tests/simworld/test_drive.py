"""A drive along an empty corridor: when it arrives, and that nobody's looking changes it."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simworld.drive import CorridorDrive
from simworld.people import Act, Body

LENGTHS = st.floats(0.1, 60.0)
STARTS = st.integers(0, 10**13)
BODY = Body(speed_m_s=0.085)


def drive(length_m: float, began_ns: int = 0) -> CorridorDrive:
    return CorridorDrive(began_ns, length_m, BODY)


@given(LENGTHS, STARTS)
def test_it_arrives_when_it_says_not_before(length_m: float, began_ns: int) -> None:
    going = drive(length_m, began_ns)
    arrives_ns = going.arrives_ns()
    assert arrives_ns == began_ns + math.ceil(length_m / 0.085 * 1e9)
    going.advance_to(arrives_ns)
    assert going.robot.s_m == pytest.approx(length_m, abs=1e-9)
    before = drive(length_m, began_ns)
    before.advance_to(arrives_ns - 1000)
    assert before.robot.s_m < length_m


@given(LENGTHS, st.lists(st.floats(0.0, 1.0), max_size=8))
def test_looking_on_the_way_changes_nothing(length_m: float, shares: list[float]) -> None:
    watched, alone = drive(length_m), drive(length_m)
    arrives_ns = alone.arrives_ns()
    assert arrives_ns is not None
    for share in sorted(shares):
        watched.advance_to(round(share * arrives_ns))
        assert abs((watched.arrives_ns() or 0) - arrives_ns) <= 2 + len(shares)
    watched.advance_to(arrives_ns)
    alone.advance_to(arrives_ns)
    assert watched.robot.s_m == pytest.approx(alone.robot.s_m, abs=1e-9)


def test_the_past_stays_as_it_is() -> None:
    going = drive(10.0)
    going.advance_to(5 * 10**9)
    at_m = going.robot.s_m
    going.advance_to(10**9)
    assert going.robot.s_m == at_m


@pytest.mark.parametrize("act", ["slow", "pass left", "pass right"])
def test_half_speed_takes_twice_the_time_that_is_left(act: Act) -> None:
    going = drive(8.5)  # 100 s
    going.act(act, 40 * 10**9)
    assert going.arrives_ns() == pytest.approx((40 + 120) * 10**9, abs=10)
    going.act("continue", 60 * 10**9)  # half of 20 s driven meanwhile
    assert going.arrives_ns() == pytest.approx((60 + 50) * 10**9, abs=10)


@pytest.mark.parametrize("act", ["stop", "pull aside left", "pull aside right", "back up"])
def test_who_does_not_drive_ahead_never_arrives(act: Act) -> None:
    going = drive(8.5)
    going.act(act, 40 * 10**9)
    assert going.arrives_ns() is None
    before_m = going.robot.s_m
    going.advance_to(50 * 10**9)
    assert going.robot.s_m <= before_m


def test_backing_up_ends_at_the_port() -> None:
    going = drive(8.5)
    going.act("back up", 10 * 10**9)
    going.advance_to(100 * 10**9)
    assert going.robot.s_m == 0.0


def test_nobody_to_react_to() -> None:
    going = drive(8.5)
    going.advance_to(10**9)
    going.leave()
    assert going.heard() == ()
    assert going.met == []
