"""Reading a run's log in one sequential pass, whole or cut off.

The reader that MCAP recommends needs the index at the end of the file, which a run that was
killed never wrote; reading from the start yields all that was finished.
"""

from __future__ import annotations

import struct
from collections.abc import Collection, Iterator
from pathlib import Path
from types import TracebackType
from typing import IO, TYPE_CHECKING, Self, TypeAlias

import zstandard
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.message import DecodeError
from mcap.exceptions import EndOfFile, InvalidMagic, McapError
from mcap.records import Attachment, Channel, Chunk, Header, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import MAGIC_SIZE, get_chunk_data_stream

from bus.topics import TOPICS
from bus.wire import Sent
from logs.records import SequentialReader, chunk_records
from logs.run_log import METADATA
from logs.schema import SchemaError, decode, schema, schema_name

if TYPE_CHECKING:
    from logs.scan import Block

_TOO_LARGE = (MemoryError, OverflowError)  # what a damaged length asks for
DAMAGE = (McapError, ValueError, struct.error, zstandard.ZstdError, *_TOO_LARGE)
"""What reading raises where the file is cut or its bytes are not what was written."""

_AT_ONCE_BYTES = 1 << 19

RawSent: TypeAlias = tuple[str, int, bytes]
"""A message as it stands in the file: topic, when it was said in ns, protobuf bytes."""


class LogReadError(ValueError):
    """A file that is not the log of a run: which one, what was found, what was expected."""


def read_run(path: str | Path, topics: Collection[str] | None = None) -> RunReader:
    """Open a log. Raises LogReadError if it is not the log of a run.

    ``topics``: decode and yield these only (None: all). The others are counted all the same.
    """
    unknown = [topic for topic in topics or () if topic not in TOPICS]
    if unknown:
        raise LogReadError(f"no topic {unknown[0]!r}; the topics are {', '.join(TOPICS)}")
    return RunReader(Path(path), None if topics is None else frozenset(topics))


class RunReader:
    """An iterator over a log's messages in the order in which they were written.

    ``metadata``, ``attachments`` and ``epoch_ns``, the stamp of simulated time 0, are there at
    once. When the iteration is over, ``truncated`` says whether the file ended before its end,
    ``problem`` how; ``counts`` how many messages of each topic were read, and ``missing`` how
    many of each source are not there though later ones are. Raises LogReadError, while
    iterating, if a topic was recorded with other fields.
    """

    def __init__(self, path: Path, topics: frozenset[str] | None) -> None:
        self.path = path
        self.metadata: dict[str, str] = {}
        self.attachments: dict[str, bytes] = {}
        self.truncated = False
        self.problem = ""
        self.counts: dict[str, int] = dict.fromkeys(TOPICS, 0)
        self._topics = topics
        self._named: dict[int, Schema] = {}
        self._topic_of: dict[int, str] = {}
        self._highest: dict[str, int] = {}
        self._last_stamp_ns = -1
        self.epoch_ns = 0
        self._file = self._open()
        try:
            self._records = self._past_head()
        except LogReadError:
            self._file.close()
            raise

    @property
    def read(self) -> int:
        """How many messages were read, decoded or not."""
        return sum(self.counts.values())

    @property
    def last_said_ns(self) -> int:
        """When the last of the messages read so far was said; 0 if there are none."""
        return max(0, self._last_stamp_ns - self.epoch_ns)

    @property
    def missing(self) -> dict[str, int]:
        """How many messages of each source are missing before its last one; whole: empty."""
        last: dict[str, int] = {}
        found: dict[str, int] = {}
        for topic, highest in self._highest.items():
            source = TOPICS[topic].publisher
            last[source] = max(last.get(source, -1), highest)
            found[source] = found.get(source, 0) + self.counts[topic]
        gaps = {source: last[source] + 1 - found[source] for source in last}
        return {source: gap for source, gap in gaps.items() if gap > 0}

    def __iter__(self) -> Iterator[Sent]:
        wanted = self._topics
        for topic, _, data in self.raw():
            if wanted is None or topic in wanted:
                yield self._decoded(topic, data)

    def raw(self) -> Iterator[RawSent]:
        """All messages as (topic, when said in ns, protobuf bytes), not decoded.

        Instead of iterating over the reader itself; ends and raises as that does.
        """
        try:
            for record in self._records:
                if isinstance(record, Chunk):
                    yield from self._chunk(record)
                elif isinstance(record, Message):
                    raise ValueError("a message outside of the chunks")
        except LogReadError:
            raise
        except DAMAGE as error:
            self._stop(error)
        finally:
            self._file.close()

    def close(self) -> None:
        """Close the file before its end."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _open(self) -> IO[bytes]:
        try:
            return self.path.open("rb")
        except OSError as error:
            raise LogReadError(
                f"{self.path}: cannot be read: {error.strerror}; expected the log of a run"
            ) from error

    def _past_head(self) -> Iterator[McapRecord]:
        """Read up to the end of metadata and attachments; what is left to read."""
        size = self.path.stat().st_size
        stream = SequentialReader(
            self._file, emit_chunks=True, validate_crcs=True, record_size_limit=size
        )
        records = stream.records
        try:
            for record in records:
                if isinstance(record, Metadata) and record.name == METADATA:
                    self.metadata = dict(record.metadata)
                    self.epoch_ns = int(self.metadata.get("epoch_ns", ""))
                    return self._past_attachments(records)
                if not isinstance(record, (Header, Metadata)):
                    break
        except DAMAGE as error:
            raise self._not_a_log(error, size) from error
        raise LogReadError(
            f"{self.path}: found an MCAP file of something else, "
            f"expected one that begins with metadata {METADATA!r}"
        )

    def _past_attachments(self, records: Iterator[McapRecord]) -> Iterator[McapRecord]:
        try:
            for record in records:
                if not isinstance(record, Attachment):
                    return _with_first(record, records)
                self.attachments[record.name] = record.data
        except DAMAGE as error:
            self._stop(error)
        return iter(())

    def _not_a_log(self, error: Exception, size: int) -> LogReadError:
        if size == 0:
            found = "an empty file"
        elif isinstance(error, InvalidMagic) or size < MAGIC_SIZE:
            found = "a file that is not MCAP"
        else:
            found = f"an MCAP file that ends or is damaged before its metadata ({size} bytes)"
        return LogReadError(f"{self.path}: found {found}, expected the log of a run")

    def _stop(self, error: Exception) -> None:
        self.truncated = True
        if isinstance(error, (EndOfFile, struct.error)):
            how = "it ends without a footer"
        else:
            how = f"a record is cut or damaged ({type(error).__name__}: {error})"
        self.problem = f"{how}; {self.read} messages could be read"

    def blocks(self) -> Iterator[Block]:
        """All messages as columns of numbers, those of some chunks at a time.

        Instead of iterating over the reader itself; ends and raises as that does.
        """
        from logs.scan import ScanError, Scanner  # here, since numba takes half a second

        scanner = Scanner(self._name, self._topic_of)
        try:
            for data in self._bodies():
                block = scanner.block(data)
                self._count(block)
                yield block
        except ScanError as error:  # its checksum is right: it was written like that
            raise LogReadError(f"{self.path}: {error}") from error
        finally:
            self._file.close()

    def _bodies(self) -> Iterator[bytes]:
        """What is in the chunks, several in a row, which saves as much work."""
        held: list[bytes] = []
        size = 0
        try:
            for record in self._records:
                if isinstance(record, Chunk):
                    stream, length = get_chunk_data_stream(record, validate_crc=True)
                    held.append(stream.read(length))
                    size += length
                elif isinstance(record, Message):
                    raise ValueError("a message outside of the chunks")
                if size >= _AT_ONCE_BYTES:
                    yield b"".join(held)
                    held, size = [], 0
        except DAMAGE as error:
            yield b"".join(held)
            self._stop(error)
        else:
            yield b"".join(held)

    def _count(self, block: Block) -> None:
        for topic, messages in block.by_topic:
            self.counts[topic] += len(messages.sequence)
            highest = int(messages.sequence.max())
            self._highest[topic] = max(highest, self._highest.get(topic, -1))
            self._last_stamp_ns = max(self._last_stamp_ns, int(messages.stamp_ns.max()))

    def _chunk(self, chunk: Chunk) -> Iterator[RawSent]:
        # only what a checksum covers is believed, hence nothing outside of chunks
        for record in chunk_records(chunk):
            if not isinstance(record, tuple):
                self._name(record)
                continue
            channel, sequence, stamp_ns, data = record
            topic = self._topic_of.get(channel)
            if topic is None:  # a view for a viewer, not something that was said
                continue
            self.counts[topic] += 1
            if stamp_ns > self._last_stamp_ns:
                self._last_stamp_ns = stamp_ns
            if sequence > self._highest.get(topic, -1):
                self._highest[topic] = sequence
            yield topic, stamp_ns - self.epoch_ns, data

    def _name(self, record: Schema | Channel) -> None:
        if isinstance(record, Schema):
            self._named[record.id] = record
        elif record.topic in TOPICS:
            self._check(record.topic, self._named.get(record.schema_id))
            self._topic_of[record.id] = record.topic

    def _decoded(self, topic: str, data: bytes) -> Sent:
        try:
            return decode(topic, data)
        except SchemaError as error:
            raise LogReadError(f"{self.path}: {error}") from error

    def _check(self, topic: str, found: Schema | None) -> None:
        if found is not None and _same(found.data, schema(topic)):
            return
        raise LogReadError(
            f"{self.path}: found {topic} recorded as another {found.name if found else 'nothing'}, "
            f"expected {schema_name(topic)} with the fields that this version of the program knows"
        )


def _with_first(first: McapRecord, rest: Iterator[McapRecord]) -> Iterator[McapRecord]:
    yield first
    yield from rest


def _same(data: bytes, expected: FileDescriptorSet) -> bool:
    try:
        return bool(FileDescriptorSet.FromString(data) == expected)
    except DecodeError:
        return False
