"""How the slack of decisions is spread, and what stood still for want of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bus.messages import LedgerEntry
from logs.decisions import KINDS, NEVER, cause_of, on_time
from logs.spread import NS_PER_S

QUANTILES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)
BINS = 10


@dataclass(frozen=True)
class Slack:
    """The slack of one kind of decision, of those that came.

    ``quantiles_s`` are at :data:`QUANTILES`, each a slack that occurred; ``counts`` are those
    within ``edges_s`` (one more than counts), from the least to the greatest. ``idle_s`` has, by
    cause, how long the robot stood for want of these decisions.
    """

    kind: str
    number: int
    quantiles_s: tuple[float, ...]
    edges_s: tuple[float, ...]
    counts: tuple[int, ...]
    idle_s: dict[str, float]


def slack_of(ledger: list[LedgerEntry]) -> tuple[Slack, ...]:
    """One row a kind: those of the paper first, then any others in the order they appeared."""
    by_kind: dict[str, list[LedgerEntry]] = {kind: [] for kind in KINDS}
    for entry in ledger:
        by_kind.setdefault(entry.kind, []).append(entry)
    return tuple(_slack(kind, entries) for kind, entries in by_kind.items())


def _slack(kind: str, entries: list[LedgerEntry]) -> Slack:
    slack_s = np.array([e.slack_ns for e in entries if e.decided_ns != NEVER]) / NS_PER_S
    idle_ns: dict[str, int] = {}
    for entry in entries:
        if not on_time(entry):
            cause = cause_of(entry)
            idle_ns[cause] = idle_ns.get(cause, 0) + entry.idle_ns
    idle_s = {cause: ns / NS_PER_S for cause, ns in sorted(idle_ns.items())}
    if not len(slack_s):
        return Slack(kind, 0, (), (), (), idle_s)
    counts, edges_s = np.histogram(slack_s, BINS)
    quantiles_s = np.quantile(slack_s, QUANTILES, method="inverted_cdf")
    return Slack(
        kind,
        len(slack_s),
        tuple(quantiles_s.tolist()),
        tuple(edges_s.tolist()),
        tuple(counts.tolist()),
        idle_s,
    )
