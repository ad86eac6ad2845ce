"""The cause of what differs between two runs, in one sentence."""

from __future__ import annotations

from logs.first_difference import FirstDifference
from logs.regress.compare import Comparison, WorkChange
from logs.regress.summary import Work
from logs.regress.words import decision_words, work_words

SAME = 1e-9
"""Ratios nearer to 1 than this are 1."""


def cause(found: Comparison, first: FirstDifference | None) -> str:
    """Why two runs differ, as far as is known.

    ``first`` is the first difference of their logs, None where one of them is a baseline: then
    only the ledger and the work by handler speak.
    """
    if first is not None:
        dearer = _changed_most(found.work, first.source) if first.kind == "cost" else None
        return f"{first.what}; in all, {_price(dearer)}" if dearer else first.what
    dearer = _changed_most(found.work, None) if _as_many(found.work) else None
    parts = [_price(dearer) if dearer else _count(found.work)]
    if found.ended:
        parts.append(f"the run: {found.ended[0]} -> {found.ended[1]}")
    if found.ledger:
        decision = f"the first decision that changed is {decision_words(found.ledger[0])}"
        parts.insert(1 if dearer else 0, decision)
    return "; ".join(parts)


def _as_many(changes: tuple[WorkChange, ...]) -> bool:
    """Whether every handler ran as often as before."""
    return all(c.base and c.new and c.base.times == c.new.times for c in changes)


def _changed_most(changes: tuple[WorkChange, ...], process: str | None) -> WorkChange | None:
    """The handler (of a process) whose work for one message changed most, if one's did."""
    ours = [c for c in changes if process in (None, (c.base or c.new or _NOBODY).process)]
    found = max(ours, key=_unlike, default=None)
    return found if found is not None and _unlike(found) > SAME else None


_NOBODY = Work("", "", 0, 0, 0)


def _unlike(change: WorkChange) -> float:
    return max(abs(ratio - 1.0) for ratio in _ratios(change))


def _ratios(change: WorkChange) -> tuple[float, float]:
    """Cells and simulated time for one message, new over base."""
    old, new = change.base, change.new
    if old is None or new is None or not old.times or not new.times:
        return (1.0, 1.0)
    fewer = old.times / new.times
    cells = new.cells / old.cells * fewer if old.cells else 1.0 + new.cells
    busy = new.busy_ns / old.busy_ns * fewer if old.busy_ns else 1.0 + new.busy_ns
    return (cells, busy)


def _price(change: WorkChange) -> str:
    """What one message costs now, in words."""
    cells, busy = _ratios(change)
    if abs(cells - 1.0) > SAME:
        return f"{change.name} takes {_more(cells)} cells for each message"
    return f"{change.name} takes {_more(busy)} time for the same cells: its price changed"


def _more(ratio: float) -> str:
    percent = abs(ratio - 1.0) * 100.0
    return f"{percent:.2f} % {'more' if ratio > 1.0 else 'less'}"


def _count(changes: tuple[WorkChange, ...]) -> str:
    """Where messages cost what they did, or other messages came: which handler shows it most."""
    if not changes:
        return "every handler did the same work, at other times: an order or a wait changed"
    most = max(changes, key=_missed)
    return f"not the same messages were handled, most of all {work_words(most)}"


def _missed(change: WorkChange) -> int:
    """How many messages more or fewer a handler ran for."""
    before, now = ((work.times if work else 0) for work in (change.base, change.new))
    return abs(now - before)
