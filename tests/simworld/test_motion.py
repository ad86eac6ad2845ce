"""What motions take, where they lead, and the statistics of odometry, all worked by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import strategies as st

from simworld.motion import (
    Drive,
    MotionError,
    Odometer,
    Ping,
    Pose,
    Primitive,
    Rates,
    Turn,
    duration_ns,
    random_odometer,
)

RATES = Rates()
START = Pose(1.0, 2.0, math.pi / 2)

primitives = st.one_of(
    st.floats(-30.0, 30.0).map(Drive), st.floats(-7.0, 7.0).map(Turn), st.integers(0, 5).map(Ping)
)


def test_durations() -> None:
    assert duration_ns(Ping(1), RATES) == 960_000_000  # 24 * 40 ms
    assert duration_ns(Ping(3), RATES) == 2_880_000_000
    # 0.85 m at 0.085 m/s, either way: 10 s. 90 degrees at 15 degrees a second: 6 s.
    for distance_m in (0.85, -0.85):
        assert duration_ns(Drive(distance_m), RATES) == pytest.approx(10e9, abs=2)
    assert duration_ns(Turn(-math.pi / 2), RATES) == pytest.approx(6e9, abs=2)
    # The paper's four minutes a corridor: 20.4 m.
    assert duration_ns(Drive(20.4), RATES) == pytest.approx(240e9, abs=2)
    assert duration_ns(Drive(0.0), RATES) == 0
    # A third of a nanosecond is not done in none.
    assert duration_ns(Drive(1.0), Rates(drive_m_s=3e9)) == 1


def test_beside_is_to_the_left() -> None:
    # Facing north, left is west.
    beside = START.beside(0.5)
    assert (beside.x_m, beside.y_m, beside.heading_rad) == pytest.approx((0.5, 2.0, math.pi / 2))


def test_arc() -> None:
    # A quarter circle of radius 2 to the left from the origin, facing east: to (2, 2), north.
    end = Pose(0.0, 0.0, 0.0).after(math.pi, math.pi / 2)
    assert (end.x_m, end.y_m, end.heading_rad) == pytest.approx((2.0, 2.0, math.pi / 2))


@pytest.mark.parametrize("motion", [Drive(math.nan), Turn(math.inf), Ping(-1)])
def test_impossible_motions_are_refused(motion: Primitive) -> None:
    with pytest.raises(MotionError, match="expected"):
        duration_ns(motion, RATES)


def test_rates_must_be_positive() -> None:
    with pytest.raises(MotionError, match=r"drive_m_s: found 0\.0"):
        Rates(drive_m_s=0.0)
    with pytest.raises(MotionError, match="turn_rad_s"):
        Rates(turn_rad_s=math.nan)


def test_systematic_errors_of_odometry() -> None:
    # 10 m read 2 % long, and 0.01 rad of drift a metre; a turn on the spot does not drift.
    odometer = Odometer(1.02, 0.01, distance_noise_m=0.0, heading_noise_rad=0.0)
    rng = np.random.default_rng(1)
    assert odometer.read(10.0, 0.5, rng) == pytest.approx((10.2, 0.6))
    assert odometer.read(-10.0, 0.0, rng) == pytest.approx((-10.2, 0.1))
    assert odometer.read(0.0, 1.0, rng) == pytest.approx((0.0, 1.0))


@pytest.mark.parametrize("steps", [1, 16])
def test_random_errors_do_not_depend_on_the_step(steps: int) -> None:
    # 4 m: 0.005 * sqrt(4) = 10 mm; 4 m and 5 rad: 0.01 * sqrt(9) = 0.03 rad. 4000 runs give a
    # deviation to 4 / sqrt(8000) = 4.5 %.
    odometer = Odometer(distance_noise_m=0.005, heading_noise_rad=0.01)
    rng = np.random.default_rng(2)
    read = np.array(
        [
            np.sum([odometer.read(4.0 / steps, 5.0 / steps, rng) for _ in range(steps)], axis=0)
            for _ in range(4000)
        ]
    )
    assert read.std(axis=0) == pytest.approx([0.010, 0.030], rel=0.045)
    assert read.mean(axis=0) == pytest.approx([4.0, 5.0], abs=4 * 0.03 / math.sqrt(4000))


def test_each_robot_has_errors_of_its_own() -> None:
    rng = np.random.default_rng(3)
    robots = [random_odometer(rng, 0.01, 0.005) for _ in range(4000)]
    spread = np.std([(r.distance_scale, r.drift_rad_m) for r in robots], axis=0)
    assert spread == pytest.approx([0.01, 0.005], rel=0.045)
    assert random_odometer(np.random.default_rng(7)) == random_odometer(np.random.default_rng(7))
