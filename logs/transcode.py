"""From a message on the bus to its record in the log, the short way where there is one.

Most messages are taken in one compiled walk over their bytes, without an object in between; the
record is the same to the byte as :func:`logs.schema.encode` makes of what
:func:`bus.wire.unpack` reads.
"""

from __future__ import annotations

from dataclasses import dataclass

import msgspec
import numpy as np

from bus.topics import TOPICS
from bus.wire import DTYPES, MessageId, RefusedError, Sent, reread, unpack
from logs import transcode_kernels as k
from logs.schema import PlannedField, SchemaError, encode, planned_fields

_ROOM = 12
"""A record is at most so many times as long as the message (a small int is a byte there)."""

SPAN = "clock/span"
"""Most messages are spans."""

_KINDS = {int: k.INT, float: k.FLOAT, str: k.TEXT, bool: k.BOOL}


class Taken(msgspec.Struct, frozen=True):
    """A message as the log takes it: ``record`` are its protobuf bytes.

    ``said`` is the message itself, or its bytes on the bus.
    """

    topic: str
    id: MessageId
    said_ns: int
    record: bytes
    said: Sent | bytes

    @property
    def sent(self) -> Sent:
        """The message itself."""
        return self.said if isinstance(self.said, Sent) else reread(self.topic, self.said)


def taken(sent: Sent) -> Taken:
    """A message with its record. Raises SchemaError if a field holds the wrong thing."""
    return Taken(sent.topic, sent.id, sent.said_ns, encode(sent), sent)


@dataclass(frozen=True)
class _Plan:
    publisher: str
    name: k.Bytes
    fields: k.Ints


def _row(field: PlannedField) -> tuple[int, ...] | None:
    if field.spec is None:
        return (_KINDS[field.kind], field.number, 0, 0, -1, 0, 0)
    spec = field.spec
    if spec.meaning not in ("any", "finite"):  # probabilities are summed as they always are
        return None
    length = -1 if spec.length is None else spec.length
    finite = spec.meaning == "finite"
    dtype = DTYPES[spec.dtype]
    return (k.ARRAY, field.number, dtype, spec.dimensions, length, finite, field.shape_number)


def _plan(topic: str) -> _Plan | None:
    """How the messages of a topic are taken; None for those that go the long way."""
    rows = [_row(field) for field in planned_fields(topic)]
    if None in rows:
        return None
    publisher = TOPICS[topic].publisher
    name = np.frombuffer(publisher.encode(), np.uint8)
    return _Plan(publisher, name, np.array(rows, np.int64).reshape(len(rows), 7))


class Taker:
    """Takes messages off the bus; not for several threads at once."""

    def __init__(self) -> None:
        self._plans = {topic: plan for topic in TOPICS if (plan := _plan(topic)) is not None}
        self._out = np.empty(1 << 16, np.uint8)
        self._found = np.zeros(3, np.int64)
        self._transcode(b"\0", self._plans[SPAN])  # compiled or loaded now: no message waits

    def _transcode(self, data: bytes, plan: _Plan) -> int:
        read = np.frombuffer(data, np.uint8)
        size: int = k.transcode(read, plan.name, plan.fields, self._out, self._found)
        return size

    def take(self, topic: str, data: bytes) -> Taken:
        """Check a message and make its record. Raises RefusedError."""
        plan = self._plans.get(topic)
        if plan is not None:
            if _ROOM * len(data) > len(self._out):
                self._out = np.empty(_ROOM * len(data), np.uint8)
            size = self._transcode(data, plan)
            if size != k.NOT_TAKEN:
                sequence, _, said_ns = self._found.tolist()
                record = self._out[:size].tobytes()
                return Taken(topic, (plan.publisher, sequence), said_ns, record, data)
        sent = unpack(topic, data)
        try:
            return taken(sent)
        except SchemaError as error:  # a number that no record holds
            raise RefusedError(topic, sent.source, sent.sequence, str(error)) from error
