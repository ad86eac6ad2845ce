"""Which messages led to a message: every message's parents, kept in a few bytes each.

The first parent of a message is the one whose coming triggered its maker.
"""

from __future__ import annotations

from array import array
from bisect import bisect_left
from dataclasses import dataclass, field

from bus.messages import Span
from bus.topics import TOPICS
from bus.wire import MessageId, Sent

LONGEST = 16
"""A chain lists so many messages at most."""

_TOPICS = tuple(TOPICS)
_NUMBER = {topic: number for number, topic in enumerate(_TOPICS)}
_ABSENT = 255
_WIDEST_GAP = 10_000_000


@dataclass(frozen=True)
class Link:
    """One message of a chain.

    ``began_ns`` is when its maker began to work on it, if known; ``also`` is how many messages
    beside the next of the chain it was made from.
    """

    topic: str
    source: str
    sequence: int
    said_ns: int
    began_ns: int | None
    also: int


@dataclass(frozen=True)
class Chain:
    """What led to a message, itself first: what triggered its maker, what triggered that, ...

    ``whole`` says whether it ends at a message that nothing in the log triggered; otherwise it
    was cut at the longest that is shown, or its next message is not in the log.
    """

    links: tuple[Link, ...]
    whole: bool


@dataclass
class _Said:
    """All messages of one source; a sequence number is an index into the arrays."""

    topic: array[int] = field(default_factory=lambda: array("B"))
    said_ns: array[int] = field(default_factory=lambda: array("q"))
    parents_end: array[int] = field(default_factory=lambda: array("q"))
    parents: array[int] = field(default_factory=lambda: array("q"))

    def add(self, sent: Sent, parents: list[int]) -> None:
        gap = sent.sequence - len(self.topic)
        if not 0 <= gap <= _WIDEST_GAP:
            return  # said twice, or no number that counts messages
        self.topic.extend([_ABSENT] * gap)
        self.said_ns.extend([0] * gap)
        self.parents_end.extend([len(self.parents)] * gap)
        self.parents.extend(parents)
        self.topic.append(_NUMBER[sent.topic])
        self.said_ns.append(sent.said_ns)
        self.parents_end.append(len(self.parents))


class Ancestry:
    """Who said what when, because of what. Made for a million messages."""

    def __init__(self) -> None:
        self._said: dict[str, _Said] = {}
        self._sources: list[str] = []
        self._ends: dict[str, array[int]] = {}
        self._starts: dict[str, array[int]] = {}

    def hear(self, sent: Sent) -> None:
        """Note one message and its parents, and a span's beginning and end."""
        parents = [n for p in sent.parents for n in (self._index(p[0]), p[1])]
        self._of(sent.source).add(sent, parents)
        match sent.message:
            case Span(process=process, start_ns=start_ns, end_ns=end_ns):
                self._starts.setdefault(process, array("q")).append(start_ns)
                self._ends.setdefault(process, array("q")).append(end_ns)

    def _of(self, source: str) -> _Said:
        return self._said.setdefault(source, _Said())

    def _index(self, source: str) -> int:
        if source not in self._sources:
            self._sources.append(source)
        return self._sources.index(source)

    def chain(self, message: MessageId) -> Chain:
        """The message and what led to it, nearest first. Empty for one that was never said."""
        links: list[Link] = []
        following: MessageId | None = message
        while following is not None and len(links) < LONGEST:
            found = self._link(following)
            if found is None:
                break
            links.append(found)
            parents = self._parents(found.source, found.sequence)
            following = parents[0] if parents and parents[0] != message else None
        return Chain(tuple(links), following is None)

    def _link(self, message: MessageId) -> Link | None:
        source, sequence = message
        said = self._said.get(source)
        if said is None or not 0 <= sequence < len(said.topic):
            return None
        if said.topic[sequence] == _ABSENT:
            return None
        said_ns = said.said_ns[sequence]
        topic = _TOPICS[said.topic[sequence]]
        also = max(0, len(self._parents(source, sequence)) - 1)
        return Link(topic, source, sequence, said_ns, self._began_ns(source, said_ns), also)

    def _parents(self, source: str, sequence: int) -> list[MessageId]:
        said = self._said[source]
        first = said.parents_end[sequence - 1] if sequence else 0
        flat = said.parents[first : said.parents_end[sequence]]
        return [(self._sources[flat[i]], flat[i + 1]) for i in range(0, len(flat), 2)]

    def _began_ns(self, process: str, said_ns: int) -> int | None:
        """When the handler began that ended with saying something; a process does one at a time."""
        ends = self._ends.get(process)
        if ends is None:
            return None
        at = bisect_left(ends, said_ns)
        return self._starts[process][at] if at < len(ends) and ends[at] == said_ns else None
