"""Whether the messages of a log are all there, and fit each other, in one pass."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from pathlib import Path

from bus.topics import CLOCK, MODULES, TOPICS, WORLD
from logs.reader import LogReadError, read_run
from logs.schema import Record, SchemaError, parse
from logs.traffic import TopicCount, new_counts

SPAN = "clock/span"
_ASKED = "asked/"


@dataclass
class RunFacts:
    """What the messages of a log say of its being whole.

    ``unheard`` has, by (topic, process), the messages that were passed over: later ones of the
    topic were handled there; ``waiting`` those that nothing was handled after. ``astray`` are
    spans of messages that the log does not have. ``asked``, ``missed`` and ``settled`` are
    decisions by their number.
    """

    counts: dict[str, TopicCount] = field(default_factory=new_counts)
    missing: dict[str, int] = field(default_factory=dict)
    problem: str = ""
    metadata: dict[str, str] = field(default_factory=dict)
    spans: int = 0
    handled_by: dict[str, int] = field(default_factory=dict)
    unheard: dict[tuple[str, str], int] = field(default_factory=dict)
    waiting: int = 0
    astray: int = 0
    asked: dict[int, str] = field(default_factory=dict)
    missed: dict[int, str] = field(default_factory=dict)
    settled: dict[int, str] = field(default_factory=dict)
    ended: str = ""
    undecodable: str = ""

    @property
    def messages(self) -> int:
        """How many messages there are."""
        return sum(len(count.said_ns) for count in self.counts.values())

    @property
    def silent(self) -> list[str]:
        """Processes of which there is neither a message nor a handler."""
        spoke = {TOPICS[topic].publisher for topic, of in self.counts.items() if of.said_ns}
        expected = (WORLD, *MODULES, CLOCK)
        return [name for name in expected if name not in spoke and name not in self.handled_by]


class _Facts:
    """Gathers them; ``_due`` has, by topic and process, what the process must yet handle."""

    def __init__(self) -> None:
        self.found = RunFacts()
        self._due: dict[tuple[str, str], deque[int]] = {
            (topic.name, process): deque()
            for topic in TOPICS.values()
            for process in topic.subscribers
        }

    def hear(self, topic: str, said_ns: int, data: bytes) -> None:
        record = parse(topic, data)
        self.found.counts[topic].add(said_ns, len(data), record.sequence, record.previous)
        for process in TOPICS[topic].subscribers:
            self._due[topic, process].append(record.sequence)
        if topic == SPAN:
            self._span(record)
        elif topic.startswith(_ASKED):
            self.found.asked[record.decision] = topic.removeprefix(_ASKED)
        elif topic == "deadline/missed":
            self.found.missed[record.decision] = record.kind
        elif topic == "ledger":
            self.found.settled[record.decision] = record.kind
        elif topic == "run/ended":
            self.found.ended = record.reason

    def _span(self, span: Record) -> None:
        found, key = self.found, (span.topic, span.process)
        found.spans += 1
        found.handled_by[span.process] = found.handled_by.get(span.process, 0) + 1
        due = self._due.get(key)
        if due is None or span.about_sequence not in due:
            found.astray += 1
            return
        while due.popleft() != span.about_sequence:
            found.unheard[key] = found.unheard.get(key, 0) + 1

    def finish(self) -> RunFacts:
        self.found.waiting = sum(map(len, self._due.values()))
        return self.found


def run_facts(path: Path) -> RunFacts:
    """Read a log's messages. Raises LogReadError if it is not the log of a run."""
    facts = _Facts()
    with read_run(path) as reader:
        try:
            for topic, said_ns, data in reader.raw():
                facts.hear(topic, said_ns, data)
        except SchemaError as error:
            facts.found.undecodable = str(error)
        except LogReadError as error:  # recorded with other fields: whole, but not for us
            facts.found.undecodable = str(error)
        found = facts.finish()
        found.metadata = reader.metadata
        found.missing = reader.missing
        found.problem = reader.problem if reader.truncated else ""
    return found
