"""Compiled: what the messages of a chunk say about themselves, without decoding them.

One walk over the bytes of a chunk finds every record, and in a message's protobuf bytes the
numbers of its envelope; of a span (most messages are spans) all it says. The formats are those
of https://mcap.dev/spec and https://protobuf.dev/programming-guides/encoding.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

Bytes: TypeAlias = NDArray[np.uint8]
Ints: TypeAlias = NDArray[np.int64]

CHANNEL, LOG_NS, BEGIN, END, SEQUENCE, PREVIOUS = range(6)
"""Columns of what is found of a message; its data are the bytes from BEGIN to END."""

ROW, PROCESS, TOPIC, SOURCE, ABOUT, START_NS, END_NS, CELLS = range(8)
"""Columns of what is found of a span. ROW is the message that it is; names are their numbers."""

OPCODE, OTHER_BEGIN, OTHER_END = range(3)
"""Columns of a record that is not a message."""

WHOLE, CUT_RECORD, NO_MESSAGE, UNKNOWN_NAME = range(4)
"""What became of a scan: done; a record is longer than the chunk; bytes that are no protobuf
message; a span of a process, source or topic that is not in the table of names."""

_HEAD = 9
_MESSAGE_HEAD = 22
_MESSAGE = 5
_FIELDS = 32


@njit(cache=True)
def _little(data: Bytes, at: int, length: int) -> int:
    value = 0
    for k in range(length):
        value |= int(data[at + k]) << (8 * k)
    return value


@njit(cache=True)
def _varint(data: Bytes, at: int, end: int) -> tuple[int, int]:
    """A number and where it ends, or -1 there if it does not."""
    value, shift = 0, 0
    while at < end and shift < 70:
        byte = int(data[at])
        at += 1
        value |= (byte & 0x7F) << shift
        if byte < 0x80:
            return value, at
        shift += 7
    return 0, -1


@njit(cache=True)
def _read_fields(data: Bytes, at: int, end: int, values: Ints, lengths: Ints) -> bool:
    """Note the value of each field that is a number, begin and length of each that is bytes."""
    values[:] = 0
    lengths[:] = 0
    while at < end:
        tag, at = _varint(data, at, end)
        if at < 0:
            return False
        number, wire = tag >> 3, tag & 7
        value, length = 0, 0
        if wire == 0:
            value, at = _varint(data, at, end)
        elif wire == 1:
            at += 8
        elif wire == 2:
            length, at = _varint(data, at, end)
            value = at
            if at >= 0:
                at = at + length if 0 <= length <= end - at else -1
        elif wire == 5:
            at += 4
        else:
            return False
        if at < 0 or at > end:
            return False
        if 0 < number < len(values):
            values[number], lengths[number] = value, length
    return True


@njit(cache=True)
def _name(data: Bytes, begin: int, length: int, names: Bytes, sizes: Ints) -> int:
    """The number of a name in the table, or -1."""
    for k in range(len(sizes)):
        if sizes[k] == length:
            same = True
            for i in range(length):
                if data[begin + i] != names[k, i]:
                    same = False
                    break
            if same:
                return k
    return -1


@njit(cache=True)
def _take_span(
    data: Bytes, span: Ints, fields: Ints, values: Ints, lengths: Ints, names: Bytes, sizes: Ints
) -> bool:
    """Note what a span says; False if it names something that is not in the table."""
    known = True
    for k in range(3):
        field = fields[k]
        span[PROCESS + k] = _name(data, values[field], lengths[field], names, sizes)
        known &= span[PROCESS + k] >= 0
    for k in range(3, 7):
        span[PROCESS + k] = values[fields[k]]
    return known


@njit(cache=True)
def _record_end(data: Bytes, at: int) -> int:
    """Where the record at a byte ends, or -1 if that is beyond the chunk."""
    left = len(data) - at - _HEAD
    if left < 0:
        return -1
    length = _little(data, at + 1, 8)
    least = _MESSAGE_HEAD if data[at] == _MESSAGE else 0
    return at + _HEAD + length if least <= length <= left else -1


@njit(cache=True)
def scan(
    data: Bytes, span_channel: int, span_fields: Ints, names: Bytes, sizes: Ints
) -> tuple[int, int, Ints, Ints, Ints]:
    """What a chunk holds: (how it went, at which byte), messages, spans, other records.

    ``span_channel`` is the channel of spans (-1: none yet), ``span_fields`` the protobuf numbers
    of process, topic, source, sequence, start, end and cells. ``names`` is the table of names,
    one a row, ``sizes`` their lengths.
    """
    most = len(data) // _HEAD + 1
    messages = np.empty((most, 6), np.int64)
    spans = np.empty((most, 8), np.int64)
    others = np.empty((most, 3), np.int64)
    values, lengths = np.zeros(_FIELDS, np.int64), np.zeros(_FIELDS, np.int64)
    n_messages, n_spans, n_others = 0, 0, 0
    state, at = WHOLE, 0
    while at < len(data) and state == WHOLE:
        end = _record_end(data, at)
        if end < 0:
            state = CUT_RECORD
            break
        begin = at + _HEAD
        if data[at] != _MESSAGE:
            other = others[n_others]
            other[OPCODE], other[OTHER_BEGIN], other[OTHER_END] = data[at], begin, end
            n_others += 1
        elif not _read_fields(data, begin + _MESSAGE_HEAD, end, values, lengths):
            state = NO_MESSAGE
            break
        else:
            message, channel = messages[n_messages], _little(data, begin, 2)
            message[CHANNEL], message[LOG_NS] = channel, _little(data, begin + 6, 8)
            message[BEGIN], message[END] = begin + _MESSAGE_HEAD, end
            message[SEQUENCE], message[PREVIOUS] = values[2], values[3]
            if channel == span_channel:
                span = spans[n_spans]
                span[ROW] = n_messages
                n_spans += 1
                if not _take_span(data, span, span_fields, values, lengths, names, sizes):
                    state = UNKNOWN_NAME
                    break
            n_messages += 1
        at = end
    return state, at, messages[:n_messages], spans[:n_spans], others[:n_others]
