"""Response times of the ways from a percept or a question to a decision.

A *path* is a series of topics. What is read along it are pairs: an *input* (a message at its
beginning) and a decision that was made from it, at any remove, along that path. ``all`` is the
time from the one being said to the other being said, for each pair. The other readings ask about
one end: of a decision, which of its inputs; of an input, which of its decisions.

==============================  ===========================================================
best                            for each decision, from the newest of its inputs: what
                                computing and transport take at least
worst                           for each decision, from the oldest of its inputs: what came
                                first and had to wait for the others
worst with external latency     for each decision, from the newest input of the decision
                                before: something that happened just after that one was
                                taken had to wait for this decision
first                           for each input, to the first decision made from it: how
                                long the robot takes to react
last                            for each input, to the last decision made from it: how old
                                a datum gets that is still decided by
==============================  ===========================================================

The first three are those of CARET, the chain-aware evaluation tool for ROS 2, where a decision
and its inputs are a *cycle* (its documentation, "Response time":
https://tier4.github.io/caret_doc/latest/visualization/path/response_time). The last two are the
*reaction time* and the *data age* of cause-effect chains (N. Feiertag, K. Richter, J. Nordlander,
J. Jonsson: A Compositional Framework for End-to-End Path Delay Calculation of Automotive Systems
under Different Path Semantics, CRTS 2008), of data that were used: an input that no decision was
made from has no reading, and the age ends with the last decision, not when that is replaced.

Hence first <= last for each input and best <= worst for each decision; the least of ``all`` is
the least of best and of first, the greatest that of worst and of last.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field

from bus.wire import MessageId
from logs.ancestry import Ancestors, Node
from logs.spread import Spread, spread

INPUTS = ("percept/", "asked/")

READINGS = ("all", "best", "worst", "worst_with_external_latency", "first", "last")


@dataclass(frozen=True)
class PathTimes:
    """The response times of one path; ``topics`` from the input to the decision."""

    topics: tuple[str, ...]
    inputs: int
    decisions: int
    all: Spread
    best: Spread
    worst: Spread
    worst_with_external_latency: Spread
    first: Spread
    last: Spread


def _times() -> array[int]:
    return array("q")


@dataclass
class _Path:
    """The readings of a path so far, in ns; ``row`` is where an input's first and last are."""

    all: array[int] = field(default_factory=_times)
    best: array[int] = field(default_factory=_times)
    worst: array[int] = field(default_factory=_times)
    external: array[int] = field(default_factory=_times)
    first: array[int] = field(default_factory=_times)
    last: array[int] = field(default_factory=_times)
    row: dict[MessageId, int] = field(default_factory=dict)
    newest_ns: int | None = None

    def decided(self, at_ns: int, inputs: list[Node]) -> None:
        newest_ns = max(node.said_ns for node in inputs)
        for node in inputs:
            self._used(node.id, at_ns - node.said_ns)
        self.best.append(at_ns - newest_ns)
        self.worst.append(at_ns - min(node.said_ns for node in inputs))
        if self.newest_ns is not None:
            self.external.append(at_ns - self.newest_ns)
        self.newest_ns = newest_ns

    def _used(self, name: MessageId, after_ns: int) -> None:
        self.all.append(after_ns)
        row = self.row.setdefault(name, len(self.first))
        if row == len(self.first):
            self.first.append(after_ns)
            self.last.append(after_ns)
        self.last[row] = after_ns

    def times(self, topics: tuple[str, ...]) -> PathTimes:
        readings = (self.all, self.best, self.worst, self.external, self.first, self.last)
        return PathTimes(topics, len(self.first), len(self.best), *map(spread, readings))


class Paths:
    """Gathers the response times of one log, whose decisions come in the order of their times."""

    def __init__(self) -> None:
        self._paths: dict[tuple[str, ...], _Path] = {}

    def decided(self, made: Ancestors) -> None:
        """A decision was said."""
        inputs: dict[tuple[str, ...], list[Node]] = {}
        for ancestor in made.each:
            if ancestor.node.topic.startswith(INPUTS):
                inputs.setdefault(ancestor.route, []).append(ancestor.node)
        for route, nodes in inputs.items():
            self._paths.setdefault(route, _Path()).decided(made.of.said_ns, nodes)

    def times(self) -> tuple[PathTimes, ...]:
        """The response times of all paths, by decision, then by path."""
        order = sorted(self._paths.items(), key=lambda item: (item[0][-1], len(item[0]), item[0]))
        return tuple(path.times(topics) for topics, path in order)
