"""Echoes of a disc in a cone: by hand, and against the simulated ring."""

from __future__ import annotations

import math

import numpy as np
import pytest

from bus.facts import Ring
from modules.reactor.cone import USUAL, RingError, cones_ahead, heard_in_cone
from simworld.building import build
from simworld.sonar import SonarRing, true_ranges_m

AHEAD, LEFT, RIGHT = range(3)


def one(ahead: float, left: float, cone: int) -> tuple[float, bool]:
    """Range and heard of a disc of radius 0.25."""
    range_m, heard = heard_in_cone(ahead, left, 0.25, USUAL.edges, cone)
    return float(range_m), bool(heard)


def test_straight_ahead_is_heard_a_radius_nearer() -> None:
    range_m, heard = one(5.0, 0.0, AHEAD)
    assert heard
    assert range_m == pytest.approx(4.75)


def test_a_cone_that_is_grazed_hears_it_later() -> None:
    # The cone to the right ends at bearing 0, the x axis: it cuts the disc at (5, 0.15) at
    # x = 5 - sqrt(0.25^2 - 0.15^2) = 4.8; the nearest point is at sqrt(25.0225) - 0.25.
    right, left = one(5.0, 0.15, RIGHT), one(5.0, 0.15, LEFT)
    assert right[1] and left[1]
    assert right[0] == pytest.approx(4.8)
    assert left[0] == pytest.approx(math.hypot(5.0, 0.15) - 0.25)


def test_a_cone_beside_it_does_not_hear_it() -> None:
    assert not one(5.0, 0.26, RIGHT)[1]
    assert one(5.0, 0.24, RIGHT)[1]


@pytest.mark.parametrize(
    ("transducers", "half_angle_deg"), [(24, 15.0), (16, 20.0), (36, 10.0), (48, 7.5)]
)
def test_the_simulated_ring_hears_the_same(transducers: int, half_angle_deg: float) -> None:
    building = build([0.0, 26.4], [0.0, 20.0], np.array([1, 0, 1, 1], np.uint8), 2.0)
    ring = SonarRing(transducers=transducers, half_angle_rad=math.radians(half_angle_deg))
    cones = cones_ahead(Ring(transducers, math.radians(half_angle_deg)))
    rng = np.random.default_rng(3)
    for _ in range(200):
        ahead, left = float(rng.uniform(1.0, 9.0)), float(rng.uniform(-0.7, 0.7))
        true = true_ranges_m(ring, building, 13.2, 0.0, 0.0, [(13.2 + ahead, left, 0.25)])
        for cone, k in enumerate(cones.numbers[:3]):
            range_m, heard = heard_in_cone(ahead, left, 0.25, cones.edges, cone)
            assert heard == bool(np.isfinite(true[k]) and true[k] < ahead + 0.3)
            if heard:
                assert true[k] == pytest.approx(range_m, abs=1e-6)


def test_what_the_robot_stands_in_is_heard_at_once() -> None:
    range_m, heard = one(0.1, 0.05, AHEAD)
    assert heard and range_m == pytest.approx(0.0, abs=1e-4)
    assert not one(-0.1, 0.05, AHEAD)[1]


@pytest.mark.parametrize(("transducers", "ahead"), [(16, 3), (24, 5), (36, 7), (48, 9), (11, 3)])
def test_the_cones_ahead_are_those_within_35_degrees(transducers: int, ahead: int) -> None:
    cones = cones_ahead(Ring(transducers=transducers, farthest_m=6.0))
    axes_deg = cones.numbers * 360.0 / transducers
    assert len(cones.numbers) == len(cones.edges) == ahead
    assert axes_deg[0] == 0.0 and np.abs(axes_deg).max() <= 35.0
    assert np.abs(axes_deg).max() + 360.0 / transducers > 35.0
    assert (axes_deg[1::2] > 0.0).all() and (axes_deg[1::2] == -axes_deg[2::2]).all()
    assert (cones.farthest_m, cones.transducers) == (6.0, transducers)


def test_a_ring_that_does_not_see_ahead_is_refused() -> None:
    with pytest.raises(RingError, match=r"ring of 8 .* of which 1 look ahead; expected 3"):
        cones_ahead(Ring(transducers=8))
    with pytest.raises(RingError, match=r"cones of 3 degrees .* at least 3.8 degrees"):
        cones_ahead(Ring(half_angle_rad=math.radians(3.0)))
