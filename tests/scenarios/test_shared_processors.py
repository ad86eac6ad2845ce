"""Modules that share processors wait for them, the reactor first in the queue."""

from __future__ import annotations

import pytest

from bus.messages import LedgerEntry, Span
from bus.topics import REACTOR, WORLD
from bus.wire import Sent
from tests.scenarios.runs import everything_said, of_kind, shipped

UNTIL = ("compute.profile=huey-1990", "world.until_s=560")


def a_run(processors: str) -> tuple[Sent, ...]:
    changes = (*UNTIL, f"compute.processors={processors}")
    return everything_said(shipped("aces", *changes, seed=1).scenario)


def most_at_once(said: tuple[Sent, ...]) -> int:
    """The most modules that computed at the same time."""
    spans = [s for s in of_kind(said, Span) if s.process != WORLD and s.end_ns > s.start_ns]
    edges = sorted([(s.start_ns, 1) for s in spans] + [(s.end_ns, -1) for s in spans])
    running = most = 0
    for _, change in edges:
        running += change
        most = max(most, running)
    return most


def waits_s(said: tuple[Sent, ...]) -> float:
    """The longest that something said to the reactor waited to be handled."""
    said_ns = {sent.id: sent.said_ns for sent in said}
    spans = [s for s in of_kind(said, Span) if s.process == REACTOR]
    return max(s.start_ns - said_ns[s.source, s.sequence] for s in spans) / 1e9


@pytest.mark.parametrize(("processors", "most"), [("1", 1), ("2", 2)])
def test_no_more_modules_compute_at_once_than_there_are_processors(
    processors: str, most: int
) -> None:
    assert most_at_once(a_run(processors)) == most


def test_with_one_processor_the_reactor_waits_for_the_others_handlers() -> None:
    # The first belief update and the first feature; what has begun is not interrupted.
    one, each = a_run("1"), a_run('"one each"')
    assert waits_s(one) > 3.0
    assert waits_s(each) < 0.5
    late = [e for e in of_kind(each, LedgerEntry) if e.cause]
    assert not late
