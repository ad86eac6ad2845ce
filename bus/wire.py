"""From a message to bytes and back: msgpack on the wire, types checked by msgspec on arrival.

Arrays travel as one ext type (dtype, shape, raw bytes) and are read without a copy: read-only,
C-ordered and aligned, so that sums over them come out as they do at the sender.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import msgpack
import msgspec
import numpy as np

from bus.fields import FieldError, check_arrays
from bus.messages import Message
from bus.topics import TOPICS

ARRAY_EXT = 1
DTYPES = {"float64": 0, "int64": 1, "uint8": 2}
DTYPE_OF = {code: np.dtype(name) for name, code in DTYPES.items()}

_WORD = 8
"""Arrays begin at a multiple of this, which numpy and numba take as aligned."""

_LONGEST_NAME = 64
"""A source's name with more letters is no name: it must not flood outputs and logs."""

MessageId: TypeAlias = tuple[str, int]
"""(source, sequence): names one message of a run."""


class RefusedError(ValueError):
    """A message that may not be let in: what it claimed to be, and what is wrong with it."""

    def __init__(self, topic: str, source: str, sequence: int, reason: str) -> None:
        super().__init__(
            f"{topic}: message {sequence} of {source or 'an unknown source'}: {reason}"
        )
        self.topic, self.source, self.sequence, self.reason = topic, source, sequence, reason


@dataclass(frozen=True, slots=True)
class Sent:
    """A message as it was said.

    ``sequence`` counts all messages of its source; ``previous`` is the sequence number of the
    source's message before on the same topic (-1 if none), so that a listener sees a gap.
    ``parents`` are the messages it was made from.
    """

    topic: str
    source: str
    sequence: int
    previous: int
    said_ns: int
    parents: tuple[MessageId, ...]
    message: Message

    @property
    def id(self) -> MessageId:
        """The message's name."""
        return (self.source, self.sequence)


def _pack_hook(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        head = bytes((DTYPES[value.dtype.name], value.ndim))
        shape = np.array(value.shape, dtype="<u4").tobytes()
        padded = (head + shape).ljust(_data_starts(value.ndim), b"\0")
        return msgpack.ExtType(ARRAY_EXT, padded + value.tobytes())
    if isinstance(value, (np.integer, np.floating, np.bool_)):
        return value.item()
    raise TypeError(f"cannot send a {type(value).__name__}")


def _data_starts(dimensions: int) -> int:
    return -(-(2 + 4 * dimensions) // _WORD) * _WORD


def _unpack_array(code: int, data: bytes) -> Any:
    if code != ARRAY_EXT:
        raise ValueError(f"found ext type {code}, expected {ARRAY_EXT} (an array)")
    if len(data) < 2 or data[0] not in DTYPE_OF or len(data) < _data_starts(data[1]):
        raise ValueError("an array without dtype and shape")
    start = _data_starts(data[1])
    shape = np.frombuffer(data, dtype="<u4", count=data[1], offset=2)
    # count is checked by reshape; frombuffer's arrays are read-only, as messages must be
    return np.frombuffer(data, dtype=DTYPE_OF[data[0]], offset=start).reshape(shape)


def _array_hook(expected: type, value: Any) -> Any:
    if isinstance(value, expected):
        return value
    raise FieldError(f"found {type(value).__name__}, expected {expected.__name__}")


def pack(sent: Sent) -> bytes:
    """The bytes of a message, its envelope first."""
    fields = msgspec.structs.astuple(sent.message)
    envelope = (sent.source, sent.sequence, sent.previous, sent.said_ns, sent.parents, fields)
    packed: bytes = msgpack.packb(envelope, default=_pack_hook)
    return packed


def unpack(topic: str, data: bytes) -> Sent:
    """Read and check a message. Raises RefusedError with all that could be made out of it."""
    source, sequence = "", -1
    try:
        parts = msgpack.unpackb(data, ext_hook=_unpack_array, use_list=False)
        source, sequence, previous, said_ns, parents, fields = parts
        _check_envelope(source, sequence, previous, said_ns, parents)
        row = TOPICS.get(topic)
        if row is None:
            raise FieldError("unknown topic")
        if source != row.publisher:
            raise FieldError(f"found source {source!r}, expected {row.publisher!r}")
        message = msgspec.convert(fields, row.type, dec_hook=_array_hook)
        check_arrays(message)
    except Exception as error:  # whatever a hostile payload makes the decoders raise
        where = (source, sequence) if _named(source, sequence) else ("", -1)
        raise RefusedError(topic, *where, f"{type(error).__name__}: {error}") from None
    return Sent(topic, source, sequence, previous, said_ns, parents, message)


def reread(topic: str, data: bytes) -> Sent:
    """Read a message once more whose bytes were checked: nothing is checked again."""
    parts = msgpack.unpackb(data, ext_hook=_unpack_array, use_list=False)
    source, sequence, previous, said_ns, parents, fields = parts
    message = TOPICS[topic].type(*fields)
    return Sent(topic, source, sequence, previous, said_ns, parents, message)


def _named(source: Any, sequence: Any) -> bool:
    return (
        isinstance(source, str)
        and len(source) <= _LONGEST_NAME
        and type(sequence) is int
        and -(2**63) <= sequence < 2**63  # what the log can hold
    )


def _check_envelope(source: Any, sequence: Any, previous: Any, said_ns: Any, parents: Any) -> None:
    if not all(_named(source, number) for number in (sequence, previous, said_ns)):
        raise FieldError("the envelope is not (source, sequence, previous, said_ns, ...)")
    if not isinstance(parents, tuple) or any(
        not isinstance(p, tuple) or len(p) != 2 or not _named(*p) for p in parents
    ):
        raise FieldError("parents are not pairs of (source, sequence)")
