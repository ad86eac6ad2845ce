"""Protobuf's wire format (https://protobuf.dev/programming-guides/encoding), read by hand."""

from __future__ import annotations

import struct
from typing import TypeAlias

Value: TypeAlias = int | bytes


def fields(data: bytes) -> dict[int, list[Value]]:
    """All values of a message by the numbers of its fields: numbers, or bytes not read yet."""
    found: dict[int, list[Value]] = {}
    at = 0
    while at < len(data):
        tag, at = _varint(data, at)
        value: Value
        match tag & 7:
            case 0:
                value, at = _varint(data, at)
            case 1:
                (value,), at = struct.unpack_from("<Q", data, at), at + 8
            case 2:
                size, at = _varint(data, at)
                value, at = data[at : at + size], at + size
            case kind:
                raise AssertionError(f"wire type {kind} at byte {at}")
        found.setdefault(tag >> 3, []).append(value)
    assert at == len(data)
    return found


def _varint(data: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while True:
        value |= (data[at] & 0x7F) << shift
        shift += 7
        at += 1
        if data[at - 1] < 0x80:
            return value, at


def signed(value: Value) -> int:
    """An int64 that a varint holds."""
    assert isinstance(value, int)
    return value - (1 << 64) if value >> 63 else value


def text(value: Value) -> str:
    """A string that a field holds."""
    assert isinstance(value, bytes)
    return value.decode()
