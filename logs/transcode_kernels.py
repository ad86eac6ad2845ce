"""Compiled: a message from the bytes of the bus to those of the log, in one walk.

From msgpack (https://github.com/msgpack/msgpack/blob/master/spec.md) to protobuf
(https://protobuf.dev/programming-guides/encoding), with the checks that :func:`bus.wire.unpack`
makes. Whatever is not just as a process of the run packs it is not taken (NOT_TAKEN): the caller
then goes the long way, which takes it or says what is wrong with it.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

Bytes: TypeAlias = NDArray[np.uint8]
Ints: TypeAlias = NDArray[np.int64]

KIND, NUMBER, DTYPE, DIMENSIONS, LENGTH, FINITE, SHAPE = range(7)
"""Columns of a plan, a row a field: what it is, its number in protobuf; of an array the code of
its dtype, its dimensions, the length of its last axis (-1: any), whether it must be finite, and
the number of the field for its shape (0: none)."""

INT, FLOAT, TEXT, BOOL, ARRAY = range(5)
FLOAT64, INT64, UINT8 = range(3)

NOT_TAKEN = -1
SEQUENCE, PREVIOUS, SAID_NS = range(3)
"""The numbers of a message's envelope, in their order."""

_VARINT, _I64, _LEN = 0, 1, 2
_WORD = 8
_LONGEST_NAME = 64
_ARRAY_EXT = 1
_EXPONENT = 0x7FF


@njit(cache=True)
def _byte(data: Bytes, at: int) -> int:
    return int(np.int64(data[at]))  # signed, as everything here is


@njit(cache=True)
def _big(data: Bytes, at: int, length: int) -> int:
    value = 0
    for k in range(length):
        value = value << 8 | _byte(data, at + k)
    return value


@njit(cache=True)
def _little(data: Bytes, at: int, length: int) -> int:
    value = 0
    for k in range(length):
        value |= _byte(data, at + k) << (8 * k)
    return value


@njit(cache=True)
def _int(data: Bytes, at: int) -> tuple[int, int]:
    """A whole number and where it ends; (0, NOT_TAKEN) for anything else."""
    if at >= len(data):
        return 0, NOT_TAKEN
    first = _byte(data, at)
    if first < 0x80:
        return first, at + 1
    if first >= 0xE0:
        return first - 0x100, at + 1
    size = 1 << (first & 3)
    if first < 0xCC or first > 0xD3 or at + 1 + size > len(data):
        return 0, NOT_TAKEN
    value = _big(data, at + 1, size)
    if first >= 0xD0 and size < 8:  # signed
        half = 1 << (8 * size - 1)
        value = (value ^ half) - half
    if first == 0xCF and value < 0:  # more than an int64 holds
        return 0, NOT_TAKEN
    return value, at + 1 + size


@njit(cache=True)
def _size(data: Bytes, at: int, fixed: int, most: int, coded: int, sizes: int) -> tuple[int, int]:
    """How long a text or array is, and where it begins.

    Its first byte is ``fixed`` plus a length up to ``most``, or ``coded`` plus k < 3, where
    ``sizes`` << k bytes with the length follow.
    """
    if at >= len(data):
        return 0, NOT_TAKEN
    first = _byte(data, at)
    if fixed <= first <= fixed + most:
        return first - fixed, at + 1
    k = first - coded
    if k < 0 or k > 2 or sizes << k > 4:
        return 0, NOT_TAKEN
    wide = sizes << k
    if at + 1 + wide > len(data):
        return 0, NOT_TAKEN
    return _big(data, at + 1, wide), at + 1 + wide


@njit(cache=True)
def _text(data: Bytes, at: int) -> tuple[int, int]:
    """Where a text of ASCII begins and ends; (0, NOT_TAKEN) for anything else."""
    size, begin = _size(data, at, 0xA0, 31, 0xD9, 1)
    if begin < 0 or begin + size > len(data):
        return 0, NOT_TAKEN
    for k in range(begin, begin + size):
        if data[k] >= 0x80:
            return 0, NOT_TAKEN
    return begin, begin + size


@njit(cache=True)
def _list(data: Bytes, at: int) -> tuple[int, int]:
    return _size(data, at, 0x90, 15, 0xDC, 2)


@njit(cache=True)
def _name(data: Bytes, at: int) -> tuple[int, int]:
    begin, end = _text(data, at)
    return (begin, end) if end - begin <= _LONGEST_NAME else (0, NOT_TAKEN)


@njit(cache=True)
def _varint_size(value: int) -> int:
    if value < 0:
        return 10
    size = 1
    while value >= 0x80:
        value >>= 7
        size += 1
    return size


@njit(cache=True)
def _put_varint(out: Bytes, at: int, value: int) -> int:
    left = np.uint64(value)
    while left >= np.uint64(0x80):
        out[at] = np.uint8((left & np.uint64(0x7F)) | np.uint64(0x80))
        left >>= np.uint64(7)
        at += 1
    out[at] = np.uint8(left)
    return at + 1


@njit(cache=True)
def _put_bytes(out: Bytes, at: int, data: Bytes, begin: int, end: int) -> int:
    for k in range(begin, end):
        out[at + k - begin] = data[k]
    return at + end - begin


@njit(cache=True)
def _put_int(out: Bytes, at: int, number: int, value: int) -> int:
    """A field; like all that are 0 or empty it is left out where it is 0."""
    if value == 0:
        return at
    at = _put_varint(out, at, number << 3 | _VARINT)
    return _put_varint(out, at, value)


@njit(cache=True)
def _put_text(out: Bytes, at: int, number: int, data: Bytes, begin: int, end: int) -> int:
    if begin == end:
        return at
    at = _put_varint(out, at, number << 3 | _LEN)
    at = _put_varint(out, at, end - begin)
    return _put_bytes(out, at, data, begin, end)


@njit(cache=True)
def _parents(data: Bytes, at: int, out: Bytes, to: int) -> tuple[int, int]:
    number, at = _list(data, at)
    for _ in range(number if at >= 0 else 0):
        pair, at = _list(data, at)
        if at < 0 or pair != 2:
            return NOT_TAKEN, 0
        begin, at = _name(data, at)
        if at < 0:
            return NOT_TAKEN, 0
        end = at
        sequence, at = _int(data, at)
        if at < 0:
            return NOT_TAKEN, 0
        size = 0 if begin == end else 1 + _varint_size(end - begin) + end - begin
        size += 0 if sequence == 0 else 1 + _varint_size(sequence)
        to = _put_varint(out, to, 5 << 3 | _LEN)
        to = _put_varint(out, to, size)
        to = _put_text(out, to, 1, data, begin, end)
        to = _put_int(out, to, 2, sequence)
    return at, to


@njit(cache=True)
def _array_at(data: Bytes, at: int) -> tuple[int, int]:
    """Where an array's bytes begin and end; (0, NOT_TAKEN) for anything else."""
    if at + 2 > len(data):
        return 0, NOT_TAKEN
    first = _byte(data, at)
    if 0xD4 <= first <= 0xD8:
        size, begin = 1 << (first - 0xD4), at + 1
    else:
        size, begin = _size(data, at, 0x100, 0, 0xC7, 1)
    if begin < 0 or begin + 1 + size > len(data) or data[begin] != _ARRAY_EXT:
        return 0, NOT_TAKEN
    return begin + 1, begin + 1 + size


@njit(cache=True)
def _put_array(out: Bytes, to: int, field: Ints, data: Bytes, begin: int, end: int) -> int:
    """An array and, where it has more than one dimension, its shape."""
    dimensions = field[DIMENSIONS]
    start = begin + (2 + 4 * dimensions + _WORD - 1) // _WORD * _WORD
    if start > end or data[begin] != field[DTYPE] or data[begin + 1] != dimensions:
        return NOT_TAKEN
    number, last = 1, 0
    for k in range(dimensions):
        last = _little(data, begin + 2 + 4 * k, 4)
        number *= last
        if number > len(data):
            return NOT_TAKEN
    wide = 1 if field[DTYPE] == UINT8 else _WORD
    if start + number * wide != end or (field[LENGTH] >= 0 and last != field[LENGTH]):
        return NOT_TAKEN
    if field[FINITE]:
        for k in range(start, end, _WORD):
            if _little(data, k + 6, 2) >> 4 & _EXPONENT == _EXPONENT:
                return NOT_TAKEN
    if field[DTYPE] == INT64:
        to = _put_ints(out, to, field[NUMBER], data, start, end)
    else:
        to = _put_text(out, to, field[NUMBER], data, start, end)
    return _put_shape(out, to, field[SHAPE], data, begin + 2, dimensions)


@njit(cache=True)
def _put_ints(out: Bytes, to: int, number: int, data: Bytes, begin: int, end: int) -> int:
    size = 0
    for k in range(begin, end, _WORD):
        size += _varint_size(_little(data, k, _WORD))
    if size == 0:
        return to
    to = _put_varint(out, to, number << 3 | _LEN)
    to = _put_varint(out, to, size)
    for k in range(begin, end, _WORD):
        to = _put_varint(out, to, _little(data, k, _WORD))
    return to


@njit(cache=True)
def _put_shape(out: Bytes, to: int, number: int, data: Bytes, at: int, dimensions: int) -> int:
    if number == 0:
        return to
    size = 0
    for k in range(dimensions):
        size += _varint_size(_little(data, at + 4 * k, 4))
    to = _put_varint(out, to, number << 3 | _LEN)
    to = _put_varint(out, to, size)
    for k in range(dimensions):
        to = _put_varint(out, to, _little(data, at + 4 * k, 4))
    return to


@njit(cache=True)
def _float(data: Bytes, at: int, out: Bytes, to: int, number: int) -> tuple[int, int]:
    if at + 9 > len(data) or data[at] != 0xCB:
        return NOT_TAKEN, to
    if _big(data, at + 1, _WORD) != 0:
        to = _put_varint(out, to, number << 3 | _I64)
        for k in range(_WORD):
            out[to + k] = data[at + _WORD - k]
        to += _WORD
    return at + 9, to


@njit(cache=True)
def _field(data: Bytes, at: int, out: Bytes, to: int, field: Ints) -> tuple[int, int]:
    """One field: where the next one begins in ``data`` and in ``out``."""
    number = field[NUMBER]
    if field[KIND] == INT:
        value, at = _int(data, at)
        return at, _put_int(out, to, number, value)
    if field[KIND] == FLOAT:
        return _float(data, at, out, to, number)
    if field[KIND] == TEXT:
        begin, at = _text(data, at)
        return at, _put_text(out, to, number, data, begin, at) if at >= 0 else to
    if field[KIND] == BOOL:
        if at >= len(data) or (data[at] != 0xC2 and data[at] != 0xC3):
            return NOT_TAKEN, to
        return at + 1, _put_int(out, to, number, _byte(data, at) - 0xC2)
    begin, at = _array_at(data, at)
    to = _put_array(out, to, field, data, begin, at) if at >= 0 else NOT_TAKEN
    return (at, to) if to >= 0 else (NOT_TAKEN, to)


@njit(cache=True)
def _envelope(data: Bytes, publisher: Bytes, out: Bytes, found: Ints) -> tuple[int, int]:
    parts, at = _list(data, 0)
    if at < 0 or parts != 6:
        return NOT_TAKEN, 0
    begin, at = _name(data, at)
    if at - begin != len(publisher):
        return NOT_TAKEN, 0
    for k in range(len(publisher)):
        if data[begin + k] != publisher[k]:
            return NOT_TAKEN, 0
    to = _put_text(out, 0, 1, data, begin, at)
    for k in range(3):
        found[k], at = _int(data, at)
        if at < 0:
            return NOT_TAKEN, 0
        to = _put_int(out, to, 2 + k, found[k])
    return _parents(data, at, out, to)


@njit(cache=True)
def transcode(data: Bytes, publisher: Bytes, plan: Ints, out: Bytes, found: Ints) -> int:
    """Put a message's protobuf bytes into ``out``, and the numbers of its envelope into ``found``.

    ``out`` must hold 12 times as much as ``data``. Returns how many bytes there are, or NOT_TAKEN.
    """
    at, to = _envelope(data, publisher, out, found)
    if at < 0:
        return NOT_TAKEN
    fields, at = _list(data, at)
    if at < 0 or fields != len(plan):
        return NOT_TAKEN
    for k in range(len(plan)):
        at, to = _field(data, at, out, to, plan[k])
        if at < 0:
            return NOT_TAKEN
    return to if at == len(data) else NOT_TAKEN
