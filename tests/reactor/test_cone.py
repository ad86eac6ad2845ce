"""Echoes of a disc in a cone: by hand, and against the simulated ring."""

from __future__ import annotations

import math

import numpy as np
import pytest

from bus.facts import Ring
from modules.reactor.cone import RingError, check_ring, heard_in_cone
from simworld.building import build
from simworld.sonar import SonarRing, true_ranges_m

AHEAD, LEFT, RIGHT = range(3)


def one(ahead: float, left: float, cone: int) -> tuple[float, bool]:
    """Range and heard of a disc of radius 0.25."""
    range_m, heard = heard_in_cone(ahead, left, 0.25, cone)
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


def test_the_simulated_ring_hears_the_same() -> None:
    building = build([0.0, 26.4], [0.0, 20.0], np.array([1, 0, 1, 1], np.uint8), 2.0)
    ring = SonarRing()
    rng = np.random.default_rng(3)
    for _ in range(200):
        ahead, left = float(rng.uniform(1.0, 9.0)), float(rng.uniform(-0.7, 0.7))
        true = true_ranges_m(ring, building, 13.2, 0.0, 0.0, [(13.2 + ahead, left, 0.25)])
        for k, cone in ((0, AHEAD), (1, LEFT), (-1, RIGHT)):
            range_m, heard = one(ahead, left, cone)
            assert heard == bool(np.isfinite(true[k]) and true[k] < ahead + 0.3)
            if heard:
                assert true[k] == pytest.approx(range_m, abs=1e-6)


def test_what_the_robot_stands_in_is_heard_at_once() -> None:
    range_m, heard = one(0.1, 0.05, AHEAD)
    assert heard and range_m == pytest.approx(0.0, abs=1e-4)
    assert not one(-0.1, 0.05, AHEAD)[1]


def test_a_ring_of_other_cones_is_refused() -> None:
    check_ring(Ring())
    check_ring(Ring(farthest_m=6.0))
    with pytest.raises(RingError, match=r"found a ring of 16 .* expected 24 of 15"):
        check_ring(Ring(transducers=16))
    with pytest.raises(RingError, match=r"cones of 10 degrees"):
        check_ring(Ring(half_angle_rad=math.radians(10.0)))
