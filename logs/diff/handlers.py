"""Naming a difference in what a handler did: what it handled, when, what it said, its cost."""

from __future__ import annotations

from bus.wire import MessageId
from logs.diff.case import Case, Named
from logs.diff.contents import FieldDifference, field_differences
from logs.diff.found import Kind
from logs.diff.telling import Handling, Telling
from logs.diff.words import changes, duration, later


def name_handler(case: Case, process: str, about: MessageId) -> Named | None:
    """What differs in how a process handled a message; None if that is not known."""
    in_base = case.base.handling(process, about)
    in_new = case.new.handling(process, about)
    if in_base is None or in_new is None:
        return _handled_once(case, process, about, in_base, in_new)
    return (
        _other_order(case, process, about)
        or _taken_up(case, in_base, in_new)
        or _other_said(case, in_base, in_new)
        or _other_cost(case, in_base, in_new)
    )


def _handled_once(
    case: Case, process: str, about: MessageId, in_base: Handling | None, in_new: Handling | None
) -> Named | None:
    """A message that one run's process handled and the other's did not."""
    if in_base is None and in_new is None:
        return None
    other = case.base if in_base is None else case.new
    kind: Kind = "missing" if in_new is None else "extra"
    run = "new" if in_new is None else "base"
    what = f"{process} did not handle {case.message(about)} in {run}"
    down_ns = other.down_ns(process)
    if down_ns is not None:
        return Named(kind, f"{what}: it was down from {duration(down_ns)} on")
    if any(event.process == process for event in other.own):
        return Named(kind, what)
    end_ns = other.own[-1].said_ns if other.own else case.event.said_ns
    return Named(kind, f"{what} by {duration(end_ns)}, where what is known of it ends")


def _other_order(case: Case, process: str, about: MessageId) -> Named | None:
    """Whether the process handled other messages before this one, or the same in another order."""
    before = [up_to(of, process, about) for of in (case.base, case.new)]
    pairs = zip(*before, strict=False)
    first = next(((one, two) for one, two in pairs if one != two), None)
    if first is None:
        return None
    in_base, in_new = first
    if in_base not in case.new.handled(process):
        what = f"{process} did not handle {case.message(in_base)} in new"
        return Named("missing", what)
    if in_new not in case.base.handled(process):
        return Named("extra", f"{process} handled {case.message(in_new)}, too, in new")
    what = f"{process} handled {case.message(in_new)} before {case.message(in_base)}"
    return Named("order", f"{what}, in base after it")


def up_to(of: Telling, process: str, about: MessageId) -> list[MessageId]:
    """What a process handled up to a message, which is among it."""
    handled = of.handled(process)
    return handled[: handled.index(about) + 1]


def _taken_up(case: Case, in_base: Handling, in_new: Handling) -> Named | None:
    """Whether a message was taken up at another time, and what went first instead."""
    by_ns = in_new.start_ns - in_base.start_ns
    if by_ns == 0:
        return None
    what = f"{in_base.process} took up {case.message(in_base.about)} {later(by_ns)}"
    overtaken = _overtaken(case, in_base, in_new)
    if overtaken is None:
        return Named("time", what)
    order = ("after", "before") if by_ns > 0 else ("before", "after")
    other = f"{overtaken.process} took up {case.message(overtaken.about)}"
    return Named("order", f"{what}, {order[0]} {other} instead of {order[1]} it")


def _overtaken(case: Case, in_base: Handling, in_new: Handling) -> Handling | None:
    """A handler of another process that changed places with this one."""
    first_ns, last_ns = sorted((in_base.start_ns, in_new.start_ns))
    for one in case.base.begun_between(first_ns, last_ns):
        twin = case.new.handling(one.process, one.about)
        if twin is None or one.process == in_base.process:
            continue
        opposite = (twin.start_ns - one.start_ns) * (in_new.start_ns - in_base.start_ns) < 0
        if opposite and (one.start_ns < in_base.start_ns) != (twin.start_ns < in_new.start_ns):
            return one
    return None


def _other_said(case: Case, in_base: Handling, in_new: Handling) -> Named | None:
    """Whether the handler said something else."""
    where = f"{in_base.process}, handling {case.message(in_base.about)},"
    topics = [[event.topic for event in one.said] for one in (in_base, in_new)]
    if topics[0] != topics[1]:
        only_base, only_new = _surplus(*topics), _surplus(topics[1], topics[0])
        if only_base and only_new:
            what = f"{where} said {_said(only_new)} instead of {_said(only_base)}"
            return Named("content", what + _cost_too(in_base, in_new))
        if only_base:
            return Named("missing", f"{where} did not say {_said(only_base)}")
        if only_new:
            return Named("extra", f"{where} also said {_said(only_new)}")
        return Named("order", f"{where} said {', '.join(topics[1])}, in another order")
    for one, two in zip(in_base.said, in_new.said, strict=True):
        fields = field_differences(one.sent(), two.sent())
        if fields:
            what = f"{where} said another {one.topic}: {changes(fields)}"
            return Named("content", what + _cost_too(in_base, in_new), fields)
    return None


def _surplus(topics: list[str], of: list[str]) -> list[str]:
    """The topics that are not in the other list, each as often as it is in surplus."""
    left = list(of)
    surplus: list[str] = []
    for topic in topics:
        if topic in left:
            left.remove(topic)
        else:
            surplus.append(topic)
    return surplus


def _said(topics: list[str]) -> str:
    return ", ".join(topics)


def _cost_too(in_base: Handling, in_new: Handling) -> str:
    cost = _cost(in_base, in_new)
    return f"; it took {_instead(cost)}" if cost else ""


def _other_cost(case: Case, in_base: Handling, in_new: Handling) -> Named | None:
    """Whether the handler took another time or touched other cells."""
    cost = _cost(in_base, in_new)
    if not cost:
        return None
    what = f"{in_base.process} took {_instead(cost)}"
    return Named("cost", f"{what} to handle {case.message(in_base.about)}", cost)


def _instead(cost: tuple[FieldDifference, ...]) -> str:
    return ", ".join(f"{one.new} instead of {one.base}" for one in cost)


def _cost(in_base: Handling, in_new: Handling) -> tuple[FieldDifference, ...]:
    found: list[FieldDifference] = []
    if in_base.took_ns != in_new.took_ns:
        times = (duration(in_base.took_ns), duration(in_new.took_ns))
        found.append(FieldDifference("cost", *times))
    if in_base.cells != in_new.cells:
        cells = (f"{in_base.cells:,} cells", f"{in_new.cells:,} cells")
        found.append(FieldDifference("cells", *cells))
    return tuple(found)
