"""Naming a difference in a message that no handler is known for: of the world, of the clock."""

from __future__ import annotations

from logs.diff.case import Case, Named
from logs.diff.contents import FieldDifference, field_differences
from logs.diff.events import Event
from logs.diff.words import changes, duration, later


def name_message(case: Case) -> Named:
    """What differs about a message by itself."""
    event = case.event
    what = f"{event.topic} ({_which(event)})"
    if is_elsewhere(case):
        return Named("order", _overtaking(case, what))
    if event.topic == "health/state" and event.record.state == "down":
        run = "base" if case.in_base else "new"
        at = duration(event.said_ns)
        return Named(case.lacking, f"{event.process} went down at {at} in {run} only")
    twin = case.other.find(event.id)
    following = case.one.find((event.source, event.record.sequence + 1))
    skipped = following is not None and twin is not None and _same(following, twin)
    if twin is None or twin.topic != event.topic or skipped:
        run = "base" if case.in_base else "new"
        return Named(case.lacking, f"{what} was said in {run} only")
    pair = (event, twin) if case.in_base else (twin, event)
    return _changed(what, *pair)


def is_elsewhere(case: Case) -> bool:
    """Whether the other run says the same at that moment, before or after something else."""
    event = case.event
    return any(_same(event, other) for other in case.other.at(event.said_ns))


def _which(event: Event) -> str:
    message = f"message {event.record.sequence} of {event.source}"
    return message if event.process == event.source else f"{message}, about {event.process}"


def _overtaking(case: Case, what: str) -> str:
    first = case.other.own[0]
    run = "base" if case.in_base else "new"
    other = f"{first.topic} ({_which(first)})"
    return f"{what} comes before {other} in {run} only, said at the same moment: priorities differ"


def _same(one: Event, two: Event) -> bool:
    """Whether two messages say the same at the same time, whatever their numbers."""
    if (one.topic, one.said_ns, one.source) != (two.topic, two.said_ns, two.source):
        return False
    return not field_differences(one.sent(), two.sent())


def _changed(what: str, base: Event, new: Event) -> Named:
    """The same message with another content or at another time."""
    fields: tuple[FieldDifference, ...] = field_differences(base.sent(), new.sent())
    by_ns = new.said_ns - base.said_ns
    moved = f"came {later(by_ns)}, at {duration(new.said_ns)}" if by_ns else ""
    if not fields:
        return Named("time", f"{what} {moved}")
    also = f", and {moved}" if moved else ""
    return Named("content", f"{what} says something else: {changes(fields)}{also}", fields)
