"""lambda(J): by hand, as a probability, and against two libraries."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.features import CONVEX_CORNER, DOOR_JAMB, FLAT_WALL, OPENING, USUAL
from bus.grid import DIRECTIONS, EAST, NORTH, SOUTH, WEST
from modules.classifier.geometry import (
    DOORWAY_RATE,
    JAMB_RATE,
    HeadingError,
    Layout,
    enterable,
    layouts,
    share,
    shown,
)
from modules.classifier.likelihood import Reading, ReadingError, junction_likelihood
from modules.classifier.sensor_model import SensorModel, shape_of

SHAPE, DETECTORS = shape_of(USUAL), USUAL.detectors
COUNTS = np.random.default_rng(7).integers(0, 300, SHAPE)
MODEL = SensorModel(COUNTS, np.full(SHAPE[:2], 40.0), {}, "a test")

visits = st.lists(
    st.builds(Reading, st.integers(0, DETECTORS - 1), st.integers(0, 3)),
    max_size=DETECTORS,
    unique_by=lambda reading: reading.detector,
)
headings = st.sampled_from(DIRECTIONS)


def test_before_the_first_reading_only_the_corridor_behind_counts() -> None:
    for heading in DIRECTIONS:
        expected = enterable(heading).astype(float)
        assert np.array_equal(junction_likelihood([], heading, MODEL), expected)


def test_by_hand() -> None:
    counts = np.zeros(SHAPE, dtype=np.int64)
    counts[OPENING, 0] = [(7, 0, 0, 1), (0, 1, 2, 5)]  # Pr(S=3|absent) 1.5/10, |present) 5.5/10
    counts[FLAT_WALL, 7] = [(3, 3, 1, 1), (0, 0, 0, 8)]  # Pr(S=1|absent) 3.5/10, |present) 0.5/10
    model = SensorModel(counts, np.ones(SHAPE[:2]), {}, "a test", astray=0.0)
    readings = [Reading(OPENING * 8 + 0, 3), Reading(FLAT_WALL * 8 + 7, 1)]
    found = junction_likelihood(readings, NORTH, model)
    assert found[NORTH] == 0.0  # not entered northward
    assert found[SOUTH] == pytest.approx(0.15 * 0.05, abs=1e-15)
    assert found[SOUTH | NORTH] == pytest.approx(0.55 * 0.05, abs=1e-15)
    assert found[SOUTH | EAST] == pytest.approx(0.15 * 0.35, abs=1e-15)
    assert found[15] == pytest.approx(0.55 * 0.35, abs=1e-15)


def test_a_door_jamb_speaks_for_a_wall_by_hand() -> None:
    counts = np.zeros(SHAPE, dtype=np.int64)
    counts[DOOR_JAMB, 1] = [(7, 0, 0, 1), (0, 1, 2, 5)]  # Pr(S=3|absent) 1.5/10, |present) 5.5/10
    model = SensorModel(counts, np.ones(SHAPE[:2]), {}, "a test", astray=0.0)
    found = junction_likelihood([Reading(USUAL.code(DOOR_JAMB, 1), 3)], NORTH, model)
    assert JAMB_RATE == 0.2
    assert found[SOUTH] == pytest.approx(0.8 * 0.15 + 0.2 * 0.55, abs=1e-15)  # a wall on the left
    assert found[SOUTH | WEST] == pytest.approx(0.15, abs=1e-15)


def test_a_doorway_is_counted_once_by_hand() -> None:
    # Both corners beside the way to the left say that walls run on: one doorway tells of both.
    counts = np.zeros(SHAPE, dtype=np.int64)
    counts[CONVEX_CORNER, [1, 2]] = [(97, 0, 0, 1), (1, 0, 0, 97)]  # Pr(S=0|absent) 97.5/100
    model = SensorModel(counts, np.ones(SHAPE[:2]), {}, "a test", astray=0.0)
    corners = [Reading(USUAL.code(CONVEX_CORNER, wedge), 0) for wedge in (1, 2)]
    found = junction_likelihood(corners, NORTH, model)
    open_left = NORTH | SOUTH | WEST
    right, wrong = 0.975, 0.015
    # A doorway ahead hides the far corner alone.
    by_hand = 0.1 * right**2 + 0.9 * (0.1 * right * wrong + 0.9 * wrong**2)
    assert DOORWAY_RATE == 0.1
    assert found[open_left] == pytest.approx(by_hand, rel=1e-12)
    assert found[NORTH | SOUTH] == pytest.approx(right**2, rel=1e-12)


def test_no_visit_rules_a_type_out_for_it_may_have_gone_astray() -> None:
    counts = np.zeros(SHAPE, dtype=np.int64)
    counts[OPENING, [0, 1]] = [(10**9, 0, 0, 0), (0, 0, 0, 10**9)]
    model = SensorModel(counts, np.ones(SHAPE[:2]), {}, "a test", astray=0.02)
    readings = [Reading(USUAL.code(OPENING, wedge), 0) for wedge in (0, 1)]
    found = junction_likelihood(readings, NORTH, model)
    # Astray both are closed in a quarter of the cases: in half of the eight types each of them is.
    assert found[SOUTH] == pytest.approx(0.98 + 0.02 / 4, rel=1e-6)
    assert found[15] == pytest.approx(0.02 / 4, rel=1e-6)
    # A second visit that says so, too, may.
    assert (found**2)[15] / (found**2)[SOUTH] == pytest.approx((0.005 / 0.985) ** 2, rel=1e-6)


@given(visits, headings, st.sampled_from([0.0, 0.02, 0.5]))
@settings(max_examples=60, deadline=None)
def test_equals_the_sum_over_doorways_x_and_going_astray(
    readings: list[Reading], heading: int, astray: float
) -> None:
    model = replace(MODEL, astray=astray)
    found = junction_likelihood(readings, heading, model)
    number, entered = DIRECTIONS.index(heading), enterable(heading)
    elsewhere = astray
    for r in readings:
        of_types = model.class_given_type[number, r.detector, entered, r.evidence]
        elsewhere *= float(of_types.mean())
    for j in range(16):
        here = 0.0
        for layout in layouts(heading) if entered[j] else ():
            if layout.type == j:
                here += share(layout, heading) * _of_layout(readings, layout, heading)
        expected = entered[j] * ((1.0 - astray) * here + elsewhere)
        assert found[j] == pytest.approx(expected, rel=1e-12, abs=0.0)


def _of_layout(readings: list[Reading], layout: Layout, heading: int) -> float:
    """P(readings|layout), X summed out one reading after the other."""
    product = 1.0
    present = shown(layout, heading)
    for r in readings:
        f, w = USUAL.parts(r.detector)
        absent, there = MODEL.probability[f, w, :, r.evidence].tolist()
        product *= (1.0 - present[f, w]) * absent + present[f, w] * there
    return product


@given(visits.filter(lambda readings: len(readings) < DETECTORS), headings)
@settings(max_examples=30, deadline=None)
def test_is_unscaled_the_outcomes_of_one_more_reading_sum_to_it(
    readings: list[Reading], heading: int
) -> None:
    used = [reading.detector for reading in readings]
    detector = next(d for d in range(DETECTORS) if d not in used)
    one_more = [
        junction_likelihood([*readings, Reading(detector, c)], heading, MODEL) for c in range(4)
    ]
    assert np.allclose(sum(one_more), junction_likelihood(readings, heading, MODEL), rtol=1e-12)


def test_refuses_what_no_visit_can_give() -> None:
    with pytest.raises(ReadingError, match=r"\[5\] read more often"):
        junction_likelihood([Reading(5, 0), Reading(5, 1)], NORTH, MODEL)
    with pytest.raises(ReadingError, match=r"0\.\.39, got 40"):
        junction_likelihood([Reading(40, 0)], NORTH, MODEL)
    with pytest.raises(ReadingError, match=r"0\.\.3, got -1"):
        Reading(0, -1)
    with pytest.raises(HeadingError, match="got 0"):
        junction_likelihood([], 0, MODEL)
