"""Deadlines fire as events, and every decision that was missed or made leaves its entry."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest
import simpy
from hypothesis import given
from hypothesis import strategies as st

from bus.coordinator import Handled
from bus.messages import DeadlineMissed, LedgerEntry, Message
from simworld.deadlines import Deadlines
from simworld.instants import GRANTS, call_at

ODD_NS = 240_000_000_007


@dataclass
class Desk:
    """An environment with its deadlines, and all that came of them."""

    why: str = "late input"
    env: simpy.Environment = field(default_factory=lambda: simpy.Environment(initial_time=0))
    said: list[tuple[int, Message]] = field(default_factory=list)
    missed: list[tuple[int, str, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.deadlines = Deadlines(
            self.env,
            lambda message: self.said.append((int(self.env.now), message)),
            lambda _: self.why,
            lambda process, cause: self.missed.append((int(self.env.now), process, cause)),
        )

    def at(self, at_ns: int, decision: int, by: Handled | None, since_ns: int | None) -> None:
        """Have a decision heard at a time, as the clock's grants do it."""
        call_at(
            self.env,
            at_ns,
            GRANTS,
            lambda _: self.deadlines.decided(decision, by, 4, since_ns),
            None,
        )

    @property
    def entry(self) -> LedgerEntry:
        (entry,) = [m for _, m in self.said if isinstance(m, LedgerEntry)]
        return entry


def handler(start_ns: int, end_ns: int = 0) -> Handled:
    return Handled("asked/path", "world", 3, start_ns, end_ns, 77)


def test_a_miss_fires_at_its_deadline_though_nothing_else_happens() -> None:
    desk = Desk()
    decision = desk.deadlines.ask("path", 6, ODD_NS)
    desk.env.run()
    assert desk.env.now == ODD_NS
    assert desk.said == [(ODD_NS, DeadlineMissed(decision, "path", ODD_NS))]
    assert desk.missed == [(ODD_NS, "decider", "late input")]
    assert desk.deadlines.late == {"sensing": 0, "path": 1, "reaction": 0}
    assert desk.deadlines.open(decision), "it is still waited for"


def test_in_time_there_is_no_miss() -> None:
    desk = Desk()
    decision = desk.deadlines.ask("path", 6, ODD_NS)
    desk.at(ODD_NS - 1, decision, handler(5), None)
    desk.env.run()
    assert desk.entry == LedgerEntry(
        decision, "path", 6, 0, ODD_NS, ODD_NS - 1, 1, 77, 4, 0, "", ""
    )
    assert len(desk.said) == 1
    assert desk.missed == []
    assert desk.deadlines.on_time["path"] == 1
    assert not desk.deadlines.open(decision)


def test_heard_at_the_very_deadline_is_in_time() -> None:
    desk = Desk()
    decision = desk.deadlines.ask("path", 6, ODD_NS)
    desk.at(ODD_NS, decision, handler(5), ODD_NS)
    desk.env.run()
    assert (desk.entry.slack_ns, desk.entry.idle_ns, desk.entry.cause) == (0, 0, "")
    assert desk.missed == []
    assert (desk.deadlines.on_time["path"], desk.deadlines.late["path"]) == (1, 0)


def test_a_nanosecond_later_is_late() -> None:
    desk = Desk()
    decision = desk.deadlines.ask("path", 6, ODD_NS)
    desk.at(ODD_NS + 1, decision, handler(5), ODD_NS)
    desk.env.run()
    assert (desk.entry.slack_ns, desk.entry.idle_ns, desk.entry.cause) == (-1, 1, "overrun")
    assert desk.entry.instead == "stood and waited"
    assert [at_ns for at_ns, _, _ in desk.missed] == [ODD_NS]
    assert (desk.deadlines.on_time["path"], desk.deadlines.late["path"]) == (0, 1)


@given(st.integers(0, 50), st.integers(0, 50), st.integers(1, 100), st.integers(0, 100))
def test_slack_and_miss_agree(asked: int, until: int, takes: int, stood: int) -> None:
    desk = Desk()
    found: list[int] = []

    def ask() -> simpy.events.ProcessGenerator:
        yield desk.env.timeout(asked)
        found.append(desk.deadlines.ask("sensing", 0, until))
        desk.at(asked + takes, found[0], None, stood)

    desk.env.process(ask())
    desk.env.run()
    late = asked + takes > until
    assert (desk.entry.slack_ns < 0) == bool(desk.missed) == bool(desk.entry.cause) == late
    assert desk.entry.slack_ns == until - (asked + takes)
    assert desk.entry.idle_ns == max(0, asked + takes - max(until, stood))
    if late:
        assert desk.missed[0][0] == max(until, asked), "never before it was asked"


@pytest.mark.parametrize("why", ["late input", "overrun", "process down"])
def test_the_cause_is_that_of_the_moment_of_the_miss(why: str) -> None:
    desk = Desk(why)
    decision = desk.deadlines.ask("reaction", 0, 100)
    desk.at(150, decision, handler(start_ns=100), None)
    desk.env.run()
    assert desk.entry.cause == why
    assert desk.missed == [(100, "reactor", why)]


def test_an_answer_begun_in_time_was_an_overrun() -> None:
    """At the deadline it was on its way, so nobody was computing: still no late input."""
    desk = Desk("late input")
    decision = desk.deadlines.ask("path", 0, 100)
    desk.at(150, decision, handler(start_ns=99), None)
    desk.env.run()
    assert desk.entry.cause == "overrun"


def test_what_is_decided_twice_leaves_one_entry() -> None:
    desk = Desk()
    decision = desk.deadlines.ask("path", 0, 100)
    desk.at(50, decision, handler(5), None)
    desk.at(60, decision, handler(5), None)
    desk.env.run()
    assert desk.entry.decided_ns == 50


def test_what_is_needed_no_more_leaves_an_entry_only_if_it_was_missed() -> None:
    desk = Desk()
    first = desk.deadlines.ask("reaction", 1, 100)
    second = desk.deadlines.ask("reaction", 2, 200)
    desk.env.run(until=150)
    desk.deadlines.dropped(first)
    desk.deadlines.dropped(second)
    desk.env.run()
    assert (desk.entry.decision, desk.entry.decided_ns) == (first, -1)
    assert desk.entry.slack_ns == 100 - 150
    assert len(desk.missed) == 1


def test_at_the_end_what_was_missed_and_never_came_gets_its_entry() -> None:
    desk = Desk()
    missed = desk.deadlines.ask("path", 1, 100)
    desk.deadlines.ask("path", 2, 300)
    desk.env.run(until=250)
    desk.deadlines.close_all(stands_since_ns=120)
    assert desk.entry == LedgerEntry(
        missed, "path", 1, 0, 100, -1, -150, 0, 0, 130, "stood and waited", "late input"
    )


def test_at_the_end_what_can_never_come_gets_its_entry_before_its_deadline() -> None:
    desk = Desk("process down")
    decision = desk.deadlines.ask("path", 1, 300)
    desk.env.run(until=250)
    desk.deadlines.close_all(None)
    assert (desk.entry.decision, desk.entry.cause) == (decision, "process down")
    assert desk.entry.idle_ns == 0
