"""People and the robot in a corridor, by hand and against small steps."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simworld.people import (
    ACTS,
    Act,
    Body,
    EncounterError,
    Person,
    RobotInCorridor,
    Walker,
    advance,
    braking_s,
    collides,
    deadline_s,
    position,
    separation,
    time_to_collision_s,
    walked,
)

ROBOT = RobotInCorridor(0.0)
ROOM = 0.5


def test_time_to_collision_head_on_is_gap_over_closing_speed() -> None:
    # (8 - 0.5) / (1.3 + 0.085) = 5.415...
    person = Person(0.0, 8.0, 1.3)
    walker = Walker(8.0, 0.0, -1.3)
    assert time_to_collision_s(person, walker, ROBOT) == pytest.approx(7.5 / 1.385, abs=1e-12)


def test_time_to_collision_off_the_line_is_later() -> None:
    # Lateral 0.3 of 0.5: they touch at 0.4 m along.
    person = Person(0.0, 8.0, 1.3, 0.3)
    walker = Walker(8.0, 0.3, -1.3)
    assert time_to_collision_s(person, walker, ROBOT) == pytest.approx(7.6 / 1.385, abs=1e-12)


@pytest.mark.parametrize(
    "walker",
    [
        Walker(8.0, 0.51, -1.3),  # passes at the side
        Walker(8.0, -0.75, -1.3),
        Walker(8.0, 0.0, 0.5),  # walks away faster than the robot drives
        Walker(-2.0, 0.0, -1.3),  # has passed
    ],
)
def test_time_to_collision_is_infinite_where_paths_do_not_meet(walker: Walker) -> None:
    assert time_to_collision_s(Person(0.0, 8.0), walker, ROBOT) == math.inf


def test_time_to_collision_is_zero_for_those_who_touch() -> None:
    assert time_to_collision_s(Person(0.0, 0.45), Walker(0.45, 0.0, -1.0), ROBOT) == 0.0


@settings(max_examples=60, deadline=None)
@given(
    st.floats(1.0, 10.0),
    st.floats(-0.75, 0.75),
    st.floats(0.5, 2.0),
    st.floats(-0.3, 0.3),
    st.floats(-0.6, 0.6),
)
def test_time_to_collision_is_when_they_first_touch(
    ahead: float, offset: float, speed: float, drift: float, robot_y: float
) -> None:
    person = Person(0.0, ahead, speed, offset)
    walker = Walker(ahead, offset, -speed)
    robot = replace(ROBOT, y_m=robot_y, lateral_speed_m_s=drift)

    def apart(t: float) -> float:
        return math.hypot(ahead - (speed + robot.speed_m_s) * t, offset - robot_y - drift * t)

    due = time_to_collision_s(person, walker, robot)
    grid = [0.01 * k for k in range(2500)]
    if due == math.inf:
        assert min(map(apart, grid)) > ROOM - 1e-9
    else:
        assert due == 0.0 or apart(due) == pytest.approx(ROOM, abs=1e-9)
        assert all(apart(t) >= ROOM - 1e-9 for t in grid if t < due)


def test_what_each_act_does_in_one_second() -> None:
    aside = replace(ROBOT, y_m=0.2)
    after = {act: advance(aside, act, 1.0) for act in ACTS}
    # 0.3 m/s sideways for 1 s: from 0.2 back to the centre, to 0.5 left, to -0.1 right.
    moved = {act: (round(r.s_m, 9), round(r.y_m, 9)) for act, r in after.items()}
    assert moved == {
        "continue": (0.085, 0.0),
        "slow": (0.0425, 0.0),
        "stop": (0.0, 0.2),
        "pull aside left": (0.0, 0.5),
        "pull aside right": (0.0, -0.1),
        "pass left": (0.0425, 0.5),
        "pass right": (0.0425, -0.1),
        "back up": (-0.085, 0.2),
    }


@given(st.sampled_from(ACTS), st.floats(-0.6, 0.6), st.floats(0.01, 2.0), st.floats(0.01, 2.0))
def test_two_steps_are_one_long_step(act: Act, y_m: float, first: float, second: float) -> None:
    robot = replace(ROBOT, y_m=y_m)
    once = advance(robot, act, first + second)
    twice = advance(advance(robot, act, first), act, second)
    assert twice.s_m == pytest.approx(once.s_m, abs=1e-12)
    assert twice.y_m == pytest.approx(once.y_m, abs=1e-12)


def test_pulling_aside_takes_time_and_sets_the_deadline() -> None:
    # 0.65 m at 0.3 m/s.
    assert braking_s("pull aside left") == pytest.approx(2.1667, abs=1e-4)
    assert braking_s("pass right") == braking_s("pull aside left")
    assert braking_s("continue") == braking_s("stop") == 0.0
    person, walker = Person(0.0, 8.0, 1.3), Walker(8.0, 0.0, -1.3)
    due = deadline_s(person, walker, ROBOT, 10.0)
    assert due == pytest.approx(10.0 + 7.5 / 1.385 - 0.65 / 0.3)
    slower = deadline_s(person, walker, ROBOT, 10.0, Body(lateral_m_s=0.2))
    assert slower == pytest.approx(due - 0.65 / 0.2 + 0.65 / 0.3)


def touched(person: Person, act: Act, acts_at_s: float, dt_s: float = 0.01) -> bool:
    """Whether they ever touch if the robot drives on until a time and then does an act."""
    robot, walker = ROBOT, position(person, 0.0)
    for k in range(round(15.0 / dt_s)):
        t = k * dt_s
        if walker is not None and collides(person, walker, robot):
            return True
        following = walked(person, walker, robot, t, dt_s)
        robot = advance(robot, act if t >= acts_at_s - 1e-9 else "continue", dt_s)
        walker = following
    return False


@settings(max_examples=40, deadline=None)
@given(st.floats(5.0, 10.0), st.floats(0.8, 1.8), st.floats(-0.15, 0.49))
def test_pulling_aside_at_the_deadline_is_in_time(ahead: float, speed: float, off: float) -> None:
    person = Person(0.0, ahead, speed, off, yields=False)
    walker = position(person, 0.0)
    assert walker is not None
    due = deadline_s(person, walker, ROBOT, 0.0)
    assert not touched(person, "pull aside right", due - 0.02)


@pytest.mark.parametrize("speed", [0.8, 1.3, 1.8])
def test_pulling_aside_a_second_after_the_last_moment_is_too_late(speed: float) -> None:
    person = Person(0.0, 8.0, speed, 0.0, yields=False)
    # Room for 0.5 m takes 1.67 s at 0.3 m/s, and 1 s is missing.
    last = 7.5 / (speed + 0.085) - 0.5 / 0.3
    assert not touched(person, "pull aside left", last - 0.05)
    assert touched(person, "pull aside left", last + 1.0)


@settings(max_examples=60, deadline=None)
@given(st.floats(0.8, 1.8), st.floats(-0.75, 0.75), st.sampled_from(ACTS), st.floats(0.0, 1.0))
def test_who_yields_is_not_touched_by_what_is_decided_in_time(
    speed: float, offset: float, act: Act, share: float
) -> None:
    person = Person(0.0, 8.0, speed, offset)
    head_on = Walker(8.0, 0.0, -speed)
    due = deadline_s(person, head_on, ROBOT, 0.0)
    assert not touched(person, act, share * due)


@pytest.mark.parametrize(
    ("y_m", "lateral_m_s", "to_m"),
    [
        (0.0, 0.0, 0.1 + 0.045),  # a robot in the middle: to the side he is on
        (0.65, 0.0, 0.1 - 0.045),  # one that is aside
        (-0.65, 0.0, 0.1 + 0.045),
        (0.05, 0.3, 0.1 - 0.045),  # one that begins to pull aside
        (0.3, -0.3, 0.1 - 0.045),  # one that comes back to the middle
    ],
)
def test_who_yields_goes_where_the_robot_leaves_room(
    y_m: float, lateral_m_s: float, to_m: float
) -> None:
    person, walker = Person(0.0, 8.0, 1.0, 0.1), Walker(1.5, 0.1, -1.0)
    robot = RobotInCorridor(0.0, y_m, lateral_speed_m_s=lateral_m_s)
    after = walked(person, walker, robot, 6.5, 0.05)
    assert after is not None
    assert after.y_m == pytest.approx(to_m)


def test_aside_the_robot_is_clear_of_the_wall_and_of_the_middle() -> None:
    body = Body()
    assert 1.0 - body.aside_m - body.radius_m == pytest.approx(0.1)
    for act, offset in (("pull aside left", 0.149), ("pull aside right", -0.149)):
        assert not touched(Person(0.0, 8.0, 1.3, offset, yields=False), act, 1.0)  # type: ignore[arg-type]


def test_who_does_not_yield_walks_into_a_robot_that_stands() -> None:
    assert touched(Person(0.0, 8.0, 1.3, 0.3, yields=False), "stop", 0.0)
    assert not touched(Person(0.0, 8.0, 1.3, 0.6, yields=False), "stop", 0.0)


def test_the_robot_drives_into_a_thing_that_was_left() -> None:
    # Gap 1.2 - 0.5 = 0.7 m at 0.085 m/s: 8.2 s.
    box = Person(0.0, 1.2, 0.0)
    assert touched(box, "stop", 8.5)
    assert not touched(box, "stop", 8.0)


def test_a_person_from_a_door_crosses_to_a_line_first() -> None:
    # From the wall at y = 1.0 to y = 0.2 at 1.6 m/s: 0.5 s; then along.
    person = Person(2.0, 7.0, 1.6, 0.2, appears="left door", yields=False)
    assert position(person, 1.99) is None
    between, after = position(person, 2.25), position(person, 3.5)
    assert between is not None and after is not None
    assert between.y_m == pytest.approx(0.6)
    assert (between.s_m, between.speed_m_s, between.lateral_speed_m_s) == (7.0, 0.0, -1.6)
    assert after.s_m == pytest.approx(5.4)
    assert after.y_m == 0.2


def test_stepping_one_who_does_not_yield_is_the_closed_form() -> None:
    person = Person(0.1, 6.0, 1.3, -0.4, yields=False, appears="right door")
    walker = position(person, 0.0)
    for k in range(100):
        walker = walked(person, walker, ROBOT, k * 0.05, 0.05)
        assert walker == position(person, k * 0.05 + 0.05)


def test_who_has_passed_leaves() -> None:
    person = Person(0.0, 3.0, 1.0, 0.6, yields=False)
    walker = position(person, 0.0)
    here = [walker := walked(person, walker, ROBOT, 0.05 * k, 0.05) for k in range(200)]
    # From 3 m ahead to 2 m behind at 1 m/s: 5 s of 0.05 s steps.
    assert sum(w is not None for w in here) in (99, 100, 101)
    assert here[-1] is None


def test_separation_is_between_the_centres() -> None:
    assert separation(Walker(3.0, 4.0, -1.0), ROBOT) == 5.0


def test_what_cannot_be_is_refused() -> None:
    with pytest.raises(EncounterError, match="speed_m_s >= 0"):
        Person(0.0, 5.0, -1.0)
    with pytest.raises(EncounterError, match="must walk"):
        Person(0.0, 5.0, 0.0, appears="left door")
    with pytest.raises(EncounterError, match="lateral_m_s must be positive, got 0"):
        Body(lateral_m_s=0.0)
    with pytest.raises(EncounterError, match="no such act: 'jump'"):
        advance(ROBOT, "jump", 0.1)  # type: ignore[arg-type]
