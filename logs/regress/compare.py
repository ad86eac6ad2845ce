"""Two runs that were made from the same: their ledgers and their work, number by number."""

from __future__ import annotations

from dataclasses import dataclass

import msgspec

from logs.regress.summary import Decision, Summary, Work


@dataclass(frozen=True)
class DecisionChange:
    """A decision that is not the same: None where a run does not have it."""

    base: Decision | None
    new: Decision | None

    @property
    def asked_ns(self) -> int:
        """When it was asked for, by the first of the two."""
        return min(one.asked_ns for one in (self.base, self.new) if one is not None)

    @property
    def became_late(self) -> bool:
        """Whether it is late now and was not, or was not there."""
        was = self.base is not None and self.base.late
        return self.new is not None and self.new.late and not was


@dataclass(frozen=True)
class WorkChange:
    """A handler whose work is not the same: None where a run does not have it."""

    base: Work | None
    new: Work | None

    @property
    def name(self) -> str:
        """The handler's name."""
        one = self.new or self.base
        assert one is not None
        return one.name


@dataclass(frozen=True)
class Comparison:
    """What differs: ``ended`` has both ends of the run in words, where they differ."""

    ended: tuple[str, str] | None
    ledger: tuple[DecisionChange, ...]
    work: tuple[WorkChange, ...]

    @property
    def same_time(self) -> bool:
        """Whether simulated time is the same."""
        return self.ended is None and not self.ledger

    @property
    def same(self) -> bool:
        """Whether nothing differs."""
        return self.same_time and not self.work


def compare(base: Summary, new: Summary, tolerance: float = 0.0) -> Comparison:
    """Compare two runs. ``tolerance`` is the share by which work may differ, 0.005 say."""
    ends = _ended(base), _ended(new)
    return Comparison(
        ended=None if ends[0] == ends[1] else ends,
        ledger=_ledger(base, new),
        work=_work(base, new, tolerance),
    )


def _ended(run: Summary) -> str:
    return f"{run.ended or 'no end'} after {run.duration_ns / 1e9:.9f} s"


def _ledger(base: Summary, new: Summary) -> tuple[DecisionChange, ...]:
    """The decisions that differ, first asked first; their cells are a matter of work."""
    sides = [{entry.decision: entry for entry in run.ledger} for run in (base, new)]
    changes = [
        DecisionChange(sides[0].get(number), sides[1].get(number))
        for number in sorted(sides[0].keys() | sides[1].keys())
        if _timing(sides[0].get(number)) != _timing(sides[1].get(number))
    ]
    return tuple(sorted(changes, key=lambda change: change.asked_ns))


def _timing(entry: Decision | None) -> Decision | None:
    return None if entry is None else msgspec.structs.replace(entry, cells=0)


def _work(base: Summary, new: Summary, tolerance: float) -> tuple[WorkChange, ...]:
    sides = [{(work.process, work.topic): work for work in run.work} for run in (base, new)]
    both = dict.fromkeys((*sides[0], *sides[1]))  # in the order of the processes
    changes = [WorkChange(sides[0].get(of), sides[1].get(of)) for of in both]
    return tuple(change for change in changes if not _alike(change, tolerance))


def _alike(change: WorkChange, tolerance: float) -> bool:
    if change.base is None or change.new is None:
        return False
    numbers = [(work.times, work.cells, work.busy_ns) for work in (change.base, change.new)]
    return all(abs(b - a) <= tolerance * a for a, b in zip(*numbers, strict=True))
