"""A chunk as columns of numbers: what its messages say of themselves, none of them decoded."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from io import BytesIO
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Schema
from numpy.typing import NDArray

from bus.topics import BUS, CLOCK, PRIORITY, TOPICS
from logs import scan_kernels as k
from logs.schema import field_numbers

SPAN = "clock/span"
NAMES = (*PRIORITY, CLOCK, BUS, *TOPICS)
"""What a span may name: processes and topics; it is recorded by their number here."""

NUMBER = {name: number for number, name in enumerate(NAMES)}
TOPIC_NAMES = tuple(TOPICS)
TOPIC_NUMBER = {topic: number for number, topic in enumerate(TOPICS)}
_CHANNELS = 1 << 16  # as many as MCAP can number
_SPAN_FIELDS = (
    *("process", "topic", "about_source", "about_sequence"),
    *("start_ns", "end_ns", "cells"),
)


_Scan: TypeAlias = tuple[int, int, NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]


class ScanError(ValueError):
    """Bytes of a chunk that are not what was written: where, and what is wrong with them."""


@dataclass(frozen=True)
class OfTopic:
    """The messages of one topic in a chunk, a column each; their data from begin to end."""

    sequence: NDArray[np.int64]
    previous: NDArray[np.int64]
    stamp_ns: NDArray[np.int64]
    begin: NDArray[np.int64]
    end: NDArray[np.int64]


def _of_topic(columns: NDArray[np.int64]) -> OfTopic:
    of = (columns[k.SEQUENCE], columns[k.PREVIOUS], columns[k.LOG_NS])
    return OfTopic(*of, columns[k.BEGIN], columns[k.END])


@dataclass(frozen=True)
class Block:
    """The messages of a chunk.

    ``data`` are the chunk's bytes. ``messages`` (n, 6) and ``spans`` (m, 8) have the columns of
    :mod:`logs.scan_kernels`; ``topics`` (n,) the place of each message's topic in the table of
    topics. Messages that are no topic's are left out.
    """

    data: bytes
    messages: NDArray[np.int64]
    topics: NDArray[np.int64]
    spans: NDArray[np.int64]

    @cached_property
    def by_topic(self) -> tuple[tuple[str, OfTopic], ...]:
        """What the messages of each topic say of themselves; topics without any left out."""
        order = np.argsort(self.topics, kind="stable")
        topics = self.topics[order]
        columns = self.messages[order].T
        starts = np.flatnonzero(np.diff(topics, prepend=-1)).tolist()
        return tuple(
            (TOPIC_NAMES[topics[start]], _of_topic(columns[:, start:end]))
            for start, end in pairwise((*starts, len(topics)))
        )

    def message(self, row: int) -> bytes:
        """The protobuf bytes of a message."""
        return self.data[self.messages[row, k.BEGIN] : self.messages[row, k.END]]


@cache
def _tables() -> tuple[NDArray[np.int64], NDArray[np.uint8], NDArray[np.int64]]:
    """For the kernel: numbers of a span's fields, names as bytes, their lengths."""
    numbers = field_numbers(SPAN)
    sizes = np.array([len(name) for name in NAMES])
    names = np.zeros((len(NAMES), sizes.max()), np.uint8)
    for row, name in zip(names, NAMES, strict=True):
        row[: len(name)] = np.frombuffer(name.encode(), np.uint8)
    return np.array([numbers[name] for name in _SPAN_FIELDS]), names, sizes


class Scanner:
    """Scans the chunks of one file, in their order.

    ``name`` gets every schema and channel record; ``channels`` is what it makes of them, topic
    by channel. Both must be up to date when it returns.
    """

    def __init__(self, name: Callable[[Schema | Channel], None], channels: dict[int, str]) -> None:
        self._name = name
        self._channels = channels
        self._topics = np.full(_CHANNELS, -1)

    def block(self, data: bytes) -> Block:
        """The messages of a chunk. Raises ScanError where its bytes are not what was written."""
        known = len(self._channels)
        state, at, messages, spans, others = self._scan(data)
        for opcode, begin, end in others.tolist():
            self._other(opcode, data[begin:end])
        if len(self._channels) != known:  # only now is it known which ones are spans
            for channel, topic in self._channels.items():
                self._topics[channel] = TOPIC_NUMBER[topic]
            state, at, messages, spans, _ = self._scan(data)
        if state != k.WHOLE:
            raise ScanError(f"at byte {at} of a chunk: {_WRONG[state]}")
        return self._of_topics(data, messages, spans)

    def _scan(self, data: bytes) -> _Scan:
        span_channel = next((c for c, topic in self._channels.items() if topic == SPAN), -1)
        found: _Scan = k.scan(np.frombuffer(data, np.uint8), span_channel, *_tables())
        return found

    def _other(self, opcode: int, record: bytes) -> None:
        if opcode == Opcode.SCHEMA:
            self._name(Schema.read(ReadDataStream(BytesIO(record))))
        elif opcode == Opcode.CHANNEL:
            self._name(Channel.read(ReadDataStream(BytesIO(record))))

    def _of_topics(
        self, data: bytes, messages: NDArray[np.int64], spans: NDArray[np.int64]
    ) -> Block:
        topics = self._topics[messages[:, k.CHANNEL]]
        ours = topics >= 0
        spans = spans.copy()
        spans[:, k.ROW] = np.cumsum(ours)[spans[:, k.ROW]] - 1  # their rows in what is kept
        return Block(data, messages[ours], topics[ours], spans)


_WRONG = {
    k.CUT_RECORD: "a record that is longer than what is left",
    k.NO_MESSAGE: "a message that is no protobuf message",
    k.UNKNOWN_NAME: "a span of a process or topic that there is not",
}
