"""Room and open ways as the ring measures them in a corridor with a thing in it."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from bus.facts import Ring
from modules.reactor.meeting import ACTS, Body
from modules.reactor.openness import open_acts, sectors_of, walls_m
from modules.reactor.room import Room, rooms_of
from modules.reactor.sides import PINGS, beside
from simworld.building import Building, build
from simworld.sonar import SonarRing, true_ranges_m

RING, BODY = SonarRing(), Body()
SECTORS = sectors_of(Ring())


@cache
def corridor(width_m: float) -> Building:
    return build([0.0, 30.0], [0.0], np.ones(1, np.uint8), width_m)


def heard(
    width_m: float, lateral_m: float, things: tuple[tuple[float, float, float], ...] = ()
) -> np.ndarray:
    """What a robot in the middle of a long corridor hears, without noise."""
    placed = [(15.0 + s, y, r) for s, y, r in things]
    found = true_ranges_m(RING, corridor(width_m), 15.0, lateral_m, 0.0, placed)
    return SECTORS.free_m(np.where(np.isfinite(found), found, np.nan))


@pytest.mark.parametrize("width_m", [1.2, 1.6, 2.0])
@pytest.mark.parametrize("lateral_m", [-0.2, 0.0, 0.25])
def test_walls_are_measured_as_far_as_they_are(width_m: float, lateral_m: float) -> None:
    found = walls_m(heard(width_m, lateral_m), SECTORS)
    assert found == pytest.approx((width_m / 2 - lateral_m, width_m / 2 + lateral_m), abs=0.01)


def test_room_is_what_walls_leave_and_never_more_than_the_usual_distance() -> None:
    pings = [heard(1.6, 0.1)] * PINGS
    room = beside(pings, SECTORS, 0.1, BODY).room
    assert room == pytest.approx((0.53, 0.53), abs=0.01)  # 0.8 - 0.3 + 0.03
    assert beside([heard(2.0, 0.0)], SECTORS, 0.0, BODY).room == (0.65, 0.65)
    assert room.for_act("pass left") == room.left_m
    assert Room(0.1, 0.5).for_act("pull aside right") == 0.5


def test_the_class_of_room_is_the_nearest() -> None:
    rooms = dict(zip(ACTS, rooms_of(Room(0.18, 0.6)).tolist(), strict=True))
    assert (rooms["pass left"], rooms["pull aside right"], rooms["continue"]) == (1, 4, 0)


def open_ways(*things: tuple[float, float, float], lateral_m: float = 0.0) -> set[str]:
    """The acts that lead into the open."""
    goals = np.array([BODY.goes_to_m(act, lateral_m) for act in ACTS])
    found = open_acts(heard(2.0, lateral_m, things), SECTORS, goals, lateral_m, BODY)
    return {act for act, free in zip(ACTS, found, strict=True) if free}


def test_a_thing_closes_the_ways_that_lead_into_it() -> None:
    assert open_ways() == set(ACTS)
    in_the_middle = open_ways((0.8, 0.0, 0.25))
    assert "continue" not in in_the_middle
    assert {"pass left", "pass right"} <= in_the_middle
    on_the_left = open_ways((0.8, 0.4, 0.25))
    assert "pass left" not in on_the_left and "pass right" in on_the_left


def test_a_frame_beside_the_way_closes_nothing_and_abreast_the_way_back_is_closed() -> None:
    assert "continue" in open_ways((0.8, 0.95, 0.1))
    beside_it = open_ways((0.1, 0.0, 0.2), lateral_m=-0.65)
    assert "continue" not in beside_it and "pass right" in beside_it


@pytest.mark.parametrize("ahead_m", [-0.25, -0.1, 0.0, 0.2])
@pytest.mark.parametrize("left_m", [-0.15, 0.0, 0.12, 0.15])
def test_the_way_back_is_closed_while_a_box_is_beside_the_robot(
    ahead_m: float, left_m: float
) -> None:
    for side in (1.0, -1.0):
        box = (ahead_m, side * left_m, 0.243)
        pings = [heard(2.0, side * 0.65, (box,))] * PINGS
        assert beside(pings, SECTORS, side * 0.65, BODY).abreast
        assert not beside([heard(2.0, side * 0.65)] * PINGS, SECTORS, side * 0.65, BODY).abreast


def test_one_missed_echo_opens_no_way_and_one_crossed_reading_closes_none() -> None:
    blocked, free = heard(2.0, 0.0, ((0.8, 0.0, 0.25),)), heard(2.0, 0.0)
    act = ACTS.index("continue")
    missed = np.full_like(blocked, np.inf)
    assert beside([blocked, missed, blocked], SECTORS, 0.0, BODY).open[act] == 0.0
    crossed = np.full(24, np.nan)
    crossed[0] = 0.4
    assert (
        beside([free, np.minimum(free, SECTORS.free_m(crossed)), free], SECTORS, 0.0, BODY).open[
            act
        ]
        == 1.0
    )
