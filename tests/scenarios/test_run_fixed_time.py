"""At the prices of 1990 the decider solves the largest problem that its time allows.

Under ``huey-1990`` a cell costs 0.948 ms and a belief update 2.09 s besides (the paper's
Table 1). What is decided by fixed-time procedures, the next feature and the path, must then
still come in time; a size that is forced comes when it comes.
"""

from __future__ import annotations

from typing import Any

import pytest

from bus.messages import (
    AskedPath,
    AskedSensing,
    LedgerEntry,
    PathDecision,
    SensingDecision,
    Span,
)
from bus.topics import DECIDER
from bus.wire import Sent
from scenarios.scenario import Scenario
from tests.scenarios.runs import Table, everything_said, of_kind, scenario_of, shipped

FIXED_TIME = ("path", "sensing")

SIXTEEN: Table = {
    "about": "all corridors of a 4 by 4 grid; the first drive leaves little time",
    "world": {
        "columns_m": [0.0, 20.0, 40.0, 60.0],
        "rows_m": [0.0, 20.0, 40.0, 60.0],
        # 52 s of driving, 44 of which the first belief about 16 junctions takes
        "start": {"junction": [1, 1], "heading": "S", "ahead_m": 4.42},
        "until_s": 4000,
    },
    "random_errands": {"count": 6, "expected_again": 3.0},
    "compute": {"profile": "huey-1990"},
    "modules": {"geographer": {"maps_per_type": 64}},
}
FORCED = {"modules__decider": {"hypotheses": 64}}


def late(said: tuple[Sent, ...]) -> list[LedgerEntry]:
    entries = of_kind(said, LedgerEntry)
    return [e for e in entries if e.kind in FIXED_TIME and e.cause]


def sixteen(seed: int, **changes: Any) -> Scenario:
    return scenario_of(SIXTEEN, seed=seed, **changes)


def aces(seed: int) -> Scenario:
    return shipped("aces", "compute.profile=huey-1990", seed=seed).scenario


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("building", [aces, sixteen])
def test_problems_are_chosen_that_can_be_solved_in_time(building: Any, seed: int) -> None:
    said = everything_said(building(seed))
    assert not late(said)
    decided = [e for e in of_kind(said, LedgerEntry) if e.kind in FIXED_TIME]
    assert len(decided) > 20
    assert all(e.cells > 0 and e.slack_ns >= 0 for e in decided)


@pytest.mark.parametrize("seed", [1, 2])
def test_a_problem_too_large_for_the_time_left_overruns(seed: int) -> None:
    said = everything_said(sixteen(seed, **FORCED, world__until_s=300))
    first = next(e for e in late(said) if e.visit == 0)
    assert (first.kind, first.cause) == ("path", "overrun")


@pytest.mark.parametrize("seed", [1, 2])
def test_with_little_time_fewer_hypotheses_are_weighed(seed: int) -> None:
    # 4 hypotheses for each of 8 junction types on the first, short drive; later many more
    said = everything_said(sixteen(seed, world__until_s=900))
    forced = everything_said(sixteen(seed, **FORCED, world__until_s=300))
    first, *rest = (decision.hypotheses for decision in of_kind(said, PathDecision))
    assert first <= 4 * 8
    assert of_kind(forced, PathDecision)[0].hypotheses > 4 * 8
    assert max(rest) > 4 * 8


def test_with_little_time_plans_of_fewer_tests_are_weighed() -> None:
    then, now = everything_said(aces(1)), everything_said(shipped("aces", seed=1).scenario)
    asked = {question.decision: question for question in of_kind(then, AskedSensing)}
    looked = {asked[d.decision]: d.look_ahead for d in of_kind(then, SensingDecision)}
    driving = {ahead for question, ahead in looked.items() if question.action == 0}
    testing = {ahead for question, ahead in looked.items() if question.action > 0}
    # Four minutes for one outcome, half a minute for four of them.
    assert max(driving) == 2
    assert testing == {1}
    assert {d.look_ahead for d in of_kind(now, SensingDecision)} == {3}


def test_a_decision_takes_what_its_cells_cost() -> None:
    said = everything_said(sixteen(1, world__until_s=900))
    until_ns = {question.visit: question.until_ns for question in of_kind(said, AskedPath)}
    spans = [s for s in of_kind(said, Span) if s.process == DECIDER and s.cells > 1]
    assert len(spans) == len(of_kind(said, PathDecision))
    for visit, span in enumerate(spans):
        # one cell is that of taking note of the message, which is free
        assert span.end_ns - span.start_ns == (span.cells - 1) * 948_000
        assert span.end_ns <= until_ns[visit]
