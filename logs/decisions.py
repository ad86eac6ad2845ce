"""The deadline ledger of a run, summed up: which decisions came in time, and which did not.

A decision is on time if it was heard by its deadline: it has a decision time and its slack is
not negative. Huey's three kinds of decision and the time each has are in the paper, section 5.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import median

from bus.messages import LedgerEntry

KINDS = ("sensing", "path", "reaction")
NEVER = -1
"""``decided_ns`` of a decision that never came."""

UNKNOWN_CAUSE = "unknown"
NS_PER_S = 1e9


@dataclass(frozen=True)
class Decisions:
    """All decisions of one kind. The slack is of those that came; None if none did.

    ``never`` of the ``late`` ones did not come at all. ``unsettled`` ones were asked for and
    have no ledger entry, because the run ended first.
    """

    kind: str
    asked: int
    on_time: int
    late: int
    never: int
    unsettled: int
    slack_min_s: float | None
    slack_median_s: float | None
    slack_max_s: float | None
    idle_s: float
    causes: dict[str, int]


@dataclass(frozen=True)
class LateDecision:
    """One missed deadline: when, by how much, what was used instead, and why."""

    decision: int
    kind: str
    visit: int
    asked_s: float
    until_s: float
    decided_s: float | None
    slack_s: float | None
    cells: int
    size: int
    idle_s: float
    instead: str
    cause: str


def on_time(entry: LedgerEntry) -> bool:
    """Whether a decision was heard by its deadline."""
    return entry.decided_ns != NEVER and entry.slack_ns >= 0


def cause_of(entry: LedgerEntry) -> str:
    """Why a late decision was late; a late one always has a cause."""
    return entry.cause or UNKNOWN_CAUSE


def late_decision(entry: LedgerEntry) -> LateDecision:
    """A late ledger entry in seconds."""
    came = entry.decided_ns != NEVER
    return LateDecision(
        entry.decision,
        entry.kind,
        entry.visit,
        entry.asked_ns / NS_PER_S,
        entry.until_ns / NS_PER_S,
        entry.decided_ns / NS_PER_S if came else None,
        entry.slack_ns / NS_PER_S if came else None,
        entry.cells,
        entry.size,
        entry.idle_ns / NS_PER_S,
        entry.instead,
        cause_of(entry),
    )


def summarise(
    entries: list[LedgerEntry], asked: dict[tuple[str, int], None]
) -> tuple[Decisions, ...]:
    """One row a kind: the three of the paper, then any others in the order they appeared.

    ``asked`` holds (kind, number) of every decision that was asked for.
    """
    by_kind: dict[str, list[LedgerEntry]] = {kind: [] for kind in KINDS}
    for entry in entries:
        by_kind.setdefault(entry.kind, []).append(entry)
    settled = {(entry.kind, entry.decision) for entry in entries}
    open_kinds = [key[0] for key in asked if key not in settled]
    return tuple(_row(kind, of, open_kinds.count(kind)) for kind, of in by_kind.items())


def _row(kind: str, entries: list[LedgerEntry], unsettled: int) -> Decisions:
    late = [entry for entry in entries if not on_time(entry)]
    slacks = [entry.slack_ns for entry in entries if entry.decided_ns != NEVER]
    causes: dict[str, int] = {}
    for entry in late:
        causes[cause_of(entry)] = causes.get(cause_of(entry), 0) + 1
    return Decisions(
        kind=kind,
        asked=len(entries),
        on_time=len(entries) - len(late),
        late=len(late),
        never=sum(entry.decided_ns == NEVER for entry in entries),
        unsettled=unsettled,
        slack_min_s=min(slacks) / NS_PER_S if slacks else None,
        slack_median_s=median(slacks) / NS_PER_S if slacks else None,
        slack_max_s=max(slacks) / NS_PER_S if slacks else None,
        idle_s=sum(entry.idle_ns for entry in entries) / NS_PER_S,
        causes=dict(sorted(causes.items())),
    )
