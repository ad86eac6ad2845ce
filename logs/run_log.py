"""Writing a run down as MCAP, so that the file depends on nothing but what was said.

Two runs that say the same leave the same bytes: every channel is registered at the start in
the order of the tables, attachments carry the epoch as their time, and chunks end by size
or by simulated time, never by the wall clock. A run that is killed leaves all finished chunks
in its log and all else in the tail beside it; :mod:`logs.recover` puts them together.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Self

from mcap.records import Attachment, Channel, Schema

from bus.topics import TOPICS
from bus.wire import Sent
from logs.mcap_file import McapFile
from logs.schema import SchemaError, schema, schema_name
from logs.tail import Tail
from logs.transcode import Taken, taken
from logs.views import VIEWS, Views
from logs.views.views import view_schema

METADATA = "waywiser"
"""Name of the MCAP metadata record that makes a file one of ours."""

LIBRARY = "waywiser"
"""What the header says wrote the file."""

_ENCODING = "protobuf"
_SEQUENCE_MASK = 0xFFFFFFFF  # MCAP keeps 32 bits; the whole number is in the message
_LAST_STAMP_NS = (1 << 64) - 1
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
        self._views = Views(epoch_ns)
        self._tail: Tail | None = None
        try:
            self._file = self.path.open("wb")
        except OSError as error:
            raise self._cannot(error) from error
        try:
            if self.path.is_file():  # what is written to a device or a pipe cannot be recovered
                self._tail = Tail(self.path)
            self._mcap = McapFile(self._file, self._tail)
            self._head(metadata, attachments)
        except OSError as error:
            raise self._give_up(error) from error

    def _head(self, metadata: Mapping[str, str], attachments: Mapping[str, bytes]) -> None:
        self._mcap.head(LIBRARY)
        self._mcap.metadata(METADATA, {**metadata, "epoch_ns": str(self._epoch_ns)})
        for name, data in attachments.items():
            media_type = _MEDIA_TYPES.get(Path(name).suffix, "application/octet-stream")
            self._mcap.attachment(
                Attachment(self._epoch_ns, self._epoch_ns, name, media_type, data)
            )
        self._channels: dict[str, int] = {}
        for topic in TOPICS:
            described = schema(topic).SerializeToString(deterministic=True)
            self._register(topic, schema_name(topic), described)
        for topic in VIEWS:
            self._register(topic, *view_schema(topic))
        self._mcap.flush()

    def _register(self, topic: str, name: str, described: bytes) -> None:
        number = len(self._channels) + 1
        self._mcap.schema(Schema(id=number, data=described, encoding=_ENCODING, name=name))
        self._mcap.channel(Channel(number, topic, _ENCODING, {}, number))
        self._channels[topic] = number

    def write(self, sent: Sent) -> None:
        """Write one message and its views; what is written outlives this process.

        Raises LogWriteError, or SchemaError for a message that does not fit.
        """
        self.record([taken(sent)])

    def record(self, entries: Sequence[Taken]) -> None:
        """Write messages and their views; all of them outlive this process when it returns.

        Raises LogWriteError, or SchemaError for a message that does not fit.
        """
        if self._file.closed:
            raise LogWriteError(f"{self.path}: the log is closed")
        try:
            for entry in entries:
                self._add(entry)
            self._mcap.keep()
        except OSError as error:
            raise self._give_up(error) from error

    def _add(self, entry: Taken) -> None:
        stamp_ns = self._epoch_ns + entry.said_ns
        if not 0 <= stamp_ns <= _LAST_STAMP_NS:
            raise SchemaError(f"{entry.topic}: said at {entry.said_ns} ns, outside of MCAP's time")
        sequence = entry.id[1] & _SEQUENCE_MASK
        self._mcap.message(self._channels[entry.topic], sequence, stamp_ns, entry.record)
        if self._views.shows(entry.topic, entry.said_ns):
            for topic, view in self._views.of(entry.sent):
                self._mcap.message(self._channels[topic], sequence, stamp_ns, view)

    def close(self) -> None:
        """Finish the file and remove its tail. Does nothing where it is closed.

        Raises LogWriteError.
        """
        if self._file.closed:
            return
        try:
            self._mcap.finish()
            self._file.close()
            if self._tail is not None:
                self._tail.remove()
        except OSError as error:
            raise self._give_up(error) from error

    def _give_up(self, error: OSError) -> LogWriteError:
        # what is still buffered cannot be written either; the files are closed all the same
        with suppress(OSError):
            self._file.close()
        if self._tail is not None:
            self._tail.close()
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
