"""Array fields: what is checked, on every type of message that has them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as stn

from bus import messages as m
from bus.fields import SUM_TOLERANCE, FieldError, array_specs, check_arrays
from bus.topics import TOPICS
from tests.bus.made_up import messages


def pose(covariance: np.ndarray) -> m.PoseBelief:
    return m.PoseBelief(np.zeros(3), covariance)


def test_specs_are_found_by_field() -> None:
    specs = array_specs(m.JunctionPrior)
    assert list(specs) == ["prior"]
    assert (specs["prior"].dtype, specs["prior"].dimensions) == ("float64", 1)
    assert (specs["prior"].meaning, specs["prior"].length) == ("distribution", 16)
    assert array_specs(m.Departure) == {}


@given(st.data(), st.sampled_from(sorted(TOPICS)))
def test_what_a_spec_allows_passes(data: st.DataObject, topic: str) -> None:
    check_arrays(data.draw(messages(TOPICS[topic].type)))


@given(stn.arrays(np.float64, (3, 3), elements=st.floats()))
def test_finite_means_every_number_is(covariance: np.ndarray) -> None:
    if np.isfinite(covariance).all():
        check_arrays(pose(covariance))
    else:
        with pytest.raises(FieldError, match=r"^field 'covariance': holds a number that is not"):
            check_arrays(pose(covariance))


def test_big_numbers_are_finite_though_their_sum_is_not() -> None:
    check_arrays(pose(np.full((3, 3), 1e308)))


@given(st.floats(-1e-6, 1e-6))
def test_a_distribution_sums_to_one_within_the_tolerance(excess: float) -> None:
    prior = np.full(16, 1 / 16)
    prior[0] += excess
    message = m.JunctionPrior(0, 0, 0, 1, prior)
    if abs(prior.sum() - 1.0) <= SUM_TOLERANCE:
        check_arrays(message)
    else:
        with pytest.raises(FieldError, match="expected 1"):
            check_arrays(message)


def test_every_row_of_a_table_of_distributions_is_checked() -> None:
    good = m.MapBelief(
        visit=0,
        x=0,
        y=0,
        heading=1,
        junctions=np.full((2, 3, 16), 1 / 16),
        corridors=np.zeros(7),
        drive_s=np.zeros(7),
        log_evidence=0.0,
        entropy=0.0,
        maps=np.zeros((1, 7), np.uint8),
        weights=np.ones(1),
        log_probability=np.zeros(1),
    )
    check_arrays(good)
    # Two rows that are wrong by as much in opposite ways are still wrong.
    good.junctions[0, 0, 0] += 0.1
    good.junctions[1, 2, 0] -= 0.05
    with pytest.raises(FieldError, match=r"field 'junctions': sums to 1\.1, expected 1"):
        check_arrays(good)


def test_no_hypothesis_is_no_distribution() -> None:
    specs = array_specs(m.MapBelief)
    assert specs["weights"].length is None
    message = m.MapBelief(
        0, 0, 0, 1, np.full((1, 1, 16), 1 / 16), np.zeros(0), np.zeros(0), 0.0, 0.0,
        np.zeros((0, 0), np.uint8), np.zeros(0), np.zeros(0),
    )  # fmt: skip
    with pytest.raises(FieldError, match="field 'weights': is empty, expected a distribution"):
        check_arrays(message)


def test_bytes_of_another_order_are_another_dtype() -> None:
    with pytest.raises(FieldError, match="found >f8"):
        check_arrays(pose(np.zeros((3, 3), ">f8")))


def test_stakes_are_sixteen_by_sixteen_and_never_negative() -> None:
    check_arrays(m.JunctionStakes(0, np.zeros((16, 16))))
    with pytest.raises(FieldError, match=r"shape \(15, 16\), expected 16 along the first axis"):
        check_arrays(m.JunctionStakes(0, np.zeros((15, 16))))
    with pytest.raises(FieldError, match=r"holds -1\.0, expected nothing below zero"):
        check_arrays(m.JunctionStakes(0, np.full((16, 16), -1.0)))
    with pytest.raises(FieldError, match="not finite"):
        check_arrays(m.JunctionStakes(0, np.full((16, 16), np.inf)))
