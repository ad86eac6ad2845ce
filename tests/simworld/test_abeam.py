"""A doorway beside the junction tells the port, among lost echoes and wrong expectations."""

from __future__ import annotations

import math

import numpy as np
import pytest

from bus.grid import EAST, WEST, Grid
from scenarios.trial_junction import junction
from simworld.abeam import KEEPS_OFF_M, interruptions_m
from simworld.body import Body
from simworld.fittings import Doorway, fitted
from simworld.motion import Pose
from simworld.sonar import SonarRing

NAN = math.nan
WALL = [0.9] * 6
DRIVEN_M = 18.0


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


def found_doorway(seed: int, off_m: float) -> tuple[float, float]:
    """Where the robot stands, from the port, and how far it drove on, a doorway being on the left.

    It comes from the west; the doorway, 0.7 m wide, leads into a room; the wheels expect its port
    ``off_m`` too far ahead.
    """
    rng = np.random.default_rng([7, seed])
    width_m = float(rng.uniform(1.8, 2.2))
    bare = junction(EAST | WEST, width_m)
    corridor, at_m = Grid(3, 3).corridor(0, 1, EAST), 10.0
    door = Doorway(corridor, at_m=at_m, side="left", width_m=0.7, depth_m=3.0)
    body = Body(SonarRing(), fitted(bare, [door]), 0.085, rng)
    port = Pose(at_m - 20.0 - 1.0, 0.0, 0.0)
    body.arrive(body.approach(port.after(off_m), 9.0, 2.0))
    out_m = body.find_doorway()
    return body.pose.ahead_of_m(port), out_m


@pytest.mark.parametrize("off_m", [-0.1, 0.0, 0.1])
def test_it_stands_half_a_width_before_the_doorway(off_m: float) -> None:
    found = [found_doorway(seed, off_m) for seed in range(10)]
    errors_m = np.array([error_m for error_m, _ in found])
    # From a tenth of a metre further off the cones of the detectors do not pass the doorway.
    assert np.abs(errors_m).max() < 0.15
    assert abs(float(errors_m.mean())) < 0.05
    assert all(out_m > 1.0 for _, out_m in found), "it drove through the junction to hear it"


def test_by_the_wheels_alone_it_stands_where_they_say() -> None:
    rng = np.random.default_rng(1)
    body = Body(SonarRing(), junction(EAST | WEST, 2.0), 0.085, rng)
    body.arrive(body.approach(Pose(-1.0, 0.0, 0.0), DRIVEN_M, 2.0))
    before = body.pose
    assert body.find_doorway() > 1.0
    assert math.hypot(body.pose.x_m - before.x_m, body.pose.y_m - before.y_m) < 0.15
    assert body.find_doorway() == 0.0, "once is enough"


def test_where_the_wall_ends_it_does_not_look_for_a_doorway() -> None:
    looked = 0
    for seed in range(10):
        body = Body(SonarRing(), junction(0b1101, 2.0), 0.085, np.random.default_rng(seed))
        stop = body.approach(Pose(-1.0, 0.0, 0.0), DRIVEN_M, 2.0)
        body.arrive(stop)
        out_m = body.find_doorway()
        assert (out_m == 0.0) == stop.sure
        looked += out_m > 0.0
    assert looked <= 4, "the wheels expect a third of the ports further off than they think"


def test_it_does_not_drive_into_the_wall_ahead() -> None:
    body = Body(SonarRing(), junction(WEST, 2.0), 0.085, np.random.default_rng(2))
    body.arrive(body.approach(Pose(-1.0, 0.0, 0.0), DRIVEN_M, 2.0))
    out_m = body.find_doorway()
    # The far side is at x = 1, the robot began at about -1.
    assert 1.0 < out_m < 2.2 - KEEPS_OFF_M
