"""Response times of the ways from a percept or a question to a decision.

Read as CARET, the chain-aware evaluation tool for ROS 2, reads them (its documentation,
"Response time": https://tier4.github.io/caret_doc/latest/visualization/path/response_time).
A *path* is a series of topics; a *cycle* of it is one decision with all inputs that came to it
along that path.

==============================  ===========================================================
all                             from each input of the cycle to the decision
best                            from the newest input of the cycle: what computing and
                                transport take at least
worst                           from the oldest input of the cycle: what came first and had
                                to wait for the others
worst with external latency     from the newest input of the cycle before: something that
                                happened just after it was taken had to wait for this cycle
==============================  ===========================================================
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field

from logs.ancestry import Ancestors
from logs.spread import Spread, spread

INPUTS = ("percept/", "asked/")


@dataclass(frozen=True)
class PathTimes:
    """The response times of one path; ``topics`` from the input to the decision."""

    topics: tuple[str, ...]
    cycles: int
    all: Spread
    best: Spread
    worst: Spread
    worst_with_external_latency: Spread


def _times() -> array[int]:
    return array("q")


@dataclass
class _Path:
    all: array[int] = field(default_factory=_times)
    best: array[int] = field(default_factory=_times)
    worst: array[int] = field(default_factory=_times)
    external: array[int] = field(default_factory=_times)
    newest_ns: int | None = None

    def cycle(self, decided_ns: int, inputs_ns: list[int]) -> None:
        newest_ns = max(inputs_ns)
        self.all.extend([decided_ns - said_ns for said_ns in inputs_ns])
        self.best.append(decided_ns - newest_ns)
        self.worst.append(decided_ns - min(inputs_ns))
        if self.newest_ns is not None:
            self.external.append(decided_ns - self.newest_ns)
        self.newest_ns = newest_ns


class Paths:
    """Gathers the response times of one log."""

    def __init__(self) -> None:
        self._paths: dict[tuple[str, ...], _Path] = {}

    def decided(self, made: Ancestors) -> None:
        """A decision was said."""
        inputs: dict[tuple[str, ...], list[int]] = {}
        for ancestor in made.each:
            if ancestor.node.topic.startswith(INPUTS):
                inputs.setdefault(ancestor.route, []).append(ancestor.node.said_ns)
        for route, said_ns in inputs.items():
            self._paths.setdefault(route, _Path()).cycle(made.of.said_ns, said_ns)

    def times(self) -> tuple[PathTimes, ...]:
        """The response times of all paths, by decision, then by path."""
        order = sorted(self._paths.items(), key=lambda item: (item[0][-1], len(item[0]), item[0]))
        return tuple(
            PathTimes(
                topics,
                len(path.best),
                spread(path.all),
                spread(path.best),
                spread(path.worst),
                spread(path.external),
            )
            for topics, path in order
        )
