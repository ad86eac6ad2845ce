"""A module's turns as a log has them: what it handled when, and what came of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from bus.topics import CLOCK, MODULES, PRIORITY, TOPICS
from bus.wire import MessageId
from logs.diff.events import OUTPUT, SPAN, Event, event_of
from logs.reader import LogReadError, RawSent, RunReader
from logs.schema import SchemaError

STATE = "health/state"
ENDED = "run/ended"


@dataclass(frozen=True)
class LoggedTurn:
    """One handler's work: the message it heard, its span, all that it said and printed.

    ``dropped``: its process went down before it ended, so that what it said was never heard.
    """

    heard: Event
    span: Event
    said: tuple[Event, ...]
    printed: tuple[Event, ...]
    dropped: bool


class GapInLogError(ValueError):
    """Something that the module's state depends on is not in the log: what, and from when on."""


@dataclass
class LoggedModule:
    """Reads one module's turns from a log, in their order.

    When the iteration is over, ``waiting`` has what it had heard and not handled, ``state`` what
    the log says last of the process (empty: nothing), at ``state_ns``; ``free_ns`` is when its
    last handler ended, and ``unended`` how many messages it said in a handler without an end.
    """

    module: str
    reader: RunReader
    waiting: dict[MessageId, Event] = field(default_factory=dict)
    state: str = ""
    state_ns: int = 0
    ended: str = ""
    free_ns: int = 0
    _previous: dict[str, int] = field(default_factory=dict)
    _said: dict[MessageId, list[Event]] = field(default_factory=dict)
    _open: LoggedTurn | None = None

    @property
    def unended(self) -> int:
        """How many messages it said in handlers whose end is not in the log."""
        return sum(map(len, self._said.values()))

    def turns(self) -> Iterator[LoggedTurn]:
        """The module's turns. Raises GapInLogError where one cannot be told, LogReadError."""
        heard = {topic.name for topic in TOPICS.values() if self.module in topic.subscribers}
        said = {topic.name for topic in TOPICS.values() if topic.publisher == self.module}
        wanted = {*heard, *said, SPAN, OUTPUT, STATE, ENDED}
        for raw in self.reader.raw():
            if raw[0] not in wanted:
                continue
            event = self._event(raw)
            if self._open is not None and not self._prints(event):
                yield self._open
                self._open = None
            self._check_gap(event)
            self._take(event, event.topic in heard)
        if self._open is not None:
            yield self._open

    def _event(self, raw: RawSent) -> Event:
        try:
            return event_of(raw)
        except SchemaError as error:
            raise LogReadError(f"{self.reader.path}: {error}") from error

    def _check_gap(self, event: Event) -> None:
        if event.source == CLOCK:  # its words stand in the order of their times, not numbers
            return
        last = self._previous.get(event.topic, -1)
        self._previous[event.topic] = event.record.sequence
        if event.record.previous != last:
            raise GapInLogError(
                f"messages of {event.source} on {event.topic} between {last} and "
                f"{event.record.sequence} are not in the log; nothing can be said of what follows "
                f"{event.said_ns / 1e9:.3f} s"
            )

    def _prints(self, event: Event) -> bool:
        """Whether an event is what the open turn printed; it is then part of it."""
        turn = self._open
        return (
            turn is not None
            and event.topic == OUTPUT
            and event.process == self.module
            and event.parents == (turn.heard.id,)
        )

    def _take(self, event: Event, is_heard: bool) -> None:
        if is_heard:
            self.waiting[event.id] = event
        elif event.source == self.module:
            self._said.setdefault(event.parents[0], []).append(event)
        elif event.topic == ENDED:
            self.ended = event.record.reason
        elif event.process != self.module:
            return
        elif event.topic == SPAN:
            self._open = self._turn(event)
        elif event.topic == STATE:
            self.state, self.state_ns = event.record.state, event.said_ns
        elif self._open is not None:
            turn = self._open
            printed = (*turn.printed, event)
            self._open = LoggedTurn(turn.heard, turn.span, turn.said, printed, turn.dropped)

    def _turn(self, span: Event) -> LoggedTurn:
        heard = self.waiting.pop(span.about, None)
        if heard is None:
            source, sequence = span.about
            raise GapInLogError(
                f"message {sequence} of {source}, which {self.module} handled at "
                f"{span.record.start_ns / 1e9:.3f} s, is not in the log"
            )
        self._check_passed_over(heard)
        self.free_ns = span.record.end_ns
        dropped = self.state == "down" and self.state_ns < span.said_ns
        return LoggedTurn(heard, span, tuple(self._said.pop(span.about, ())), (), dropped)

    def _check_passed_over(self, heard: Event) -> None:
        """What is heard first is handled first; else the end of its handler was lost."""
        first = next(iter(self.waiting.values()), heard)
        if first.said_ns < heard.said_ns:
            source, sequence = first.id
            raise GapInLogError(
                f"what {self.module} did with message {sequence} of {source}, said at "
                f"{first.said_ns / 1e9:.3f} s, is not in the log"
            )

    def last_turn(self, hop_ns: int) -> tuple[int, list[Event]]:
        """What it would have been granted next, had it gone on: when, and which messages."""
        order = sorted(self.waiting.values(), key=_heard_order)
        if not order:
            return self.free_ns, []
        start_ns = max(order[0].said_ns + hop_ns, self.free_ns)
        return start_ns, [event for event in order if event.said_ns + hop_ns <= start_ns]


def _heard_order(event: Event) -> tuple[int, int, str, int]:
    return (event.said_ns, PRIORITY.get(event.source, len(MODULES)), *event.id)
