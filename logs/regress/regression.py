"""BASE against NEW: every run that is on both sides, in simulated time, work and wall time."""

from __future__ import annotations

import filecmp
from collections.abc import Sequence
from dataclasses import dataclass

from logs.first_difference import FirstDifference, first_difference
from logs.regress.cause import cause
from logs.regress.compare import Comparison, compare
from logs.regress.matching import Pair, match
from logs.regress.summary import Identity, Summary
from logs.regress.wall import (
    CANNOT_SAY,
    LEVEL,
    SLOWER,
    TOO_FEW,
    WallComparison,
    compare_wall,
    typical_work_s,
)

GOOD, FAILED, INCONCLUSIVE = "good", "failed", "inconclusive"


@dataclass(frozen=True)
class RunResult:
    """What became of one run. ``cause`` is one sentence, empty where nothing differs.

    ``reasons`` is why no verdict is honest. ``unsteady`` is what differs between runs of the new
    side that were made from the same. ``note`` says what differs in the logs though every
    decision and all work is the same. ``wall`` is None where there is nothing to look at.
    """

    identity: Identity
    comparison: Comparison
    reasons: tuple[str, ...]
    unsteady: str
    cause: str
    note: str
    wall: WallComparison | None

    @property
    def outcome(self) -> str:
        """What simulated time and work say."""
        if self.reasons:
            return INCONCLUSIVE
        return FAILED if self.cause else GOOD


@dataclass(frozen=True)
class Regression:
    """All of it. ``missing`` are runs that are on one side only."""

    runs: tuple[RunResult, ...]
    missing: tuple[str, ...]
    wall_blocks: bool

    @property
    def outcome(self) -> str:
        """Failed where something did; else inconclusive where something is; else good."""
        found = [run.outcome for run in self.runs]
        if self.wall_blocks:
            found += [wall_outcome(run.wall) for run in self.runs]
        if FAILED in found:
            return FAILED
        return INCONCLUSIVE if self.missing or INCONCLUSIVE in found else GOOD


def wall_outcome(wall: WallComparison | None) -> str:
    """What wall time says, if it is asked."""
    if wall is None or wall.verdict in (TOO_FEW, CANNOT_SAY):
        return INCONCLUSIVE
    return FAILED if wall.verdict == SLOWER else GOOD


def regress(
    base: Sequence[Summary], new: Sequence[Summary], tolerance: float = 0.0, *, wall: bool = False
) -> Regression:
    """Compare two sides. ``tolerance`` is that of work; ``wall`` lets wall time fail, too.

    Raises MismatchError where the sides are not about the same runs, LogReadError.
    """
    matched = match(base, new)
    level = LEVEL / len(matched.pairs)  # as many chances of a false alarm as there are tests
    runs = tuple(_result(pair, tolerance, level) for pair in matched.pairs)
    return Regression(runs, matched.missing, wall)


def _result(pair: Pair, tolerance: float, level: float) -> RunResult:
    base, new = pair.base[0], pair.new[0]
    reasons = tuple(
        f"{run.where}: {reason}" for run in (*pair.base, *pair.new) for reason in run.reasons
    )
    comparison = compare(base, new, tolerance)
    unsteady = why = note = ""
    if not reasons:
        unsteady = _unsteady(pair.base)
        if unsteady:
            reasons = (f"base does not repeat itself: {unsteady}",)
    if not reasons:
        unsteady = _unsteady(pair.new)
        if unsteady:
            why = f"new does not repeat itself: {unsteady}"
        elif not comparison.same:
            why = cause(comparison, _first(base, new))
        else:
            note = _said_otherwise(base, new)
    wall = _wall(pair, level)
    return RunResult(pair.identity, comparison, reasons, unsteady, why, note, wall)


def _unsteady(runs: Sequence[Summary]) -> str:
    """What differs between runs of one side, which were all made from the same."""
    for again in runs[1:]:
        found = compare(runs[0], again)
        if not found.same:
            return cause(found, _first(runs[0], again))
    return ""


def _first(base: Summary, new: Summary) -> FirstDifference | None:
    if base.log is None or new.log is None:
        return None
    return first_difference(base.log, new.log)


def _said_otherwise(base: Summary, new: Summary) -> str:
    """What differs between logs whose decisions and work are the same."""
    if base.log is None or new.log is None or filecmp.cmp(base.log, new.log, shallow=False):
        return ""
    first = first_difference(base.log, new.log)
    return "" if first is None else first.what


def _wall(pair: Pair, level: float) -> WallComparison | None:
    sides = [[run.log for run in side if run.log is not None] for side in (pair.base, pair.new)]
    if not all(sides):
        return None
    found = [[typical_work_s(log) for log in side] for side in sides]
    base_s, new_s = ([took_s for took_s in side if took_s is not None] for side in found)
    return compare_wall(base_s, new_s, level) if base_s and new_s else None
