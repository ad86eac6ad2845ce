"""Grants, dones, commits and refusals as bytes.

What may not be decoded raises :class:`~bus.wire.RefusedError`, its topic the kind of thing it
should have been.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import msgpack
import msgspec

from bus.coordinator import Done, Grant, Handled, Said
from bus.wire import MessageId, RefusedError, Sent, pack

CommitEntry: TypeAlias = MessageId | Sent
"""What the recorder writes next: a message it has received, by name, or one sent along."""

_GRANT = msgspec.msgpack.Decoder(tuple[int, tuple[tuple[str, int], ...]])
_HANDLED: TypeAlias = tuple[str, str, int, int, int, int, int, str, int]
_DONE = msgspec.msgpack.Decoder(
    tuple[str, int, tuple[_HANDLED, ...], tuple[tuple[str, int, int], ...]]
)
_COMMIT = msgspec.msgpack.Decoder(tuple[tuple[tuple[str, int | bytes], ...], bool])
_REFUSAL = msgspec.msgpack.Decoder(tuple[str, str, int, str])


def _decoded(decoder: msgspec.msgpack.Decoder[Any], what: str, data: bytes) -> Any:
    try:
        return decoder.decode(data)
    except (msgspec.MsgspecError, ValueError) as error:
        raise RefusedError(what, "", -1, f"{type(error).__name__}: {error}") from None


def pack_grant(grant: Grant) -> bytes:
    """A grant for its process."""
    packed: bytes = msgpack.packb((grant.time_ns, grant.messages))
    return packed


def unpack_grant(process: str, data: bytes) -> Grant:
    """The grant that ``process`` was sent."""
    time_ns, messages = _decoded(_GRANT, "grant", data)
    return Grant(process, time_ns, messages)


def pack_done(done: Done) -> bytes:
    """What came of a grant."""
    handled = [
        (
            *(h.topic, h.source, h.sequence, h.start_ns, h.end_ns),
            *(h.cells, h.said, h.printed, h.took_ns),
        )
        for h in done.handled
    ]
    said = [(s.topic, s.sequence, s.said_ns) for s in done.said]
    packed: bytes = msgpack.packb((done.process, done.time_ns, handled, said))
    return packed


def unpack_done(data: bytes) -> Done:
    """The inverse of :func:`pack_done`."""
    process, time_ns, handled, said = _decoded(_DONE, "done", data)
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


def unpack_commit(data: bytes) -> tuple[tuple[tuple[str, int | bytes], ...], bool]:
    """The inverse of :func:`pack_commit`: names, or topics and bytes of messages sent along."""
    items, last = _decoded(_COMMIT, "commit", data)
    return items, last


def pack_refusal(error: RefusedError) -> bytes:
    """What a process has refused."""
    packed: bytes = msgpack.packb((error.topic, error.source, error.sequence, error.reason))
    return packed


def unpack_refusal(data: bytes) -> RefusedError:
    """The inverse of :func:`pack_refusal`."""
    return RefusedError(*_decoded(_REFUSAL, "refused", data))
