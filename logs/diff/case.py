"""The first event that differs, with what both runs tell around it."""

from __future__ import annotations

from dataclasses import dataclass

from bus.wire import MessageId
from logs.diff.contents import FieldDifference
from logs.diff.events import Event
from logs.diff.found import Heard, Kind
from logs.diff.telling import Telling


@dataclass(frozen=True)
class Named:
    """A kind of difference, its cause in words, and the fields that differ."""

    kind: Kind
    what: str
    fields: tuple[FieldDifference, ...] = ()


@dataclass(frozen=True)
class Case:
    """``event`` is the earliest of what only one run says; ``in_base`` whether that is base."""

    event: Event
    in_base: bool
    base: Telling
    new: Telling

    @property
    def one(self) -> Telling:
        """The run that says it."""
        return self.base if self.in_base else self.new

    @property
    def other(self) -> Telling:
        """The other run."""
        return self.new if self.in_base else self.base

    @property
    def lacking(self) -> Kind:
        """The kind of what only the run of the event has."""
        return "missing" if self.in_base else "extra"

    def message(self, name: MessageId) -> str:
        """A message in words: its topic, number and source."""
        event = self.one.find(name) or self.other.find(name)
        topic = f"{event.topic} " if event is not None else ""
        return f"{topic}(message {name[1]} of {name[0]})"

    def heard(self, names: list[MessageId], not_in_both: list[MessageId]) -> tuple[Heard, ...]:
        """What went into the event; of messages that are too far back nothing is known."""
        found: list[Heard] = []
        for name in dict.fromkeys((*names, *not_in_both)):
            event, twin = self.one.find(name), self.other.find(name)
            known = event or twin
            if known is None:
                continue
            equal = event is not None and twin is not None and event.data == twin.data
            equal = equal and name not in not_in_both
            found.append(Heard(known.topic, *name, known.said_ns, equal))
        return tuple(found)
