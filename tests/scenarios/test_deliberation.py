"""One processor's time given by marginal value: against brute force, and in whole runs."""

from __future__ import annotations

from itertools import product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.allocation import ByValue, building_by_value
from benchmarks.deliberation import Profile, Wanted, allotted, convex
from bus.messages import PathDecision, SensingDecision
from scenarios.draw import draw
from scenarios.modules import build_module
from tests.scenarios.runs import everything_said, of_kind, shipped

STEEP = Profile((0.0, 10.0, 40.0), (100.0, 20.0, 5.0))  # 8 a second, then 0.5
FLAT = Profile((0.0, 20.0), (30.0, 10.0))  # 1 a second


def test_each_slice_goes_where_it_gains_most() -> None:
    both = {"steep": Wanted(STEEP, 15.0), "flat": Wanted(FLAT, 15.0)}
    assert allotted(both) == {"steep": 10.0, "flat": 5.0}
    more = {"steep": Wanted(STEEP, 60.0), "flat": Wanted(FLAT, 60.0)}
    assert allotted(more) == {"steep": 40.0, "flat": 20.0}


def test_what_is_due_first_gets_nothing_of_the_time_after() -> None:
    # Backward from 15 s: the last 10 s belong to the later decision alone.
    wanted = {"soon": Wanted(STEEP, 5.0), "later": Wanted(FLAT, 15.0)}
    assert allotted(wanted) == {"soon": 5.0, "later": 10.0}
    assert allotted({"soon": Wanted(STEEP, -3.0), "later": Wanted(FLAT, 7.0)}) == {
        "soon": 0.0,
        "later": 7.0,
    }


def test_a_slice_that_gains_less_than_its_price_is_not_given() -> None:
    both = {"steep": Wanted(STEEP, 60.0), "flat": Wanted(FLAT, 60.0)}
    assert allotted(both, price=0.7) == {"steep": 10.0, "flat": 20.0}
    assert allotted(both, price=2.0) == {"steep": 10.0, "flat": 0.0}
    with pytest.raises(ValueError, match="price is -1"):
        allotted(both, price=-1.0)


def test_a_curve_becomes_what_time_is_worth_on_the_way_to_its_next_point() -> None:
    # nothing until 10 s, then all at once; a bump that is worse than before is passed over
    assert convex([0.0, 5.0, 10.0, 20.0], [100.0, 100.0, 0.0, 3.0]) == Profile(
        (0.0, 10.0), (100.0, 0.0)
    )
    with pytest.raises(ValueError, match="rise from 0"):
        convex([1.0, 2.0], [3.0, 2.0])


curves = st.lists(st.integers(0, 60), min_size=1, max_size=4).map(
    lambda drops: convex(
        [float(3 * k) for k in range(len(drops) + 1)],
        [float(sum(drops) - sum(drops[:k])) for k in range(len(drops) + 1)],
    )
)


def worth_s(profile: Profile, spent_s: float) -> float:
    """What is saved by spending so long, by adding up second for second."""
    return sum(profile.gain_a_second(float(k)) for k in range(int(spent_s)))


@settings(max_examples=60, deadline=None)
@given(curves, curves, st.integers(0, 12), st.integers(0, 12))
def test_no_other_allotment_of_whole_seconds_is_worth_more(
    one: Profile, other: Profile, left: int, left_other: int
) -> None:
    given_s = allotted({"a": Wanted(one, float(left)), "b": Wanted(other, float(left_other))})
    best = max(
        worth_s(one, a) + worth_s(other, b)
        for a, b in product(range(left + 1), range(left_other + 1))
        if a + b <= max(left, left_other)
    )
    assert sum(given_s.values()) <= max(left, left_other)
    assert given_s["a"] <= left
    assert given_s["b"] <= left_other
    found = worth_s(one, given_s["a"]) + worth_s(other, given_s["b"])
    assert found == pytest.approx(best)


SHORT = ("compute.profile=huey-1990", "compute.processors=1", "world.until_s=500")


def test_a_run_by_value_solves_no_larger_problems_than_it_is_given() -> None:
    # 12 s are enough for plans of one test, not of two, for which even a corridor of four minutes
    # is not quite enough; a path is worth nothing.
    worthless = Profile((0.0,), (0.0,))
    profiles = {
        "path": worthless,
        "first feature": Profile((0.0, 12.0), (100.0, 0.0)),
        "next feature": Profile((0.0, 60.0), (100.0, 0.0)),
    }
    scenario = shipped("aces", *SHORT, "world.speed_m_s=0.075", seed=1).scenario
    by_value = everything_said(scenario, building_by_value(profiles, 0.0))
    as_ever = everything_said(scenario)
    first = [d.look_ahead for d in of_kind(by_value, SensingDecision) if d.action == 0]
    assert first
    assert set(first) == {1}
    assert max(d.look_ahead for d in of_kind(as_ever, SensingDecision) if d.action == 0) == 2
    # One hypothesis for each type is the least that the decider solves.
    assert max(d.hypotheses for d in of_kind(by_value, PathDecision)) <= 8
    assert max(d.hypotheses for d in of_kind(as_ever, PathDecision)) > 8


def test_only_the_modules_that_deliberate_are_on_an_allowance() -> None:
    facts = draw(shipped("aces").scenario, "a test").facts
    build = building_by_value({}, 0.0)
    wrapped = {
        name
        for name in ("classifier", "decider", "reactor", "sensor")
        if isinstance(build(name, facts, {}, 1), ByValue)
    }
    assert wrapped == {"classifier", "decider"}
    assert type(build("reactor", facts, {}, 1)) is type(build_module("reactor", facts, {}, 1))
