"""What each process did, how long its handlers took and how long messages waited for it."""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bus.topics import PRIORITY
from logs.spread import NS_PER_S, Spread, spread


@dataclass(frozen=True)
class Load:
    """The work of one process: ``share`` is its busy time over the duration of the run."""

    process: str
    handlers: int
    cells: int
    busy_s: float
    share: float | None


class SpanRow(NamedTuple):
    """One handler, as the tables have it; ``said_ns`` of its message is None if not known."""

    process: str
    topic: str
    source: str
    sequence: int
    said_ns: int | None
    start_ns: int
    end_ns: int
    cells: int


@dataclass(frozen=True)
class HandlerTimes:
    """The handlers of one topic in one process: ``took`` is simulated time."""

    topic: str
    cells: int
    took: Spread


@dataclass(frozen=True)
class ProcessTimes:
    """``waited`` is the queue: how long each message lay there, heard but not taken up.

    Its number is that of the messages whose saying is known, ``waited_at_all`` how many of them
    waited longer than nothing.
    """

    process: str
    waited: Spread
    waited_at_all: int
    handlers: tuple[HandlerTimes, ...]


def _times() -> array[int]:
    return array("q")


@dataclass
class _Handler:
    took_ns: array[int] = field(default_factory=_times)
    cells: int = 0


class Loads:
    """Gathers the handlers of one log."""

    def __init__(self) -> None:
        self._handlers: dict[str, dict[str, _Handler]] = {}
        self._waited_ns: dict[str, array[int]] = {}

    def add(
        self, process: str, topic: str, took_ns: int, cells: int, waited_ns: int | None
    ) -> None:
        """A handler ran; ``waited_ns`` is None where it is not known when its message was said."""
        handler = self._handler(process, topic)
        handler.took_ns.append(took_ns)
        handler.cells += cells
        if waited_ns is not None:
            self._waited_ns[process].append(waited_ns)

    def add_block(
        self,
        process: str,
        topic: str,
        took_ns: NDArray[np.int64],
        cells: int,
        waited_ns: NDArray[np.int64],
    ) -> None:
        """Handlers of one topic ran; ``waited_ns`` of those whose messages are known."""
        handler = self._handler(process, topic)
        handler.took_ns.frombytes(took_ns.tobytes())
        handler.cells += cells
        self._waited_ns[process].frombytes(waited_ns.tobytes())

    def _handler(self, process: str, topic: str) -> _Handler:
        topics = self._handlers.setdefault(process, {})
        self._waited_ns.setdefault(process, _times())
        return topics.setdefault(topic, _Handler())

    def loads(self, duration_ns: int) -> tuple[Load, ...]:
        """The work of each process, in the order of their priority."""
        return tuple(self._load(process, duration_ns) for process in self._order())

    def times(self) -> tuple[ProcessTimes, ...]:
        """The waiting and the handlers of each process, in the order of their priority."""
        return tuple(
            ProcessTimes(
                process,
                spread(self._waited_ns[process]),
                sum(waited_ns > 0 for waited_ns in self._waited_ns[process]),
                tuple(
                    HandlerTimes(topic, handler.cells, spread(handler.took_ns))
                    for topic, handler in sorted(self._handlers[process].items())
                ),
            )
            for process in self._order()
        )

    def _order(self) -> list[str]:
        return sorted(self._handlers, key=lambda name: (PRIORITY.get(name, len(PRIORITY)), name))

    def _load(self, process: str, duration_ns: int) -> Load:
        handlers = self._handlers[process].values()
        busy_ns = sum(sum(handler.took_ns) for handler in handlers)
        return Load(
            process,
            sum(len(handler.took_ns) for handler in handlers),
            sum(handler.cells for handler in handlers),
            busy_ns / NS_PER_S,
            busy_ns / duration_ns if duration_ns > 0 else None,
        )
