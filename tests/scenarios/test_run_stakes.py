"""Whole runs in which the decider says what a wrong type costs, and the classifier heeds it."""

from __future__ import annotations

import pytest

from bus.messages import (
    Arrival,
    AskedSensing,
    JunctionStakes,
    LedgerEntry,
    RunEnded,
    SensingDecision,
)
from bus.wire import Sent
from tests.scenarios.runs import everything_said, of_kind, shipped

Run = tuple[Sent, ...]


@pytest.fixture(scope="module")
def run() -> Run:
    return everything_said(shipped("aces", seed=1).scenario)


def test_stakes_are_there_when_sensing_begins(run: Run) -> None:
    said = {s.message.visit: s.said_ns for s in run if isinstance(s.message, JunctionStakes)}
    arrived = {s.message.visit: s.said_ns for s in run if isinstance(s.message, Arrival)}
    assert len(said) >= 9  # nine intersections, some more than once
    assert all(said[visit] < arrived[visit] for visit in said)


def test_what_was_decided_without_them_is_decided_again_in_time(run: Run) -> None:
    until_ns = {q.visit: q.until_ns for q in of_kind(run, AskedSensing) if not q.action}
    stakes = {s.message.visit: s.id for s in run if isinstance(s.message, JunctionStakes)}
    answers = [
        (s.message.visit, s)
        for s in run
        if isinstance(s.message, SensingDecision) and not s.message.action
    ]
    last = dict(answers)
    assert len(answers) == len(last) + len(stakes)
    for visit, stated in stakes.items():
        assert last[visit].parents[0] == stated
        assert last[visit].said_ns < until_ns[visit]
    assert not [entry for entry in of_kind(run, LedgerEntry) if entry.cause]
    assert of_kind(run, RunEnded)[-1].reason == "done"
