"""A doorway beside the junction tells the port, among lost echoes and wrong expectations."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from bus.grid import EAST, WEST, Grid
from scenarios.trial_junction import junction
from simworld.abeam import HUGS_M, KEEPS_OFF_M, interruptions_m, look_abeam
from simworld.body import Body
from simworld.fittings import Doorway, fitted
from simworld.motion import Pose
from simworld.ports import ears_of
from simworld.sonar import SonarRing, echoes

NAN = math.nan
WALL = [0.9] * 6
DRIVEN_M = 18.0
SPEED_M_S = 0.085


@pytest.mark.parametrize(
    ("side_m", "found"),
    [
        ([*WALL, 2.0, 2.0, 2.0, *WALL], [7.0]),
        ([*WALL, 2.0, NAN, 2.0, 0.5, 2.0, 2.0, *WALL], [8.5]),  # one echo was another's
        ([*WALL, NAN, *WALL, NAN, NAN, *WALL], []),  # lost echoes
        ([2.0, 2.0, 2.0, *WALL], []),  # where it began nobody knows
        ([*WALL, 2.0, 2.0, 2.0], []),  # nor where it ends
        ([*WALL, 1.2, 1.2, 1.2, 1.2, *WALL], []),  # a closed door stands back
        ([*WALL, 3.0, 3.0, 3.0, *WALL, 3.0, 3.0, 3.0, 3.0, *WALL], [7.0, 16.5]),
    ],
)
def test_a_wall_is_interrupted_where_it_begins_again(
    side_m: list[float], found: list[float]
) -> None:
    way_m = [float(k) for k in range(len(side_m))]
    assert interruptions_m(way_m, side_m, to_wall_m=0.9) == found


@dataclass(frozen=True)
class Found:
    """Where the robot stands, from the port, how long it took, whether the walls were smooth."""

    error_m: float
    took_s: float
    smooth: bool


def found_doorway(
    seed: int,
    off_m: float,
    *,
    near: bool | None = None,
    door_m: float = 0.7,
    width_m: float | None = None,
    left: bool = True,
    stubs: bool = False,
    driven_m: float = 9.0,
) -> Found:
    """A robot comes from the west to a doorway on the left that leads into a room.

    The wheels expect its port ``off_m`` too far ahead; ``near`` says whether it drives near the
    walls, by itself where None; ``stubs`` are closed doors in both walls before the port.
    """
    rng = np.random.default_rng([7, seed])
    width_m = width_m or float(rng.uniform(1.8, 2.2))
    corridor, at_m = Grid(3, 3).corridor(0, 1, EAST), 10.0
    doors = [Doorway(corridor, at_m, "left", width_m=door_m, depth_m=3.0)]
    if stubs:
        doors += [Doorway(corridor, at_m - 2.4, "left"), Doorway(corridor, at_m - 2.0, "right")]
    body = Body(SonarRing(), fitted(junction(EAST | WEST, width_m), doors), SPEED_M_S, rng)
    port = Pose(at_m - 20.0 - 1.0, 0.0, 0.0)
    stop = body.approach(port.after(off_m), driven_m, 2.0, left=left)
    body.arrive(stop if near is None else replace(stop, smooth=not near))
    took_ns = body.find_doorway()
    return Found(body.pose.ahead_of_m(port), took_ns / 1e9, stop.smooth)


@pytest.mark.parametrize("off_m", [-0.1, 0.0, 0.1])
def test_it_stands_half_a_width_before_the_doorway(off_m: float) -> None:
    found = [found_doorway(seed, off_m) for seed in range(10)]
    errors_m = np.array([f.error_m for f in found])
    # From a tenth of a metre further off the cones of the detectors do not pass the doorway.
    assert np.abs(errors_m).max() < 0.15
    assert abs(float(errors_m.mean())) < 0.05
    assert all(f.took_s > 2.0 / SPEED_M_S for f in found), "it drove through the junction"


def test_where_walls_are_smooth_it_stays_in_the_middle() -> None:
    assert all(found_doorway(seed, 0.0).smooth for seed in range(10))
    assert not any(found_doorway(seed, 0.0, stubs=True).smooth for seed in range(10))


def test_a_doorway_that_a_cone_from_the_middle_does_not_pass_is_heard_from_near() -> None:
    # of 0.6 m, 1.15 m away: the cone of 15 degrees to either side is as wide
    far, near = (
        np.array(
            [found_doorway(k, 0.25, near=near, door_m=0.6, width_m=2.3).error_m for k in range(10)]
        )
        for near in (False, True)
    )
    assert np.abs(near).max() < 0.15
    assert np.mean(np.abs(far) > 0.15) >= 0.5, "where its wheels say"


def test_from_near_it_hears_what_began_behind_it_too() -> None:
    # the wheels, after 20 m, expect the port too far on, where the door has begun
    far, near = (
        np.array(
            [
                found_doorway(k, 0.45, near=near, door_m=1.2, driven_m=20.0).error_m
                for k in range(10)
            ]
        )
        for near in (False, True)
    )
    assert np.mean(np.abs(near) < 0.15) >= 0.5
    assert np.mean(np.abs(far) < 0.15) <= 0.2


def test_a_doorway_where_the_grid_has_no_room_for_a_corridor_is_none() -> None:
    found = [found_doorway(seed, 0.3, left=False) for seed in range(5)]
    assert all(f.error_m > 0.15 for f in found), "it stays where its wheels say"


def test_by_the_wheels_alone_it_stands_where_they_say() -> None:
    for near in (False, True):
        rng = np.random.default_rng(1)
        body = Body(SonarRing(), junction(EAST | WEST, 2.0), SPEED_M_S, rng)
        body.arrive(replace(body.approach(Pose(-1.0, 0.0, 0.0), DRIVEN_M, 2.0), smooth=not near))
        before = body.pose
        assert body.find_doorway() > 0
        assert math.hypot(body.pose.x_m - before.x_m, body.pose.y_m - before.y_m) < 0.15
        assert body.find_doorway() == 0, "once is enough"


def test_where_the_wall_ends_it_does_not_look_for_a_doorway() -> None:
    looked = 0
    for seed in range(10):
        body = Body(SonarRing(), junction(0b1101, 2.0), SPEED_M_S, np.random.default_rng(seed))
        stop = body.approach(Pose(-1.0, 0.0, 0.0), DRIVEN_M, 2.0)
        body.arrive(stop)
        took_ns = body.find_doorway()
        assert (took_ns == 0) == stop.sure
        looked += took_ns > 0
    assert looked <= 4, "the wheels expect a third of the ports further off than they think"


@pytest.mark.parametrize("smooth", [True, False])
def test_it_does_not_drive_into_the_wall_ahead(smooth: bool) -> None:
    ring, rng = SonarRing(), np.random.default_rng(2)
    building = junction(WEST, 2.0)
    body = Body(ring, building, SPEED_M_S, rng)
    stop = body.approach(Pose(-1.0, 0.0, 0.0), DRIVEN_M, 2.0)
    went: list[Pose] = []

    def listen(pose: Pose) -> NDArray[np.float64]:
        went.append(pose)
        return echoes(ring, building, pose.x_m, pose.y_m, pose.heading_rad, rng)

    def move(pose: Pose, forward_m: float, turn_rad: float) -> Pose:
        return pose.after(forward_m, turn_rad)

    look_abeam(replace(stop, smooth=smooth), ears_of(ring), listen, move)
    # The far side is at x = 1, the robot began at about -1.
    assert 0.0 < max(pose.x_m for pose in went) < 1.1 - KEEPS_OFF_M
    aside_m = max(abs(pose.y_m) for pose in went)
    assert aside_m < 0.15 if smooth else 0.3 < aside_m < 1.0 - HUGS_M + 0.15
