"""Which messages a message was made from, as far as the parents that each one carries tell.

Only recent messages can be looked up, so that memory does not grow with the log; a parent that
was said too long ago to be found, or is not in the log, is counted as unknown, never guessed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from bus.wire import MessageId

WINDOW = 100_000
"""At least so many messages back a parent is found: hours of a run, where minutes are needed."""


@dataclass(slots=True, eq=False)
class Node:
    """One message: what it was made from, the first of it having triggered its maker.

    ``spans`` has (process, start, end in ns) of each handler that took it in so far; ``unknown``
    is how many of its parents could not be found.
    """

    topic: str
    source: str
    sequence: int
    said_ns: int
    parents: tuple[Node, ...] = ()
    unknown: int = 0
    spans: list[tuple[str, int, int]] = field(default_factory=list)

    def span_in(self, process: str) -> tuple[int, int] | None:
        """When a process handled it: (start, end) in ns."""
        for name, start_ns, end_ns in self.spans:
            if name == process:
                return start_ns, end_ns
        return None


@dataclass(frozen=True, slots=True)
class Ancestor:
    """A message that another was made from, and the topics on the way to that one."""

    node: Node
    route: tuple[str, ...]


def ancestors(node: Node) -> Iterator[Ancestor]:
    """All messages that one was made from, nearest first, each once, by a shortest route."""
    seen = {id(node)}
    front = [Ancestor(node, (node.topic,))]
    while front:
        behind: list[Ancestor] = []
        for ancestor in front:
            for parent in ancestor.node.parents:
                if id(parent) not in seen:
                    seen.add(id(parent))
                    behind.append(Ancestor(parent, (parent.topic, *ancestor.route)))
        yield from behind
        front = behind


class Ancestry:
    """The messages heard so far, by name."""

    def __init__(self, window: int = WINDOW) -> None:
        self._window = window
        self._young: dict[MessageId, Node] = {}
        self._old: dict[MessageId, Node] = {}
        self.unknown = 0

    def hear(
        self,
        topic: str,
        source: str,
        sequence: int,
        said_ns: int,
        parents: Iterable[MessageId] = (),
    ) -> Node:
        """Take in a message; its parents must have been heard before it."""
        node = Node(topic, source, sequence, said_ns)
        found = tuple([self.find(name) for name in parents])
        if None in found:
            node.parents = tuple(parent for parent in found if parent is not None)
            node.unknown = len(found) - len(node.parents)
            self.unknown += node.unknown
        else:
            node.parents = found  # type: ignore[assignment]
        if len(self._young) >= self._window:
            self._old, self._young = self._young, {}
        self._young[source, sequence] = node
        return node

    def find(self, name: MessageId) -> Node | None:
        """The message of this name, or None where it was not heard or is too long ago."""
        return self._young.get(name) or self._old.get(name)
