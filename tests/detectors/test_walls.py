"""Walls fitted by least squares: what was put in comes out, and doorways leave a residual."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from modules.detectors.actions import ping_offsets_rad
from modules.detectors.walls import HALF_CONE_RAD, PLAIN_M, Wall, fit_wall

OFFSETS_RAD = np.array(ping_offsets_rad())
BEARINGS_RAD = OFFSETS_RAD[:, None] + 2 * math.pi / 24 * np.arange(24)


def _of_wall(distance_m: float, normal_rad: float) -> NDArray[np.float64]:
    """What the ring hears of a wall: the nearest point in each cone, up to 22.5 degrees off."""
    off = np.abs(np.remainder(BEARINGS_RAD - normal_rad + math.pi, 2 * math.pi) - math.pi)
    beside = np.maximum(off - HALF_CONE_RAD, 0.0)
    return np.where(beside <= math.radians(22.5), distance_m / np.cos(beside), np.nan)


@given(
    st.floats(0.75, 1.2),
    st.floats(-5.0, 5.0).map(math.radians),
    st.sampled_from([-90.0, 0.0, 45.0]).map(math.radians),
)
def test_the_distance_of_a_wall_comes_out(d_m: float, askew_rad: float, at_rad: float) -> None:
    wall = fit_wall(_of_wall(d_m, at_rad + askew_rad), BEARINGS_RAD, at_rad, 1.0)
    assert wall.range_m == pytest.approx(d_m, abs=1e-3)
    assert wall.residual_m < 1e-3
    assert wall.share == 1.0
    assert wall.probability > 0.99
    assert wall.doorway < 0.02


def test_noise_is_no_doorway_and_a_step_is() -> None:
    rng = np.random.default_rng(1)
    noisy = _of_wall(1.0, 0.0) + rng.normal(0.0, 0.02, BEARINGS_RAD.shape)
    assert fit_wall(noisy, BEARINGS_RAD, 0.0, 1.0).doorway < 0.1
    stepped = noisy.copy()
    stepped[:, [0, 1]] += 0.12  # a door stands back
    found = fit_wall(stepped, BEARINGS_RAD, 0.0, 1.0)
    assert found.doorway > 0.9
    assert found.probability > 0.99


def test_a_doorway_by_hand() -> None:
    assert Wall(1.0, (1.0,), PLAIN_M, 1.0).doorway == pytest.approx(0.5)
    # 26 nats for a residual e times as large, but never more than 4: 1 / (1 + exp(-4)).
    found = Wall(1.0, (1.0,), math.e * PLAIN_M, 1.0).doorway
    assert found == pytest.approx(0.98201, abs=1e-5)
    assert Wall(1.0, (1.0,), math.exp(0.1) * PLAIN_M, 1.0).doorway == pytest.approx(
        1 / (1 + math.exp(-2.6))
    )
    # A tenth of the cones silent: 1.8 nats.
    assert Wall(1.0, (1.0, 0.9), PLAIN_M, 1.0).doorway == pytest.approx(1 / (1 + math.exp(-1.8)))


def test_silence_in_the_middle_is_no_wall_whatever_answers_beside_it() -> None:
    pierced = _of_wall(1.0, 0.0)
    pierced[:, 0] = 4.0  # the far side of a room
    found = fit_wall(pierced, BEARINGS_RAD, 0.0, 1.0)
    assert found.share == pytest.approx(2 / 3)  # heading by heading, of 3 or 4 cones
    assert found.ahead == 0.0
    assert found.probability < 0.01


def test_silence_beside_the_middle_is_still_a_wall() -> None:
    pierced = _of_wall(1.0, 0.0)
    pierced[:, 1] = 4.0
    found = fit_wall(pierced, BEARINGS_RAD, 0.0, 1.0)
    assert found.share == pytest.approx(2 / 3)
    assert found.ahead == 1.0
    assert found.probability > 0.99


@pytest.mark.parametrize(
    ("silent", "ahead", "nats"), [(1, 0.75, 3.3), (2, 0.5, -2.2), (3, 0.25, -6.6)]
)
def test_a_wall_answers_ahead_at_nearly_every_heading(
    silent: int, ahead: float, nats: float
) -> None:
    # As likely as not at 0.6 of the headings; 6.6 nats for 0.3 more or less, and never more.
    pierced = _of_wall(1.0, 0.0)
    pierced[: 3 * silent, 0] = np.nan
    found = fit_wall(pierced, BEARINGS_RAD, 0.0, 1.0)
    assert found.ahead == ahead
    assert found.probability == pytest.approx(1 / (1 + math.exp(-nats)))


def test_from_nearer_a_wall_is_nearer() -> None:
    near, far = (_of_wall(distance_m, 0.0) for distance_m in (0.65, 1.3))
    assert fit_wall(near, BEARINGS_RAD, 0.0, 1.0, 0.35).probability > 0.99
    # 1.3 half widths are within a wall's ranges from the axis, but not 1.65.
    assert fit_wall(far, BEARINGS_RAD, 0.0, 1.0).probability > 0.99
    assert fit_wall(far, BEARINGS_RAD, 0.0, 1.0, 0.35).probability < 0.01


def test_headings_that_disagree_leave_doubt_by_hand() -> None:
    sure = 1 / (1 + math.exp(-6.6))
    # Even at a quarter of the cones, sure a fifth above it or below; the fewest and the middle.
    assert Wall(1.0, (1.0, 1.0, 1.0, 1.0), 0.01, 1.0).probability == pytest.approx(sure)
    assert Wall(1.0, (0.0, 1.0, 1.0, 1.0), 0.01, 1.0).probability == pytest.approx(0.5)
    assert Wall(1.0, (0.0, 0.0, 0.0, 1.0), 0.01, 1.0).probability == pytest.approx(1 - sure)
    assert Wall(1.0, (0.35, 0.35), 0.01, 1.0).probability == pytest.approx(1 / (1 + math.exp(-3.3)))


def test_nothing_heard_is_no_wall() -> None:
    found = fit_wall(np.full(BEARINGS_RAD.shape, np.nan), BEARINGS_RAD, 0.0, 1.0)
    assert found.share == 0.0
    assert math.isnan(found.range_m)
    assert found.probability < 0.01
    assert found.doorway == 0.5


def test_who_walks_by_during_one_heading_makes_no_wall_and_no_doorway() -> None:
    nobody = np.full(BEARINGS_RAD.shape, np.nan)
    nobody[3:6, [22, 23, 0, 1, 2]] = 0.8
    assert fit_wall(nobody, BEARINGS_RAD, 0.0, 1.0).probability < 0.01
    before_a_wall = _of_wall(1.0, 0.0)
    before_a_wall[3:6, [0, 1]] = 0.7
    found = fit_wall(before_a_wall, BEARINGS_RAD, 0.0, 1.0)
    assert found.range_m == pytest.approx(1.0, abs=0.02)
    assert found.doorway < 0.1


def test_one_lost_or_false_echo_in_three_does_not_matter() -> None:
    ranges = _of_wall(1.0, 0.0)
    ranges[::3] = np.nan
    ranges[1::3, 0] = 0.3  # cross-talk, nearer than any wall
    whole = fit_wall(_of_wall(1.0, 0.0), BEARINGS_RAD, 0.0, 1.0)
    found = fit_wall(ranges, BEARINGS_RAD, 0.0, 1.0)
    assert found.range_m == pytest.approx(whole.range_m, abs=1e-3)
    assert found.share < whole.share  # of the cone ahead only one of three is left
