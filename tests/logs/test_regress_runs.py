"""Two sides' runs held against each other: exactly in time, within a tolerance in work."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from logs.regress.compare import compare
from logs.regress.matching import MismatchError, match
from logs.regress.regression import FAILED, GOOD, INCONCLUSIVE, regress
from logs.regress.summary import made_from
from tests.logs.made_regress import decision, summary, with_decision, with_work


def test_equal_runs_are_good() -> None:
    found = regress([summary()], [summary()])
    assert (found.outcome, found.runs[0].cause) == (GOOD, "")


@given(st.integers(0, 3), st.integers(-(10**9), 10**9).filter(bool))
def test_a_nanosecond_is_a_change(at: int, by_ns: int) -> None:
    base = summary()
    one = base.ledger[at]
    new = with_decision(base, at, decided_ns=one.decided_ns + by_ns, slack_ns=one.slack_ns - by_ns)
    found = regress([base], [new])
    assert found.outcome == FAILED
    assert [change.base for change in found.runs[0].comparison.ledger] == [one]
    assert f"{one.kind} {one.decision}" in found.runs[0].cause


def test_a_decision_of_one_side_alone_is_a_change() -> None:
    found = compare(summary(3), summary(4))
    assert [(change.base, change.new) for change in found.ledger] == [(None, decision(4))]
    found = compare(summary(4), summary(3))
    assert [(change.base, change.new) for change in found.ledger] == [(decision(4), None)]


def test_what_became_late_is_told() -> None:
    late = with_decision(summary(), 1, slack_ns=-1, cause="overrun")
    (change,) = compare(summary(), late).ledger
    assert change.became_late
    assert not compare(late, summary()).ledger[0].became_late


def test_another_end_is_a_change() -> None:
    found = regress([summary()], [replace(summary(), ended="stuck")])
    assert found.outcome == FAILED
    assert "done after 1000.000000000 s -> stuck after" in found.runs[0].cause


@pytest.mark.parametrize(
    "cells, tolerance, outcome",
    [
        (40_001, 0.0, FAILED),
        (40_200, 0.005, GOOD),
        (39_800, 0.005, GOOD),
        (40_201, 0.005, FAILED),
        (39_799, 0.005, FAILED),
    ],
)
def test_work_is_exact_or_within_the_tolerance(cells: int, tolerance: float, outcome: str) -> None:
    new = with_work(summary(), 1, cells=cells)
    assert regress([summary()], [new], tolerance).outcome == outcome


def test_the_tolerance_is_not_for_time() -> None:
    new = with_decision(summary(), 0, decided_ns=summary().ledger[0].decided_ns + 1)
    assert regress([summary()], [new], 0.5).outcome == FAILED


def test_cells_of_a_decision_are_work_and_not_time() -> None:
    new = with_decision(summary(), 0, cells=1001)
    assert compare(summary(), new).same


def test_a_handler_of_one_side_alone_is_a_change() -> None:
    fewer = replace(summary(), work=summary().work[:1])
    for sides in ((summary(), fewer), (fewer, summary())):
        (change,) = compare(*sides, tolerance=0.5).work
        assert change.name == "geographer's percept/departure"


def test_the_dearest_handler_is_the_cause() -> None:
    new = with_work(with_work(summary(), 0, cells=20_100), 1, cells=44_000)
    cause = regress([summary()], [new]).runs[0].cause
    assert cause == "geographer's percept/departure takes 10.00 % more cells for each message"


def test_other_times_with_the_same_work_are_an_order_or_a_wait() -> None:
    new = with_decision(summary(), 2, decided_ns=1)
    assert "every handler did the same work" in regress([summary()], [new]).runs[0].cause


def test_a_run_that_is_not_whole_gets_no_verdict() -> None:
    cut = replace(with_work(summary(), 0, cells=1), reasons=("the log is truncated",))
    for sides in ((summary(), cut), (cut, summary())):
        found = regress([sides[0]], [sides[1]])
        assert found.outcome == INCONCLUSIVE
        assert "the log is truncated" in found.runs[0].reasons[0]


def test_a_missing_run_leaves_it_open_but_a_failure_stands() -> None:
    both = [summary(seed=1), summary(seed=2)]
    found = regress(both, both[:1])
    assert (found.outcome, len(found.runs)) == (INCONCLUSIVE, 1)
    assert found.missing == ("two by two, seed 2, profile host: in BASE, but not in NEW",)
    assert regress(both[:1], both).outcome == INCONCLUSIVE
    assert regress(both, [with_work(both[0], 0, cells=1)]).outcome == FAILED


@pytest.mark.parametrize(
    "field, value, told",
    [
        ("profile", "huey-1990", "profile 'host' and 'huey-1990'"),
        ("made_from", "ffff", "hash 0123456789abcdef and ffff"),
    ],
)
def test_the_same_run_made_from_other_things_is_bad_input(
    field: str, value: str, told: str
) -> None:
    other = replace(summary(), identity=replace(summary().identity, **{field: value}))  # type: ignore[arg-type]
    with pytest.raises(MismatchError, match=told):
        match([summary()], [other])


def test_sides_without_a_common_run_are_bad_input() -> None:
    with pytest.raises(MismatchError, match="found no run that is on both sides"):
        match([summary(seed=1)], [summary(seed=2)])


def test_both_profiles_of_a_scenario_may_be_on_both_sides() -> None:
    host = summary()
    huey = replace(host, identity=replace(host.identity, profile="huey-1990"))
    assert len(match([host, huey], [huey, host]).pairs) == 2


def test_runs_of_a_side_must_agree() -> None:
    other = with_work(summary(), 1, cells=44_000)
    found = regress([summary()], [summary(), other])
    assert found.outcome == FAILED
    assert found.runs[0].cause.startswith("new does not repeat itself: geographer's")
    found = regress([summary(), other], [summary()])
    assert found.outcome == INCONCLUSIVE


TOML = 'about = "x"\nseed = 1\n[world]\nrows_m = [0.0]\n[compute]\nprofile = "host"\n'


def test_comments_seed_and_expectations_do_not_make_another_run() -> None:
    same = TOML.replace("seed = 1", "seed = 2 # two").replace('"x"', '"y"')
    same += "[[expect]]\nlate = 0\n"
    assert made_from(TOML, ()) == made_from(same, ("seed=3",))
    assert made_from(TOML, ('a.b="c"',)) == made_from(TOML, ("a.b=c",))


@pytest.mark.parametrize(
    "text, changes",
    [(TOML.replace("0.0", "0.5"), ()), (TOML, ("world.speed_m_s=1",)), ("no toml", ())],
)
def test_whatever_else_is_set_does(text: str, changes: tuple[str, ...]) -> None:
    assert made_from(TOML, ()) != made_from(text, changes)
