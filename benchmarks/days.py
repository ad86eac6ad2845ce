"""Whole runs in this process, summed up: what their ledgers say of time.

Everything is simulated time, so the numbers repeat on any machine.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from bus.messages import LedgerEntry, PathDecision, RunEnded, Span, TrueEncounter, TrueErrand
from bus.turns import Module
from bus.wire import Sent
from scenarios.draw import draw
from scenarios.in_process import run_in_process
from scenarios.modules import build_module
from scenarios.scenario import Scenario, find, load

KINDS = ("sensing", "path", "reaction")


@dataclass(frozen=True)
class Day:
    """One run: its ledger and what came of it."""

    ended: str
    seconds: float
    ledger: tuple[LedgerEntry, ...]
    errands: tuple[TrueErrand, ...]
    encounters: tuple[TrueEncounter, ...]
    hypotheses: tuple[int, ...]
    busy_s: dict[str, float]

    def of(self, kind: str) -> list[LedgerEntry]:
        """The decisions of one kind."""
        return [entry for entry in self.ledger if entry.kind == kind]

    def late(self, kind: str) -> int:
        """How many decisions of a kind missed their deadline."""
        return sum(bool(entry.cause) for entry in self.of(kind))

    def idle_s(self, kind: str | None = None) -> float:
        """Seconds the robot stood and waited for decisions of a kind, or of any."""
        entries = self.ledger if kind is None else self.of(kind)
        return sum(entry.idle_ns for entry in entries) / 1e9

    @property
    def collisions(self) -> int:
        """Encounters that ended in touching."""
        return sum(met.collided for met in self.encounters)

    @property
    def errand_s(self) -> float:
        """Seconds until the last errand was done; nan if none was."""
        return self.errands[-1].ended_ns / 1e9 if self.errands else float("nan")


def scenario_of(name: str, changes: Sequence[str] = (), seed: int | None = None) -> Scenario:
    """A shipped scenario, changed as on the command line. Raises ScenarioError."""
    return load(find(name), changes, seed)


def day(scenario: Scenario, build: Callable[..., Module] = build_module) -> Day:
    """Run a scenario from beginning to end in this process."""
    said: list[Sent] = []
    run_in_process(scenario, draw(scenario, "a benchmark"), said.append, build)
    return summed_up(said)


def summed_up(said: Sequence[Sent]) -> Day:
    """A run's messages as a day."""
    messages = [sent.message for sent in said]
    spans = [m for m in messages if isinstance(m, Span)]
    busy: dict[str, float] = {}
    for span in spans:
        busy[span.process] = busy.get(span.process, 0.0) + (span.end_ns - span.start_ns) / 1e9
    (end,) = (sent for sent in said if isinstance(sent.message, RunEnded))
    assert isinstance(end.message, RunEnded)
    return Day(
        end.message.reason,
        end.said_ns / 1e9,
        tuple(m for m in messages if isinstance(m, LedgerEntry)),
        tuple(m for m in messages if isinstance(m, TrueErrand)),
        tuple(m for m in messages if isinstance(m, TrueEncounter)),
        tuple(m.hypotheses for m in messages if isinstance(m, PathDecision)),
        busy,
    )


@dataclass
class Progress:
    """A line on standard error that says how far a long work is."""

    total: int
    done: int = 0

    def step(self, what: str) -> None:
        """One more is done."""
        self.done += 1
        if sys.stderr.isatty():
            end = "\n" if self.done == self.total else ""
            print(f"\r{self.done}/{self.total} {what:<40}", end=end, file=sys.stderr, flush=True)


def seeds_of(text: str) -> range:
    """``A:B`` as the seeds from A to B."""
    first, _, last = text.partition(":")
    return range(int(first), int(last or first) + 1)
