"""An MCAP file in chunks whose bytes depend on nothing but what was put into it.

The format is that of https://mcap.dev/spec; all records but messages are packed by the mcap
package, whose own writer takes twice as long for a message and keeps its unfinished chunk to
itself. A chunk ends by size or by the times of its messages, never by the wall clock.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Mapping
from typing import BinaryIO, Protocol

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from logs.tail import Tail

CHUNK_BYTES = 64 * 1024
CHUNK_NS = 60 * 10**9
"""A chunk ends at this size, or when a message comes this much simulated time after its first."""

MAGIC = b"\x89MCAP0\r\n"
_MESSAGE = struct.Struct("<BQHIQQ")
_MESSAGE_FIELDS = _MESSAGE.size - 9  # what a message's record holds beside its data
_INDEX = struct.Struct("<BQHI")
_FOOTER = struct.Struct("<BQQQ")
_FOOTER_LENGTH = 20
_NEVER = 1 << 64


class _Record(Protocol):
    def write(self, builder: RecordBuilder) -> None: ...


def _packed(*records: _Record) -> bytes:
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    data: bytes = builder.end()  # type: ignore[no-untyped-call]
    return data


class McapFile:
    """Writes one file: the head, then schemas and channels, messages, and at last ``finish``.

    ``tail`` keeps the unfinished chunk safe, as far as :meth:`keep` was called.
    Every method may raise OSError.
    """

    def __init__(self, file: BinaryIO, tail: Tail | None = None) -> None:
        self._file = file
        self._tail = tail
        self._offset = 0
        self._crc = 0
        self._compress = zstandard.ZstdCompressor().compress
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._chunks: list[ChunkIndex] = []
        self._attachments: list[AttachmentIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._counts: dict[int, int] = {}
        self._new_chunk()

    def _new_chunk(self) -> None:
        self._body: list[bytes] = []
        self._size = 0
        self._kept = 0
        self._index: dict[int, list[int]] = {}
        self._until_ns = _NEVER

    def _put(self, data: bytes) -> None:
        self._crc = zlib.crc32(data, self._crc)
        self._file.write(data)
        self._offset += len(data)

    def head(self, library: str) -> None:
        """Begin the file."""
        self._put(MAGIC + _packed(Header(profile="", library=library)))

    def metadata(self, name: str, data: Mapping[str, str]) -> None:
        """Add a metadata record."""
        packed = _packed(Metadata(name=name, metadata=dict(data)))
        self._metadata.append(MetadataIndex(offset=self._offset, length=len(packed), name=name))
        self._put(packed)

    def attachment(self, attachment: Attachment) -> None:
        """Add an attachment."""
        packed = _packed(attachment)
        self._attachments.append(
            AttachmentIndex(
                offset=self._offset,
                length=len(packed),
                create_time=attachment.create_time,
                log_time=attachment.log_time,
                data_size=len(attachment.data),
                name=attachment.name,
                media_type=attachment.media_type,
            )
        )
        self._put(packed)

    def flush(self) -> None:
        """Hand to the system what is not part of the unfinished chunk."""
        self._file.flush()

    def schema(self, schema: Schema) -> None:
        """Add a schema, under its own number, to the chunk in progress."""
        self._schemas[schema.id] = schema
        self._add_to_chunk(_packed(schema))

    def channel(self, channel: Channel) -> None:
        """Add a channel, under its own number, to the chunk in progress."""
        self._channels[channel.id] = channel
        self._add_to_chunk(_packed(channel))

    def _add_to_chunk(self, record: bytes) -> None:
        self._body.append(record)
        self._size += len(record)

    def message(self, channel: int, sequence: int, stamp_ns: int, data: bytes) -> None:
        """Add a message said at ``stamp_ns``; ends the chunk before it if that is full or old."""
        if stamp_ns >= self._until_ns or (self._size >= CHUNK_BYTES and self._index):
            self.end_chunk()
        length = _MESSAGE_FIELDS + len(data)
        record = _MESSAGE.pack(Opcode.MESSAGE, length, channel, sequence, stamp_ns, stamp_ns) + data
        if not self._index:
            self._until_ns = stamp_ns + CHUNK_NS
        index = self._index.get(channel)
        if index is None:
            self._index[channel] = index = []
        index += (stamp_ns, self._size)
        self._body.append(record)
        self._size += len(record)

    def keep(self) -> None:
        """Have the tail keep the messages that it has not got yet."""
        new = self._body[self._kept :]
        if self._tail is None or not self._index or not new:
            return
        if self._kept == 0:
            self._tail.begin(self._offset)
        self._tail.add(b"".join(new))
        self._kept = len(self._body)

    def end_chunk(self) -> None:
        """Write the chunk in progress, if it has a message, and hand it to the system."""
        if not self._index:
            return
        body = b"".join(self._body)
        compressed = self._compress(body)
        first_ns = min(min(index[::2]) for index in self._index.values())
        last_ns = max(max(index[::2]) for index in self._index.values())
        chunk = Chunk(
            compression="zstd",
            data=compressed,
            message_start_time=first_ns,
            message_end_time=last_ns,
            uncompressed_crc=zlib.crc32(body),
            uncompressed_size=len(body),
        )
        began, packed = self._offset, _packed(chunk)
        self._put(packed)
        offsets, index_length = self._put_index()
        self._file.flush()
        self._chunks.append(
            ChunkIndex(
                message_start_time=first_ns,
                message_end_time=last_ns,
                chunk_start_offset=began,
                chunk_length=len(packed),
                message_index_offsets=offsets,
                message_index_length=index_length,
                compression="zstd",
                compressed_size=len(compressed),
                uncompressed_size=len(body),
            )
        )
        if self._tail is not None:
            self._tail.clear()
        self._new_chunk()

    def _put_index(self) -> tuple[dict[int, int], int]:
        """Write where each channel's messages are in the chunk; the offsets, the length of all."""
        began = self._offset
        offsets: dict[int, int] = {}
        for channel, index in self._index.items():
            offsets[channel] = self._offset
            entries = struct.pack(f"<{len(index)}Q", *index)
            length = len(entries) + _INDEX.size - 9
            self._put(_INDEX.pack(Opcode.MESSAGE_INDEX, length, channel, len(entries)) + entries)
            self._counts[channel] = self._counts.get(channel, 0) + len(index) // 2
        return offsets, self._offset - began

    def finish(self) -> None:
        """End the file with its summary. The file stays open."""
        self.end_chunk()
        self._put(_packed(DataEnd(self._crc)))
        began = self._offset
        summary = b""
        offsets: list[SummaryOffset] = []
        for opcode, records in self._summary():
            if packed := _packed(*records):
                offsets.append(SummaryOffset(opcode, began + len(summary), len(packed)))
                summary += packed
        offsets_began = began + len(summary)
        summary += _packed(*offsets)
        footer = _FOOTER.pack(Opcode.FOOTER, _FOOTER_LENGTH, began, offsets_began)
        crc = zlib.crc32(footer, zlib.crc32(summary))
        self._put(summary + _packed(Footer(began, offsets_began, crc)) + MAGIC)
        self._file.flush()

    def _summary(self) -> list[tuple[Opcode, list[_Record]]]:
        chunks = self._chunks
        statistics = Statistics(
            attachment_count=len(self._attachments),
            channel_count=len(self._channels),
            channel_message_counts=self._counts,
            chunk_count=len(chunks),
            message_count=sum(self._counts.values()),
            metadata_count=len(self._metadata),
            message_start_time=min((c.message_start_time for c in chunks), default=0),
            message_end_time=max((c.message_end_time for c in chunks), default=0),
            schema_count=len(self._schemas),
        )
        return [
            (Opcode.SCHEMA, list(self._schemas.values())),
            (Opcode.CHANNEL, list(self._channels.values())),
            (Opcode.STATISTICS, [statistics]),
            (Opcode.CHUNK_INDEX, [*chunks]),
            (Opcode.ATTACHMENT_INDEX, [*self._attachments]),
            (Opcode.METADATA_INDEX, [*self._metadata]),
        ]
