"""A message of a log, read as far as a comparison needs."""

from __future__ import annotations

from dataclasses import dataclass

from bus.topics import CLOCK, PRIORITY
from bus.wire import MessageId, Sent
from logs.reader import RawSent
from logs.schema import Record, parse, sent_of

SPAN = "clock/span"
OUTPUT = "output"


@dataclass(frozen=True, slots=True, eq=False)
class Event:
    """Something said in a run; ``data`` is how it stands in the log, ``record`` the same parsed."""

    topic: str
    said_ns: int
    data: bytes
    record: Record

    @property
    def id(self) -> MessageId:
        """The message's name."""
        return self.record.source, self.record.sequence

    @property
    def source(self) -> str:
        """Who said it."""
        source: str = self.record.source
        return source

    @property
    def parents(self) -> tuple[MessageId, ...]:
        """The messages it was made from; the first one triggered its maker."""
        return tuple((parent.source, parent.sequence) for parent in self.record.parents)

    @property
    def about(self) -> MessageId:
        """The message that a span is about."""
        return self.record.about_source, self.record.about_sequence

    @property
    def process(self) -> str:
        """Whose doing it is: of what the clock notes down, the process that it is about."""
        of_clock = self.source == CLOCK and hasattr(self.record, "process")
        process: str = self.record.process if of_clock else self.record.source
        return process

    @property
    def key(self) -> tuple[int, int, str, int, str, bytes]:
        """Its place among the events of both runs: as in a log, then by what it is."""
        rank = PRIORITY.get(self.source, len(PRIORITY))
        return (self.said_ns, rank, *self.id, self.topic, self.data)

    def sent(self) -> Sent:
        """The whole message."""
        return sent_of(self.topic, self.record)


def event_of(raw: RawSent) -> Event:
    """A message of a log. Raises SchemaError if its bytes are not one."""
    topic, said_ns, data = raw
    return Event(topic, said_ns, data, parse(topic, data))
