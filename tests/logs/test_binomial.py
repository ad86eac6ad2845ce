"""Exact binomial bounds, against scipy's and by hand."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import binom, binomtest

from logs.binomial import interval, lower_bound, trials_needed, upper_bound


@given(st.integers(1, 400), st.data(), st.sampled_from((0.8, 0.95, 0.99)))
def test_the_interval_is_that_of_scipy(trials: int, data: st.DataObject, confidence: float) -> None:
    successes = data.draw(st.integers(0, trials))
    expected = binomtest(successes, trials).proportion_ci(confidence, method="exact")
    found = interval(successes, trials, confidence)
    assert found == pytest.approx((expected.low, expected.high), abs=1e-9)


@given(st.integers(1, 300), st.data())
def test_at_the_bound_as_many_successes_are_just_rare(trials: int, data: st.DataObject) -> None:
    successes = data.draw(st.integers(1, trials))
    bound = lower_bound(successes, trials, 0.95)
    assert binom.sf(successes - 1, trials, bound) == pytest.approx(0.05, abs=1e-6)


def test_nothing_is_known_without_a_success_or_a_failure() -> None:
    assert lower_bound(0, 10, 0.95) == 0.0
    assert lower_bound(0, 0, 0.95) == 0.0
    assert upper_bound(10, 10, 0.95) == 1.0


@pytest.mark.parametrize("probability, needed", [(0.99, 299), (0.95, 59), (0.9, 29)])
def test_so_many_successes_in_a_row_show_a_probability(probability: float, needed: int) -> None:
    assert trials_needed(probability, 0.95) == needed
    assert lower_bound(needed, needed, 0.95) >= probability
    assert lower_bound(needed - 1, needed - 1, 0.95) < probability
