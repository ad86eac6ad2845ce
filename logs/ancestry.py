"""Which messages a message was made from, as far as the parents that each one carries tell."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

from bus.wire import MessageId


@dataclass(frozen=True, slots=True)
class Node:
    """One message; the first of its parents triggered its maker."""

    topic: str
    source: str
    sequence: int
    said_ns: int
    parents: tuple[MessageId, ...] = ()

    @property
    def id(self) -> MessageId:
        """The message's name."""
        return self.source, self.sequence


class Index(Protocol):
    """Where messages and their handlers are looked up."""

    def find(self, name: MessageId) -> Node | None:
        """A message, or None if it is not in the log or is too long ago."""

    def span(self, process: str, name: MessageId) -> tuple[int, int] | None:
        """When a process handled a message: (start, end) in ns; None if it did not."""


@dataclass(frozen=True, slots=True)
class Ancestor:
    """A message that another was made from, and the topics on the way to that one."""

    node: Node
    route: tuple[str, ...]


@dataclass(frozen=True)
class Ancestors:
    """All messages that ``of`` was made from, nearest first, each once, by a shortest route.

    ``unknown`` is how many parents could not be found: they are never guessed.
    """

    of: Node
    each: tuple[Ancestor, ...]
    unknown: int


def ancestors(index: Index, node: Node) -> Ancestors:
    """Look up all ancestors of a message."""
    seen = {node.id}
    found: list[Ancestor] = []
    front = [Ancestor(node, (node.topic,))]
    unknown = 0
    while front:
        behind: list[Ancestor] = []
        for child, name in _parents(front):
            if name in seen:
                continue
            seen.add(name)
            parent = index.find(name)
            if parent is None:
                unknown += 1
            else:
                behind.append(Ancestor(parent, (parent.topic, *child.route)))
        found += behind
        front = behind
    return Ancestors(node, tuple(found), unknown)


def _parents(front: list[Ancestor]) -> Iterator[tuple[Ancestor, MessageId]]:
    for child in front:
        for name in child.node.parents:
            yield child, name
