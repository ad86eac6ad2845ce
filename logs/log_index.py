"""The recent messages of a log, to be looked up by name, in memory that does not grow with it.

What is kept of a message is where its bytes are; it is decoded when something asks for it.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from bus.topics import CLOCK, TOPICS
from bus.wire import MessageId
from logs import scan_kernels as k
from logs.ancestry import Node
from logs.scan import NAMES, TOPIC_NAMES, TOPIC_NUMBER, Block
from logs.schema import parse

WINDOW = 1 << 16
"""So many messages of each source are kept: hours of a run, where minutes are needed."""

HELD_BYTES = 1 << 25
"""So much of the log is kept beside them, to decode messages from."""

_Key = TypeVar("_Key")


class _Recent:
    """Numbers by sequence, of the last ones: ``columns`` of them, 0 where there are none."""

    def __init__(self, window: int, columns: int) -> None:
        self._sequence = np.full(window, -1)
        self._values = np.zeros((window, columns), np.int64)

    def put(self, sequence: NDArray[np.int64], values: NDArray[np.int64]) -> None:
        slot = sequence % len(self._sequence)
        self._sequence[slot] = sequence
        self._values[slot] = values

    def get(self, sequence: NDArray[np.int64]) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
        """Which of them are there, and their values."""
        slot = sequence % len(self._sequence)
        return self._sequence[slot] == sequence, self._values[slot]

    def one(self, sequence: int) -> list[int] | None:
        slot = sequence % len(self._sequence)
        return self._values[slot].tolist() if self._sequence[slot] == sequence else None


_SAID, _TOPIC, _BLOCK, _BEGIN, _END = range(5)


class LogIndex:
    """Takes in the blocks of one log, in their order. Its lookups are those of an Index."""

    def __init__(self, epoch_ns: int, window: int = WINDOW, held_bytes: int = HELD_BYTES) -> None:
        self._epoch_ns = epoch_ns
        self._window = window
        self._most_bytes = held_bytes
        self._bytes = 0
        self._number = 0
        self._blocks: OrderedDict[int, bytes] = OrderedDict()
        self._said: dict[str, _Recent] = {}
        self._spans: dict[tuple[str, str], _Recent] = {}

    def take(self, block: Block) -> None:
        """Take in a block's messages, then its spans."""
        self._number += 1
        self._blocks[self._number] = block.data
        self._bytes += len(block.data)
        while self._bytes > self._most_bytes and len(self._blocks) > 1:
            self._bytes -= len(self._blocks.popitem(last=False)[1])
        self._take_messages(block)
        pairs = block.spans[:, k.PROCESS] * len(NAMES) + block.spans[:, k.SOURCE]
        for pair in np.unique(pairs).tolist():
            process, source = divmod(pair, len(NAMES))
            spans = block.spans[pairs == pair]
            recent = self._recent(self._spans, (NAMES[process], NAMES[source]), 2)
            recent.put(spans[:, k.ABOUT], spans[:, [k.START_NS, k.END_NS]])

    def _take_messages(self, block: Block) -> None:
        for topic, of in block.by_topic:
            source = TOPICS[topic].publisher
            if source == CLOCK:  # nothing is made from a span
                continue
            values = np.empty((len(of.sequence), 5), np.int64)
            values[:, _SAID] = of.stamp_ns - self._epoch_ns
            values[:, _TOPIC], values[:, _BLOCK] = TOPIC_NUMBER[topic], self._number
            values[:, _BEGIN], values[:, _END] = of.begin, of.end
            self._recent(self._said, source, 5).put(of.sequence, values)

    def _recent(self, of: dict[_Key, _Recent], key: _Key, columns: int) -> _Recent:
        recent = of.get(key)
        if recent is None:
            recent = of[key] = _Recent(self._window, columns)
        return recent

    def said_ns(
        self, source: str, sequence: NDArray[np.int64]
    ) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
        """When messages of a source were said: which of them are known, and their times."""
        recent = self._said.get(source)
        if recent is None:
            return np.zeros(len(sequence), np.bool_), np.zeros(len(sequence), np.int64)
        known, values = recent.get(sequence)
        return known, values[:, _SAID]

    def find(self, name: MessageId) -> Node | None:
        """A message, or None if it is not in the log or is too long ago."""
        source, sequence = name
        recent = self._said.get(source)
        place = recent.one(sequence) if recent is not None else None
        data = self._blocks.get(place[_BLOCK]) if place is not None else None
        if place is None or data is None:
            return None
        topic = TOPIC_NAMES[place[_TOPIC]]
        record = parse(topic, data[place[_BEGIN] : place[_END]])
        parents = tuple((parent.source, parent.sequence) for parent in record.parents)
        return Node(topic, source, sequence, place[_SAID], parents)

    def span(self, process: str, name: MessageId) -> tuple[int, int] | None:
        """When a process handled a message: (start, end) in ns; None if it did not."""
        recent = self._spans.get((process, name[0]))
        times = recent.one(name[1]) if recent is not None else None
        return (times[0], times[1]) if times is not None else None
