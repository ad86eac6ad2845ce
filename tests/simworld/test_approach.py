"""The robot finds ports by what it hears: where a wall ends, or how far the wall ahead is."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from bus.grid import EAST, JUNCTION_TYPES, WEST, Grid
from scenarios.trial_junction import junction
from simworld.approach import Stop
from simworld.body import COUNT_SHARE, OFF_LINE_M, Body
from simworld.fittings import Doorway, fitted
from simworld.motion import Pose
from simworld.sonar import SonarRing

DRIVEN_M = 18.0
ENTERED = [j for j in range(JUNCTION_TYPES) if j & WEST]
STRAIGHT = EAST | WEST


def stopped(
    junction_type: int, seed: int, ring: SonarRing | None = None, door: Doorway | None = None
) -> Stop:
    """Where a robot stops that comes from the west, the port being at (0, 0)."""
    rng = np.random.default_rng([junction_type, seed])
    width_m = float(rng.uniform(1.8, 2.2))
    building = fitted(junction(junction_type, width_m), [door] if door else [])
    body = Body(ring or SonarRing(), building, 0.085, rng)
    port = Pose(-width_m / 2, 0.0, 0.0)
    stop = body.approach(port, DRIVEN_M, 2.0)
    moved = Pose(stop.pose.ahead_of_m(port), stop.pose.y_m, stop.pose.heading_rad)
    return replace(stop, pose=moved)


@pytest.mark.parametrize("junction_type", [j for j in ENTERED if j != STRAIGHT])
def test_it_stops_at_the_port_of_a_junction_by_the_walls(junction_type: int) -> None:
    stops = [stopped(junction_type, seed) for seed in range(12)]
    by = Counter(stop.by for stop in stops)
    assert by["wall ahead" if junction_type == WEST else "wall ends"] >= 9
    assert by["wheels"] == 0
    errors_m = np.array([stop.pose.x_m for stop in stops])
    assert np.abs(errors_m).max() < (0.2 if junction_type == WEST else 0.1)
    assert errors_m.std() < 0.07, "the wheels alone miscount by 20 cm"


def test_it_goes_by_its_wheels_where_no_wall_changes() -> None:
    stops = [stopped(STRAIGHT, seed) for seed in range(25)]
    assert {stop.by for stop in stops} == {"wheels"}
    errors_m = np.array([stop.pose.x_m for stop in stops])
    sigma_m = math.hypot(OFF_LINE_M, COUNT_SHARE * DRIVEN_M)
    assert 0.05 < errors_m.std() < sigma_m
    assert all(stop.beyond_m > 2 * sigma_m for stop in stops), "it looked for longer, in vain"


def test_it_follows_the_corridor_to_the_port() -> None:
    stops = [stopped(j, seed) for j in ENTERED for seed in range(4)]
    askew_rad = np.array([stop.pose.heading_rad for stop in stops])
    assert askew_rad.std() < math.radians(1.5), "it began askew by 2 degrees"
    assert max(abs(stop.pose.y_m) for stop in stops) < 0.12
    assert max(abs(stop.pose.heading_rad) for stop in stops) < math.radians(3.5)


@pytest.mark.parametrize("ring", [SonarRing(transducers=16), SonarRing(transducers=48)])
def test_other_rings_find_ports_too(ring: SonarRing) -> None:
    stops = [stopped(j, seed, ring) for j in (0b1001, 0b1101) for seed in range(4)]
    assert all(stop.by != "wheels" and abs(stop.pose.x_m) < 0.15 for stop in stops)


def test_the_stub_of_a_closed_door_is_no_port() -> None:
    door = Doorway(Grid(3, 3).corridor(0, 1, EAST), at_m=18.0, side="left", width_m=0.9)
    stops = [stopped(0b1100, seed, door=door) for seed in range(8)]
    # it ends half a metre before the port
    assert np.abs([stop.pose.x_m for stop in stops]).max() < 0.3


def test_an_approach_repeats() -> None:
    assert stopped(0b1101, 3) == stopped(0b1101, 3)
