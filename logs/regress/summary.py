"""What is compared of one run: what it was made from, its ledger, its work by handler."""

from __future__ import annotations

import hashlib
import json
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import msgspec

from bus.messages import LedgerEntry
from bus.topics import PRIORITY
from logs.loads import SpanRow
from logs.reader import LogReadError, read_run
from logs.study import study

PROFILE = "profile"
"""Metadata of a log: the compute profile of its run."""

NO_PART = ("seed", "about", "expect")
"""Keys of a scenario that do not make a run another one, or are named beside it."""


@dataclass(frozen=True, order=True)
class Identity:
    """What a run was made from: equal ones must give equal runs.

    ``made_from`` is a hash of the scenario and of the changes made to it, without what is in
    :data:`NO_PART`; comments and the order of keys do not matter.
    """

    scenario: str
    seed: int
    profile: str
    made_from: str

    def __str__(self) -> str:
        return f"{self.scenario}, seed {self.seed}, profile {self.profile}"


class Work(msgspec.Struct, frozen=True, tag_field="line", tag="work", forbid_unknown_fields=True):
    """One handler of a run: what a process did with all messages of a topic, ``times`` of them.

    ``cells`` is the work that it reported, ``busy_ns`` what that cost in simulated time.
    """

    process: str
    topic: str
    times: int
    cells: int
    busy_ns: int

    @property
    def name(self) -> str:
        """The handler's name."""
        return f"{self.process}'s {self.topic}"


class Decision(
    msgspec.Struct,
    frozen=True,
    omit_defaults=True,
    tag_field="line",
    tag="decision",
    forbid_unknown_fields=True,
):
    """One decision of the ledger, as :class:`bus.messages.LedgerEntry` has it."""

    decision: int
    kind: str
    visit: int
    asked_ns: int
    until_ns: int
    decided_ns: int
    slack_ns: int
    cells: int
    size: int
    idle_ns: int = 0
    instead: str = ""
    cause: str = ""

    @property
    def late(self) -> bool:
        """Whether it came after its deadline, or never."""
        return self.decided_ns < 0 or self.slack_ns < 0


@dataclass(frozen=True)
class Summary:
    """One run. ``log`` is its log, None for a baseline; ``where`` names either.

    ``reasons`` is why no verdict on it is honest: empty for a whole run.
    """

    identity: Identity
    ended: str
    duration_ns: int
    work: tuple[Work, ...]
    ledger: tuple[Decision, ...]
    where: str
    log: Path | None = None
    reasons: tuple[str, ...] = ()

    @property
    def simulated(self) -> tuple[object, ...]:
        """All that must be equal where a run is repeated."""
        return (self.ended, self.duration_ns, self.work, self.ledger)


def summarise(log: Path) -> Summary:
    """Sum up the log of a run. Raises LogReadError."""
    gathered: dict[tuple[str, str], list[int]] = {}

    def on_span(span: SpanRow) -> None:
        of = gathered.setdefault((span.process, span.topic), [0, 0, 0])
        of[0] += 1
        of[1] += span.cells
        of[2] += span.end_ns - span.start_ns

    found = study(log, on_span)
    analysis = found.analysis
    work = [Work(process, topic, *sums) for (process, topic), sums in gathered.items()]
    return Summary(
        identity=identity_of(log),
        ended=analysis.ended,
        duration_ns=round(analysis.duration_s * 1e9),
        work=tuple(sorted(work, key=_place)),
        ledger=tuple(_decision(entry) for entry in found.ledger),
        where=str(log),
        log=log,
        reasons=analysis.reasons,
    )


def _place(work: Work) -> tuple[int, str, str]:
    return (PRIORITY.get(work.process, len(PRIORITY)), work.process, work.topic)


def _decision(entry: LedgerEntry) -> Decision:
    fields = msgspec.structs.asdict(entry)
    return Decision(**fields)


def identity_of(log: Path) -> Identity:
    """What the run of a log was made from. Raises LogReadError where it does not say so."""
    with read_run(log) as reader:
        metadata, attachments = reader.metadata, reader.attachments
    name, seed = metadata.get("scenario", ""), metadata.get("seed", "")
    if not name or not seed.isdecimal():
        raise LogReadError(
            f"{log}: metadata scenario and seed: found {name!r} and {seed!r}, "
            f"expected a name and a number"
        )
    changes = tuple(metadata.get("changes", "").splitlines())
    text = attachments.get("scenario.toml", b"").decode(errors="replace")
    return Identity(name, int(seed), metadata.get(PROFILE, "unknown"), made_from(text, changes))


def made_from(scenario: str, changes: Sequence[str]) -> str:
    """The hash of a scenario file's text and the changes to it. Text that is no TOML counts."""
    try:
        table: object = {
            key: value for key, value in tomllib.loads(scenario).items() if key not in NO_PART
        }
    except tomllib.TOMLDecodeError:
        table = scenario
    kept = [(key, value) for key, value in map(_change, changes) if key not in NO_PART]
    plain = json.dumps([table, kept], sort_keys=True, default=str)
    return hashlib.sha256(plain.encode()).hexdigest()[:16]


def _change(change: str) -> tuple[str, object]:
    """A KEY=VALUE as key and value; what is no TOML is a string, as on the command line."""
    key, _, text = change.partition("=")
    try:
        return key.strip(), tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return key.strip(), text
