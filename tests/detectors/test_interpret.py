"""What detectors make of echoes: by hand, and in simulated junctions of every type."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from bus.features import CONVEX_CORNER, FEATURES, FLAT_WALL, OPENING, WEDGES
from bus.grid import NORTH
from modules.classifier.geometry import enterable, features_present
from modules.detectors.actions import ping_offsets_rad, plan
from modules.detectors.interpret import Finding, Surfaces, interpret
from modules.detectors.views import DetectorError
from scenarios.calibrate_detectors import act, at_port, junction
from simworld.sonar import SonarRing

OFFSETS_RAD = np.array(ping_offsets_rad())
PINGS = len(OFFSETS_RAD)


def _heard(ranges_m: dict[int, float]) -> NDArray[np.float64]:
    """Echoes at the same ranges at every ping, of some transducers (negative: to the right)."""
    ping = np.full(24, np.nan)
    for transducer, range_m in ranges_m.items():
        ping[transducer] = range_m
    return np.tile(ping, (PINGS, 1))


def _found(feature: int, wedge: int, ranges_m: dict[int, float]) -> Finding:
    return interpret(feature, wedge, _heard(ranges_m), OFFSETS_RAD, 2.0)


WALL = dict.fromkeys((-2, -1, 0, 1, 2), 1.0)
# At 45 degrees to a corner: transducers 3 and 4 look 45 and 60 degrees to the left of the view.
LEFT_WALL, RIGHT_WALL = {3: 1.0, 4: 1.0}, {-3: 1.0, -4: 1.0}
CORNER = {-1: 1.414, 0: 1.414, 1: 1.414}


def test_a_wall_square_on_by_hand() -> None:
    assert _found(FLAT_WALL, 0, WALL).evidence == 3
    assert _found(OPENING, 0, WALL).evidence == 0
    assert _found(CONVEX_CORNER, 0, WALL).evidence == 0


def test_an_open_side_by_hand() -> None:
    corners = {3: 1.414, -3: 1.414, 0: 9.0}
    for ranges_m in (corners, {}):
        assert _found(FLAT_WALL, 1, ranges_m).evidence == 0
        assert _found(OPENING, 1, ranges_m).evidence == 3


@pytest.mark.parametrize(
    ("ranges_m", "convex", "flat"),
    [
        (CORNER, 3, 0),
        (CORNER | LEFT_WALL | RIGHT_WALL, 0, 0),  # concave
        (CORNER | LEFT_WALL, 0, 0),
        (LEFT_WALL, 0, 3),
        (RIGHT_WALL, 0, 3),
        (LEFT_WALL | {1: 1.08, 0: 1.08}, 0, 3),  # the wall's grazing echo is no corner
        ({}, 0, 0),
    ],
)
def test_a_corner_by_hand(ranges_m: dict[int, float], convex: int, flat: int) -> None:
    assert _found(CONVEX_CORNER, 2, ranges_m).evidence == convex
    assert _found(FLAT_WALL, 2, ranges_m).evidence == flat


def test_opening_at_a_corner_needs_silence_all_round() -> None:
    assert _found(OPENING, 2, {}).evidence == 3
    for ranges_m in (CORNER, LEFT_WALL, RIGHT_WALL):
        assert _found(OPENING, 2, ranges_m).evidence == 0


def test_doubt_is_graded() -> None:
    probabilities = []
    evidence = []
    for hits in range(PINGS + 1):
        ranges = _heard({})
        ranges[:hits, 0] = 1.0
        found = interpret(OPENING, 0, ranges, OFFSETS_RAD, 2.0)
        probabilities.append(found.probability)
        evidence.append(found.evidence)
        assert found.statistic == pytest.approx(
            math.log(found.probability / (1 - found.probability))
        )
    assert probabilities == sorted(probabilities, reverse=True)
    # Odds of the wall are 9^(3 (2 k/12 - 1)), 1:9 at k = 4, even at 6, 9:1 at 8 hits.
    # Too close to call at 4, 6 and 8, where odds are just at a bound.
    assert evidence[:4] == [3, 3, 3, 3]
    assert (evidence[5], evidence[7]) == (2, 1)
    assert evidence[9:] == [0, 0, 0, 0]


def test_surfaces_to_features_by_hand() -> None:
    surfaces = Surfaces(ahead=0.8, left=0.1, right=0.3)
    assert surfaces.feature(OPENING, at_corner=False) == pytest.approx(0.2)
    assert surfaces.feature(OPENING, at_corner=True) == pytest.approx(0.2 * 0.9 * 0.7)
    assert surfaces.feature(CONVEX_CORNER, at_corner=True) == pytest.approx(0.8 * 0.9 * 0.7)
    assert surfaces.feature(FLAT_WALL, at_corner=False) == pytest.approx(0.8 * (1 - 0.9 * 0.7))
    # One wall and not the other: 0.1 * 0.7 + 0.3 * 0.9 = 0.34.
    assert surfaces.feature(FLAT_WALL, at_corner=True) == pytest.approx(0.2 * 0.34)


echoes_drawn = arrays(
    np.float64, (PINGS, 24), elements=st.sampled_from([math.nan, 0.9, 1.0, 1.05, 1.41, 1.5, 6.0])
)


@given(echoes_drawn, st.integers(0, 2), st.integers(0, 7))
def test_left_is_the_mirror_of_right(ranges: NDArray[np.float64], feature: int, wedge: int) -> None:
    mirrored = ranges[:, -np.arange(24) % 24]
    found = interpret(feature, wedge, ranges, OFFSETS_RAD, 2.0)
    image = interpret(feature, -wedge % WEDGES, mirrored, -OFFSETS_RAD, 2.0)
    assert found.probability == pytest.approx(image.probability, rel=1e-9)
    assert 0.0 < found.probability < 1.0


def _wrong(
    width_m: float, lateral_m: float, askew_rad: float, ring: SonarRing, seed: int
) -> list[tuple[int, int, int]]:
    """Detectors that are wrong about (type, feature, wedge) on entering every type northward."""
    rng = np.random.default_rng(seed)
    wrong = []
    for j in np.flatnonzero(enterable(NORTH)).tolist():
        building = junction(j, width_m)
        start = at_port(building, NORTH, lateral_m, askew_rad)
        present = features_present(j, NORTH)
        for f, w in np.ndindex(len(FEATURES), WEDGES):
            ranges_m = act(plan(f, w, 2.0), start, building, ring, rng, bystander_share=0.0)
            found = interpret(f, w, ranges_m, OFFSETS_RAD, 2.0)
            if (found.evidence >= 2) != present[f, w]:
                wrong.append((j, f, w))
    return wrong


def test_every_detector_is_right_about_every_type() -> None:
    assert _wrong(2.0, 0.0, 0.0, SonarRing(), seed=1) == []


@pytest.mark.parametrize("width_m", [1.7, 2.2])
@pytest.mark.parametrize("lateral_m", [-0.1, 0.1])
@pytest.mark.parametrize("askew_deg", [-4.0, 4.0])
def test_at_the_limits_of_width_and_pose(
    width_m: float, lateral_m: float, askew_deg: float
) -> None:
    wrong = _wrong(width_m, lateral_m, math.radians(askew_deg), SonarRing(), seed=2)
    assert wrong == []


def test_with_a_poor_ring() -> None:
    poor = SonarRing(dropout=0.1, cross_talk=0.05)
    assert _wrong(2.0, 0.05, 0.03, poor, seed=3) == []


def test_refuses_what_is_not_an_actions_echoes() -> None:
    ranges = _heard({})
    with pytest.raises(DetectorError, match=r"found \(12, 24\) and \(11,\)"):
        interpret(0, 0, ranges, OFFSETS_RAD[:-1], 2.0)
    with pytest.raises(DetectorError, match=r"found \(0, 24\)"):
        interpret(0, 0, ranges[:0], OFFSETS_RAD[:0], 2.0)
    with pytest.raises(DetectorError, match="got feature 0, wedge 8"):
        interpret(0, 8, ranges, OFFSETS_RAD, 2.0)
    with pytest.raises(DetectorError, match="must be positive"):
        interpret(0, 0, ranges, OFFSETS_RAD, -2.0)
