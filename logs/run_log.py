"""Writing a run down as MCAP, so that the file depends on nothing but what was said.

Two runs that say the same leave the same bytes: every channel is registered at the start in
the order of the topic table, attachments carry the epoch as their time, and chunks end by size
or by simulated time, never by the wall clock. A run that is killed leaves all finished chunks.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Self

from mcap.writer import Writer

from bus.topics import TOPICS
from bus.wire import Sent
from logs.schema import SchemaError, encode, schema, schema_name

METADATA = "waywiser"
"""Name of the MCAP metadata record that makes a file one of ours."""

CHUNK_BYTES = 64 * 1024
CHUNK_NS = 60 * 10**9
"""A chunk ends at this size, or when a message comes this much simulated time after its first."""

_ENCODING = "protobuf"
_SEQUENCE_MASK = 0xFFFFFFFF  # MCAP keeps 32 bits; the whole number is in the message
_LAST_STAMP_NS = (1 << 64) - 1
_NEVER_BY_ITSELF = 1 << 62  # the writer must not end chunks: the two rules above do
_MEDIA_TYPES = {".toml": "application/toml", ".json": "application/json", ".txt": "text/plain"}


class LogWriteError(OSError):
    """A log that cannot be written: which file, and what the system said."""


class RunLog:
    """One run's log.

    ``epoch_ns`` is the Unix time at which the run's simulated time is 0: viewers take stamps as
    Unix time. ``metadata`` becomes the record named :data:`METADATA`, with ``epoch_ns`` added.
    ``attachments`` are files by name (the scenario, say). Raises LogWriteError where the file
    cannot be made or written; the log is then closed, and what is on disk stays.
    """

    def __init__(
        self,
        path: str | Path,
        epoch_ns: int,
        metadata: Mapping[str, str],
        attachments: Mapping[str, bytes],
    ) -> None:
        self.path = Path(path)
        self._epoch_ns = epoch_ns
        self._chunk_bytes = 0
        self._chunk_began_ns: int | None = None
        try:
            self._file = self.path.open("wb")
        except OSError as error:
            raise self._cannot(error) from error
        self._writer = Writer(self._file, chunk_size=_NEVER_BY_ITSELF, enable_data_crcs=True)
        try:
            self._head(metadata, attachments)
        except OSError as error:
            raise self._give_up(error) from error

    def _head(self, metadata: Mapping[str, str], attachments: Mapping[str, bytes]) -> None:
        self._writer.start(library="waywiser")
        self._writer.add_metadata(METADATA, {**metadata, "epoch_ns": str(self._epoch_ns)})
        for name, data in attachments.items():
            media_type = _MEDIA_TYPES.get(Path(name).suffix, "application/octet-stream")
            self._writer.add_attachment(self._epoch_ns, self._epoch_ns, name, media_type, data)
        self._channels = {topic: self._register(topic) for topic in TOPICS}
        self._file.flush()

    def _register(self, topic: str) -> int:
        described = schema(topic).SerializeToString(deterministic=True)
        self._chunk_bytes += len(described)
        schema_id = self._writer.register_schema(schema_name(topic), _ENCODING, described)
        return self._writer.register_channel(topic, _ENCODING, schema_id)

    def write(self, sent: Sent) -> None:
        """Write one message. Raises LogWriteError, or SchemaError for one that does not fit."""
        if self._file.closed:
            raise LogWriteError(f"{self.path}: the log is closed")
        data = encode(sent)
        stamp_ns = self._epoch_ns + sent.said_ns
        if not 0 <= stamp_ns <= _LAST_STAMP_NS:
            raise SchemaError(f"{sent.topic}: said at {sent.said_ns} ns, outside of MCAP's time")
        try:
            self._end_chunk_before(sent.said_ns)
            self._writer.add_message(
                self._channels[sent.topic],
                log_time=stamp_ns,
                data=data,
                publish_time=stamp_ns,
                sequence=sent.sequence & _SEQUENCE_MASK,
            )
        except OSError as error:
            raise self._give_up(error) from error
        self._chunk_bytes += len(data)

    def _end_chunk_before(self, said_ns: int) -> None:
        if self._chunk_began_ns is None:
            self._chunk_began_ns = said_ns
        elif self._chunk_bytes >= CHUNK_BYTES or said_ns >= self._chunk_began_ns + CHUNK_NS:
            self._writer.flush()  # type: ignore[no-untyped-call]
            self._chunk_bytes = 0
            self._chunk_began_ns = said_ns

    def close(self) -> None:
        """Finish the file. Does nothing where it is closed. Raises LogWriteError."""
        if self._file.closed:
            return
        try:
            self._writer.finish()  # type: ignore[no-untyped-call]
            self._file.close()
        except OSError as error:
            raise self._give_up(error) from error

    def _give_up(self, error: OSError) -> LogWriteError:
        # what is still buffered cannot be written either; the file is closed all the same
        with suppress(OSError):
            self._file.close()
        return self._cannot(error)

    def _cannot(self, error: OSError) -> LogWriteError:
        return LogWriteError(f"{self.path}: cannot write the log: {error.strerror or error}")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()
