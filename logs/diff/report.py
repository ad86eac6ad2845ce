"""A comparison as text in the terminal."""

from __future__ import annotations

from collections.abc import Iterator

from logs.diff.aftermath import Aftermath, DecisionChange, Ending
from logs.diff.contents import FieldDifference
from logs.diff.found import FirstDifference
from logs.diff.shifts import ANOTHER_WAY, AVAILABLE, Shift
from logs.diff.words import duration

LISTED = 10
"""So many changed decisions are listed; --json has all."""

PARTS_LISTED = 3


def setting_lines(settings: tuple[FieldDifference, ...]) -> Iterator[str]:
    """What the two runs were made from, where that differs."""
    if settings:
        yield "made from other things:"
    for one in settings:
        yield f"  {one}"


def first_lines(first: FirstDifference) -> Iterator[str]:
    """The first difference, and what went into it."""
    yield f"  {first.kind}: {first.what}"
    for heard in first.heard:
        which = f"{heard.topic} (message {heard.sequence} of {heard.source})"
        equal = "equal in both" if heard.equal else "not so in both"
        yield f"    heard {which}, said at {duration(heard.said_ns)}: {equal}"


def aftermath_lines(found: Aftermath) -> Iterator[str]:
    """What followed: the decisions that changed, the errands, the end."""
    yield "what followed:"
    yield f"  base: {_ending(found.base)}"
    yield f"  new:  {_ending(found.new)}"
    changed, flipped = len(found.changes), len(found.flipped)
    yield f"  decisions that changed: {changed}, that chose otherwise: {flipped}"
    for change in sorted(found.changes, key=_only_slack)[:LISTED]:
        yield from _change(change)
    if len(found.changes) > LISTED:
        yield f"  and {len(found.changes) - LISTED} more, see --json"


def _ending(one: Ending) -> str:
    return (
        f"{one.ended} after {one.duration_s:,.3f} s, {one.errands} errands in {one.errands_s:,.3f} "
        f"s, {one.decisions} decisions, {one.late} late, stood {one.idle_s:,.3f} s"
    )


def _only_slack(change: DecisionChange) -> bool:
    """Whether neither the choice nor the verdict is another: such a change is listed last."""
    return not change.flips and change.base == change.new


def _change(change: DecisionChange) -> Iterator[str]:
    words = [f"asked at {change.asked_ns / 1e9:,.3f} s"]
    if change.base is None or change.new is None:
        words.append(f"in new only, {change.new}" if change.new else f"in base only, {change.base}")
    elif change.base != change.new:
        words.append(f"{change.base} -> {change.new}")
    if change.slack_ns:
        words.append(f"slack {_signed(change.slack_ns)}")
    yield f"  {change.kind}, visit {change.visit}: {'; '.join(words)}"
    if change.flips:
        more = len(change.flips) - PARTS_LISTED
        shown = ", ".join(change.flips[:PARTS_LISTED])
        yield f"    chose {shown}{f' and {more} more' if more > 0 else ''}"
    if change.shifts:
        yield f"    by {', '.join(map(_shift, change.shifts[:PARTS_LISTED]))}"


def _shift(shift: Shift) -> str:
    change = _signed(shift.change_ns)
    if shift.part == AVAILABLE:
        return f"{AVAILABLE} {change}"
    if shift.part == ANOTHER_WAY:
        return f"coming another way {change} ({shift.topic})"
    return f"{shift.part} of {shift.topic} in {shift.process} {change}"


def _signed(time_ns: int) -> str:
    return f"{'+' if time_ns >= 0 else '-'}{duration(abs(time_ns))}"
