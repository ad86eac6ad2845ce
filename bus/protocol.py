"""Grants, dones and commits as bytes."""

from __future__ import annotations

from typing import TypeAlias

import msgpack

from bus.coordinator import Done, Grant, Handled, Said
from bus.wire import MessageId, Sent, pack, unpack

CommitEntry: TypeAlias = MessageId | Sent
"""What the recorder writes next: a message it has received, by name, or one sent along."""


def pack_grant(grant: Grant) -> bytes:
    """A grant for its process."""
    packed: bytes = msgpack.packb((grant.time_ns, grant.messages))
    return packed


def unpack_grant(process: str, data: bytes) -> Grant:
    """The grant that ``process`` was sent."""
    time_ns, messages = msgpack.unpackb(data, use_list=False)
    return Grant(process, time_ns, messages)


def pack_done(done: Done) -> bytes:
    """What came of a grant."""
    handled = [
        (h.topic, h.source, h.sequence, h.start_ns, h.end_ns, h.cells, h.said) for h in done.handled
    ]
    said = [(s.topic, s.sequence, s.said_ns) for s in done.said]
    packed: bytes = msgpack.packb((done.process, done.time_ns, handled, said))
    return packed


def unpack_done(data: bytes) -> Done:
    """The inverse of :func:`pack_done`."""
    process, time_ns, handled, said = msgpack.unpackb(data, use_list=False)
    return Done(
        process,
        time_ns,
        tuple(Handled(*h) for h in handled),
        tuple(Said(topic, process, sequence, said_ns) for topic, sequence, said_ns in said),
    )


def pack_commit(entries: list[CommitEntry], *, last: bool) -> bytes:
    """The next entries of the log in their order; ``last`` ends the run."""
    items = [(e.topic, pack(e)) if isinstance(e, Sent) else e for e in entries]
    packed: bytes = msgpack.packb((items, last))
    return packed


def unpack_commit(data: bytes) -> tuple[list[CommitEntry], bool]:
    """The inverse of :func:`pack_commit`."""
    items, last = msgpack.unpackb(data, use_list=False)
    return [unpack(*i) if isinstance(i[1], bytes) else i for i in items], last
