"""Made-up runs to compare."""

from __future__ import annotations

from dataclasses import replace

import msgspec

from logs.regress.summary import Decision, Identity, Summary, Work

S = 10**9
IDENTITY = Identity("two by two", 7, "host", "0123456789abcdef")


def decision(number: int, *, slack_s: float = 5.0, cause: str = "") -> Decision:
    """A decision asked for at ``100 * number`` s with 30 s of time."""
    asked_ns, slack_ns = number * 100 * S, round(slack_s * S)
    until_ns = asked_ns + 30 * S
    return Decision(
        number,
        "path" if number % 2 else "sensing",
        number,
        asked_ns,
        until_ns,
        until_ns - slack_ns,
        slack_ns,
        1000,
        4,
        cause=cause,
    )


def summary(number: int = 4, *, seed: int = 7, where: str = "run.mcap") -> Summary:
    """A run with so many decisions."""
    return Summary(
        replace(IDENTITY, seed=seed),
        "done",
        1000 * S,
        (
            Work("reactor", "belief/ranges", 500, 20_000, 3_000_000),
            Work("geographer", "percept/departure", 10, 40_000, 4_000_000),
        ),
        tuple(decision(k) for k in range(1, number + 1)),
        where,
    )


def with_decision(run: Summary, at: int, **changes: object) -> Summary:
    """The run with one decision changed."""
    ledger = list(run.ledger)
    ledger[at] = msgspec.structs.replace(ledger[at], **changes)
    return replace(run, ledger=tuple(ledger))


def with_work(run: Summary, at: int, **changes: object) -> Summary:
    """The run with the work of one handler changed."""
    work = list(run.work)
    work[at] = msgspec.structs.replace(work[at], **changes)
    return replace(run, work=tuple(work))
