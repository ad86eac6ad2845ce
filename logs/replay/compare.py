"""Whether a replayed turn did what the log says of it, bit for bit."""

from __future__ import annotations

from dataclasses import replace

from bus.coordinator import Handled
from bus.messages import Output, Span
from bus.topics import CLOCK, TOPIC_OF
from bus.wire import Sent
from logs.diff.contents import field_differences
from logs.diff.events import Event, event_of
from logs.diff.found import FirstDifference
from logs.diff.naming import name_parting
from logs.diff.search import Parting
from logs.replay.turns import LoggedTurn
from logs.schema import encode


def compare_turn(
    turn: LoggedTurn, module: str, handled: Handled, said: list[Sent], printed: str
) -> FirstDifference | None:
    """The first thing in which a replayed turn is not as in the log."""
    logged = [turn.span, *turn.printed] if turn.dropped else [*turn.said, turn.span, *turn.printed]
    now = [] if turn.dropped else [_as_logged(s, turn.said, k) for k, s in enumerate(said)]
    now.append(_span(turn.span, module, handled))
    now += _output(turn, module, handled, printed)
    k = 0
    while k < min(len(logged), len(now)) and _equal(logged[k], now[k]):
        k += 1
    if k == len(logged) == len(now):
        return None
    common = (turn.heard, *logged[:k])
    return name_parting(Parting(common, tuple(logged[k:]), tuple(now[k:])))


def _equal(logged: Event, now: Event) -> bool:
    if logged.data == now.data:
        return True
    if (logged.topic, logged.id, logged.said_ns) != (now.topic, now.id, now.said_ns):
        return False
    return not field_differences(logged.sent(), now.sent())


def _as_logged(sent: Sent, said: tuple[Event, ...], k: int) -> Event:
    """What is said now, under the number that the log has at its place.

    An earlier message more or less is no difference of this one.
    """
    if k < len(said):
        record = said[k].record
        sent = replace(sent, sequence=record.sequence, previous=record.previous)
    return _event(sent)


def _event(sent: Sent) -> Event:
    return event_of((sent.topic, sent.said_ns, encode(sent)))


def _span(logged: Event, module: str, handled: Handled) -> Event:
    span = Span(
        module,
        handled.topic,
        handled.source,
        handled.sequence,
        handled.start_ns,
        handled.end_ns,
        handled.cells,
    )
    record = logged.record
    topic = TOPIC_OF[Span].name
    return _event(
        Sent(topic, CLOCK, record.sequence, record.previous, handled.end_ns, logged.parents, span)
    )


def _output(turn: LoggedTurn, module: str, handled: Handled, printed: str) -> list[Event]:
    if not printed:
        return []
    numbers = (turn.span.record.sequence + 1, -1)
    if turn.printed:
        record = turn.printed[0].record
        numbers = (record.sequence, record.previous)
    output = Output(module, printed)
    topic = TOPIC_OF[Output].name
    return [_event(Sent(topic, CLOCK, *numbers, handled.end_ns, (turn.heard.id,), output))]
