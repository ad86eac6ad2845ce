"""What one run tells about its handlers, around the place where it parts from another run."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from bus.topics import MODULES
from bus.wire import MessageId
from logs.diff.events import OUTPUT, SPAN, Event


@dataclass(frozen=True, slots=True)
class Handling:
    """One handler's work on one message, with all that it said and printed."""

    process: str
    about: MessageId
    topic: str
    start_ns: int
    end_ns: int
    cells: int
    said: tuple[Event, ...]

    @property
    def took_ns(self) -> int:
        """What it cost."""
        return self.end_ns - self.start_ns


class Telling:
    """Looks up what a run tells: ``common`` what both runs said, ``own`` what comes after it."""

    def __init__(self, common: Sequence[Event], own: Sequence[Event]) -> None:
        self.own = own
        self._events = (*common, *own)
        self._by_id = {event.id: event for event in self._events}
        self._said: dict[tuple[str, MessageId], list[Event]] = {}
        self._spans: dict[tuple[str, MessageId], Event] = {}
        self._order: dict[str, list[MessageId]] = {}
        for event in self._events:
            self._take(event)

    def _take(self, event: Event) -> None:
        if event.topic == SPAN:
            self._spans[event.process, event.about] = event
            self._order.setdefault(event.process, []).append(event.about)
        elif event.parents and (event.source in MODULES or event.topic == OUTPUT):
            self._said.setdefault((event.process, event.parents[0]), []).append(event)

    def find(self, name: MessageId) -> Event | None:
        """A message, if it is near enough to be known."""
        return self._by_id.get(name)

    def at(self, time_ns: int) -> Iterable[Event]:
        """What was said at a time, from the parting on."""
        return (event for event in self.own if event.said_ns == time_ns)

    def handling(self, process: str, about: MessageId) -> Handling | None:
        """A handler's work, if it ended within what is known."""
        span = self._spans.get((process, about))
        if span is None:
            return None
        record = span.record
        said = tuple(self._said.get((process, about), ()))
        start_ns, end_ns = record.start_ns, record.end_ns
        return Handling(process, about, record.topic, start_ns, end_ns, record.cells, said)

    def handled(self, process: str) -> list[MessageId]:
        """What a process handled, in its order."""
        return self._order.get(process, [])

    def turn(self, process: str, about: MessageId) -> list[MessageId]:
        """What a process handled in one go, back to back, up to a message.

        All of it was there when the first handler began, as in one grant.
        """
        order = self.handled(process)
        at = order.index(about)
        while at > 0 and self._in_one_go(process, order[at - 1], order[at]):
            at -= 1
        return order[at : order.index(about) + 1]

    def _in_one_go(self, process: str, before: MessageId, after: MessageId) -> bool:
        first, second = (self.handling(process, name) for name in (before, after))
        heard = self.find(after)
        return (
            first is not None
            and second is not None
            and heard is not None
            and first.end_ns == second.start_ns
            and heard.said_ns < first.start_ns
        )

    def down_ns(self, process: str) -> int | None:
        """When a process went down, if it did."""
        states = (event for event in self.own if event.topic == "health/state")
        of_process = (event for event in states if event.record.process == process)
        return next((e.said_ns for e in of_process if e.record.state == "down"), None)

    def begun_between(self, first_ns: int, last_ns: int) -> list[Handling]:
        """Handlers that began at or after one time and by another."""
        found = [self.handling(*key) for key in self._spans]
        return [one for one in found if one and first_ns <= one.start_ns <= last_ns]
