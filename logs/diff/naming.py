"""Naming what two runs part over: whose doing it is, of what kind, after hearing what."""

from __future__ import annotations

from bus.topics import MODULES
from bus.wire import MessageId
from logs.diff.case import Case, Named
from logs.diff.events import OUTPUT, SPAN, Event
from logs.diff.found import FirstDifference, Heard
from logs.diff.handlers import name_handler, up_to
from logs.diff.messages import is_elsewhere, name_message
from logs.diff.search import Parting
from logs.diff.telling import Telling


def name_parting(parting: Parting) -> FirstDifference:
    """The first event that differs, and what is known of its cause."""
    case = _case(parting)
    event = case.event
    about = _about(event)
    named: Named | None = None
    heard: tuple[Heard, ...] = case.heard(list(event.parents), [])
    if about is not None:
        named = name_handler(case, event.process, about)
        heard = _heard(case, event.process, about)
    named = named or name_message(case)
    return FirstDifference(
        at_ns=event.said_ns,
        source=event.process,
        topic=event.topic,
        sequence=event.record.sequence,
        kind=named.kind,
        what=named.what + _after(heard),
        heard=heard,
        fields=named.fields,
    )


def name_renumbered(event: Event) -> FirstDifference:
    """All is equal but the numbers of the clock: what ran at one instant ran in another order."""
    what = f"{event.topic} (about {event.process}) has another number of the clock and all else is"
    return FirstDifference(
        event.said_ns,
        event.process,
        event.topic,
        event.record.sequence,
        "order",
        f"{what} equal: handlers that began at the same moment were carried out in another order",
    )


def _case(parting: Parting) -> Case:
    base = Telling(parting.common, parting.base)
    new = Telling(parting.common, parting.new)
    cases = [Case(of.own[0], of is base, base, new) for of in (base, new) if of.own]
    # at one moment what both say, in another order, comes after what only one says
    return min(cases, key=lambda case: (case.event.said_ns, is_elsewhere(case), case.event.key))


def _about(event: Event) -> MessageId | None:
    """The message in whose handler the event arose, if it arose in one."""
    if event.topic == SPAN:
        return event.about
    if event.parents and (event.source in MODULES or event.topic == OUTPUT):
        return event.parents[0]
    return None


def _heard(case: Case, process: str, about: MessageId) -> tuple[Heard, ...]:
    turns = [_turn(of, process, about) for of in (case.one, case.other)]
    if not all(turns):  # one of them did not handle it: what it heard before is the same
        either = turns[0] or turns[1]
        return case.heard([*either, *case.event.parents], [about])
    not_in_both = [name for name in turns[0] if name not in turns[1]]
    not_in_both += [name for name in turns[1] if name not in turns[0]]
    for one, other in ((case.base, case.new), (case.new, case.base)):
        handled = set(other.handled(process))  # asked for members alone
        not_in_both += [name for name in up_to(one, process, about) if name not in handled]
    return case.heard([*turns[0], *case.event.parents], not_in_both)


def _turn(of: Telling, process: str, about: MessageId) -> list[MessageId]:
    return of.turn(process, about) if of.handling(process, about) is not None else []


def _after(heard: tuple[Heard, ...]) -> str:
    same = heard and all(one.equal for one in heard)
    return ", after hearing exactly the same" if same else ""
