"""What computing costs, and how much of it fits into a time."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from bus.costs import KINDS, PROFILES, UNLIMITED, CostModel, Rate

TIMES = st.integers(-(10**6), 10**13)
rates = st.builds(Rate, st.floats(0.0, 1e10), st.floats(1e-3, 1e7))


@given(rates, st.integers(0, 10**10), TIMES)
def test_what_fits_fits_and_one_cell_more_does_not(rate: Rate, extra_ns: int, time_ns: int) -> None:
    costs = CostModel("made up", {"path": rate}, {"path": extra_ns})
    cells = costs.cells_within("path", time_ns)
    if cells >= 0:
        assert costs.cost_ns("path", cells) <= time_ns
    assert costs.cost_ns("path", cells + 1) > time_ns


@given(rates, st.integers(0, 10**7))
def test_exactly_the_cost_is_enough(rate: Rate, cells: int) -> None:
    costs = CostModel("made up", {"path": rate})
    assert costs.cells_within("path", costs.cost_ns("path", cells)) >= cells


def test_what_costs_nothing_always_fits() -> None:
    free = CostModel("free")
    assert free.cost_ns("path", 10**9) == 0
    assert free.cells_within("path", 0) == UNLIMITED
    assert free.cells_within("path", -1) == -1


def test_what_is_made_slower_leaves_less_time() -> None:
    slower = CostModel("free", {}, {"path": 100})
    assert slower.cost_ns("path", 7) == 100
    assert slower.cost_ns("sensing", 7) == 0
    assert slower.cells_within("path", 99) == -1


def test_the_paper_s_line() -> None:
    """Table 1, as fitted: 2.09 s and 0.948 ms a cell."""
    huey = CostModel("huey-1990", PROFILES["huey-1990"])
    assert huey.cost_ns("belief", 0) == 2_090_000_000
    assert huey.cost_ns("belief", 1000) == 3_038_000_000
    assert huey.cells_within("belief", 3_038_000_000) == 1000
    assert huey.cells_within("belief", 3_037_999_999) == 999
    assert huey.cells_within("belief", 2_089_999_999) == -1


def test_profiles_price_known_kinds_only() -> None:
    for profile in PROFILES.values():
        assert set(profile) <= set(KINDS)
