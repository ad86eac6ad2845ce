"""Clusters of ranges, by hand and against a slow search."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from modules.detectors.surfaces import GAP_M, Heard, Sector, hear

AHEAD = Sector(centre_rad=0.0, half_width_rad=0.3, nearest_m=0.5, farthest_m=2.0)


def test_the_range_most_pings_agree_on_by_hand() -> None:
    nan = math.nan
    ranges = np.array([[1.00, 1.5], [1.04, nan], [1.08, 1.9], [nan, 1.3], [0.60, nan]])
    bearings = np.zeros_like(ranges)
    heard = hear(ranges, bearings, AHEAD)
    # 1.00, 1.04 and 1.08 are less than 0.05 m apart and of three of five pings; median 1.04.
    assert heard.share == pytest.approx(3 / 5)
    assert heard.range_m == pytest.approx(1.04)


def test_two_echoes_of_one_ping_count_once() -> None:
    ranges = np.array([[1.0, 1.01, 1.02], [1.6, math.nan, math.nan], [1.61, math.nan, math.nan]])
    heard = hear(ranges, np.zeros_like(ranges), AHEAD)
    assert heard.share == pytest.approx(2 / 3)
    assert heard.range_m == pytest.approx(1.605)


def test_only_the_sector_counts() -> None:
    ranges = np.array([[1.0, 1.0, 0.4, 2.1]])
    assert hear(ranges, np.array([[0.31, -0.31, 0.0, 0.0]]), AHEAD).share == 0.0
    assert hear(ranges, np.array([[2 * math.pi - 0.29, 1.0, 1.0, 1.0]]), AHEAD).share == 1.0
    behind = Sector(math.pi, 0.3, 0.5, 2.0)
    assert hear(ranges, np.array([[-math.pi + 0.1, 1.0, 1.0, 1.0]]), behind).share == 1.0


def test_silence_is_no_surface() -> None:
    heard = hear(np.full((3, 2), math.nan), np.zeros((3, 2)), AHEAD)
    assert heard.share == 0.0
    assert math.isnan(heard.range_m)


def test_probability_by_hand() -> None:
    assert Heard(0.5, 1.0).probability == pytest.approx(0.5)
    # Two thirds heard it: 3 * (2 * 2/3 - 1) = 1 effective ping, odds 9 to 1.
    assert Heard(2 / 3, 1.0).probability == pytest.approx(0.9)
    # All: 9^3 = 729 to 1.
    assert Heard(1.0, 1.0).probability == pytest.approx(729 / 730)


@given(arrays(np.float64, (6, 2), elements=st.floats(0.4, 2.2) | st.just(math.nan)))
def test_equals_a_cut_at_every_gap(
    ranges: np.ndarray[tuple[int, int], np.dtype[np.float64]],
) -> None:
    found = hear(ranges, np.zeros_like(ranges), AHEAD)
    heard = sorted(
        (range_m, ping)
        for (ping, _), range_m in np.ndenumerate(ranges.tolist())
        if 0.5 <= range_m <= 2.0
    )
    clusters: list[list[tuple[float, int]]] = []
    for range_m, ping in heard:
        if not clusters or range_m - clusters[-1][-1][0] > GAP_M:
            clusters.append([])
        clusters[-1].append((range_m, ping))
    best = max((len({ping for _, ping in cluster}) for cluster in clusters), default=0)
    assert found.share == pytest.approx(best / 6)
    if best:
        medians = [
            float(np.median([range_m for range_m, _ in cluster]))
            for cluster in clusters
            if len({ping for _, ping in cluster}) == best
        ]
        assert found.range_m == pytest.approx(min(medians))
