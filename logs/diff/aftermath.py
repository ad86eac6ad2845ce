"""What followed from the first difference: decisions, their slack, errands, the end."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from bus.messages import LedgerEntry, Message
from bus.wire import MessageId
from logs.chains import DecisionChain
from logs.decisions import NEVER, cause_of, on_time
from logs.diff.acts import flips
from logs.diff.shifts import Shift, shifts
from logs.reader import read_run
from logs.study import Study, study

_DECISIONS = ("decision/sensing", "decision/path", "decision/reaction")

Question = tuple[str, int, int]
"""What a decision is about: its kind, the visit, and which one of that kind at that visit."""


@dataclass(frozen=True)
class DecisionChange:
    """A decision that is not as it was; of ``base`` or ``new`` one is None if only one run has it.

    ``flips`` is where the choice is another, ``slack_ns`` by how much the slack grew (None if
    it did not come in both), ``shifts`` what made it so.
    """

    kind: str
    visit: int
    asked_ns: int
    base: str | None
    new: str | None
    flips: tuple[str, ...]
    slack_ns: int | None
    shifts: tuple[Shift, ...]


@dataclass(frozen=True)
class Ending:
    """How one run went as a whole; times in seconds."""

    ended: str
    duration_s: float
    errands: int
    errands_s: float
    decisions: int
    late: int
    idle_s: float


@dataclass(frozen=True)
class Aftermath:
    """What became of both runs: the decisions that changed, first asked first."""

    base: Ending
    new: Ending
    changes: tuple[DecisionChange, ...]

    @property
    def flipped(self) -> tuple[DecisionChange, ...]:
        """The decisions that chose differently."""
        return tuple(change for change in self.changes if change.flips)


@dataclass(frozen=True)
class _Decision:
    entry: LedgerEntry
    chain: DecisionChain | None
    message: Message | None


def aftermath(base: str | Path, new: str | Path) -> Aftermath:
    """Compare what two runs came to. Raises LogReadError."""
    studies = study(base), study(new)
    before, after = (_decisions(found) for found in studies)
    changes = [
        change
        for question in dict.fromkeys((*before, *after))
        if (change := _change(before.get(question), after.get(question))) is not None
    ]
    changes.sort(key=lambda change: (change.asked_ns, change.kind, change.visit))
    return Aftermath(_ending(studies[0]), _ending(studies[1]), tuple(changes))


def _ending(found: Study) -> Ending:
    analysis = found.analysis
    return Ending(
        analysis.ended or "no end",
        analysis.duration_s,
        analysis.errands.number,
        analysis.errands.time_s,
        len(found.ledger),
        len(analysis.late),
        sum(of.idle_s for of in analysis.decisions),
    )


def _decisions(found: Study) -> dict[Question, _Decision]:
    """The ledger by what each decision is about: numbers shift where one more is asked."""
    chains = {chain.decision: chain for chain in found.chains}
    said = _said(found.analysis.path)
    by_question: dict[Question, _Decision] = {}
    counts: dict[tuple[str, int], int] = {}
    for entry in sorted(found.ledger, key=lambda one: one.decision):
        place = entry.kind, entry.visit
        counts[place] = counts.get(place, 0) + 1
        chain = chains.get(entry.decision)
        message = said.get((chain.chain.source, chain.chain.sequence)) if chain else None
        by_question[*place, counts[place]] = _Decision(entry, chain, message)
    return by_question


def _said(path: str) -> dict[MessageId, Message]:
    with read_run(path, _DECISIONS) as reader:
        return {sent.id: sent.message for sent in reader}


def _change(base: _Decision | None, new: _Decision | None) -> DecisionChange | None:
    one = base or new
    assert one is not None
    words = [None if of is None else _words(of.entry) for of in (base, new)]
    chosen: tuple[str, ...] = ()
    slack_ns: int | None = None
    why: tuple[Shift, ...] = ()
    if base is not None and new is not None:
        if base.message is not None and new.message is not None:
            chosen = flips(base.message, new.message)
        slack_ns, why = _slack(base, new)
    if words[0] == words[1] and not chosen and not slack_ns:
        return None
    entry = one.entry
    return DecisionChange(
        entry.kind, entry.visit, entry.asked_ns, words[0], words[1], chosen, slack_ns, why
    )


def _slack(base: _Decision, new: _Decision) -> tuple[int | None, tuple[Shift, ...]]:
    if NEVER in (base.entry.decided_ns, new.entry.decided_ns):
        return None, ()
    change_ns = new.entry.slack_ns - base.entry.slack_ns
    if change_ns == 0 or base.chain is None or new.chain is None:
        return change_ns, ()
    return change_ns, shifts(base.chain, new.chain)


def _words(entry: LedgerEntry) -> str:
    if on_time(entry):
        return "in time"
    came = "never came" if entry.decided_ns == NEVER else "late"
    instead = f", {entry.instead} instead" if entry.instead else ""
    return f"{came}: {cause_of(entry)}{instead}"
