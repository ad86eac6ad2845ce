"""An MCAP file's own structure: chunks, checksums, index and summary, compared with each other.

The format: https://mcap.dev/spec. What is looked at here is what readers other than ours rely
on; what the run's messages say is the matter of :mod:`logs.checking`.
"""

from __future__ import annotations

import zlib
from dataclasses import dataclass, field
from pathlib import Path
from struct import Struct
from typing import IO

from mcap.opcode import Opcode
from mcap.records import (
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    McapRecord,
    Message,
    MessageIndex,
    Schema,
    Statistics,
)
from mcap.stream_reader import StreamReader, get_chunk_data_stream

from logs.reader import DAMAGE

_MAGIC_BYTES = 8
_CRC_BYTES = 4
_CHUNK_HEAD = Struct("<BQQQ")
_INDEX_HEAD = Struct("<BQH")
_MESSAGE_HEAD = Struct("<BQHIQ")
_RECORD_HEAD = 9


@dataclass
class Container:
    """What was found in a file; ``problem`` is why it could not be read to its end, if so.

    ``index_wrong`` and ``summary_wrong`` say where index or summary are not as the file is.
    """

    chunks: int = 0
    chunks_without_crc: int = 0
    data_crc: bool = False
    summary_crc: bool = False
    outside: int = 0
    messages: dict[int, int] = field(default_factory=dict)
    compressions: dict[str, int] = field(default_factory=dict)
    chunk_indexes: list[ChunkIndex] = field(default_factory=list)
    statistics: Statistics | None = None
    schemas: dict[int, Schema] = field(default_factory=dict)
    channels: dict[int, Channel] = field(default_factory=dict)
    index_entries: int = 0
    index_wrong: list[str] = field(default_factory=list)
    summary_wrong: list[str] = field(default_factory=list)
    problem: str = ""

    @property
    def number(self) -> int:
        """How many messages the chunks' indexes list."""
        return sum(self.messages.values())


def look_into(path: Path) -> Container:
    """Read a file's structure. Raises OSError where the file cannot be read."""
    found = Container()
    size = path.stat().st_size
    with path.open("rb") as file:
        stream = StreamReader(file, emit_chunks=True, validate_crcs=True, record_size_limit=size)
        try:
            _Walk(found).all(stream)
            _check_summary(found, file, size)
        except DAMAGE as error:
            found.problem = f"{type(error).__name__}: {error}"
    return found


class _Walk:
    """Goes through the records of a file."""

    def __init__(self, found: Container) -> None:
        self._found = found
        self._chunk = b""  # the records of the last one, for the indexes that follow it

    def all(self, stream: StreamReader) -> None:
        for record in stream.records:
            self._data(record)
            self._summary(record)

    def _data(self, record: McapRecord) -> None:
        found = self._found
        match record:
            case Chunk():
                found.chunks += 1
                found.chunks_without_crc += record.uncompressed_crc == 0
                name = record.compression or "none"
                found.compressions[name] = found.compressions.get(name, 0) + 1
                data, length = get_chunk_data_stream(record, validate_crc=True)
                self._chunk = data.read(length)
            case Message():
                found.outside += 1
            case MessageIndex():
                self._index(record)
            case DataEnd():
                found.data_crc = record.data_section_crc != 0

    def _index(self, index: MessageIndex) -> None:
        found = self._found
        count = found.messages.get(index.channel_id, 0)
        found.messages[index.channel_id] = count + len(index.records)
        found.index_entries += len(index.records)
        wrong = sum(not self._points_right(index.channel_id, *entry) for entry in index.records)
        if wrong:
            found.index_wrong.append(
                f"chunk {found.chunks}: {wrong} index entries of channel {index.channel_id} "
                f"point at something else"
            )

    def _points_right(self, channel: int, log_ns: int, offset: int) -> bool:
        if offset + _MESSAGE_HEAD.size > len(self._chunk):
            return False
        opcode, _, its_channel, _, its_ns = _MESSAGE_HEAD.unpack_from(self._chunk, offset)
        return (opcode, its_channel, its_ns) == (Opcode.MESSAGE, channel, log_ns)

    def _summary(self, record: McapRecord) -> None:
        found = self._found
        match record:
            case ChunkIndex():
                found.chunk_indexes.append(record)
            case Statistics():
                found.statistics = record
            case Schema():
                found.schemas[record.id] = record
            case Channel():
                found.channels[record.id] = record


def _check_summary(found: Container, file: IO[bytes], size: int) -> None:
    """Compare the summary of a whole file with the file."""
    footer = _footer(file, size)
    if footer.summary_start:
        file.seek(footer.summary_start)
        covered = file.read(size - _MAGIC_BYTES - _CRC_BYTES - footer.summary_start)
        found.summary_crc = footer.summary_crc != 0
        if found.summary_crc and zlib.crc32(covered) != footer.summary_crc:
            found.summary_wrong.append("the summary's checksum is not that of its bytes")
    if len(found.chunk_indexes) != found.chunks:
        found.index_wrong.append(
            f"the index lists {len(found.chunk_indexes)} chunks, the file has {found.chunks}"
        )
    for number, index in enumerate(found.chunk_indexes, start=1):
        _check_chunk_index(found, file, number, index)
    _check_statistics(found)


def _footer(file: IO[bytes], size: int) -> Footer:
    length = _RECORD_HEAD + 8 + 8 + _CRC_BYTES
    file.seek(size - _MAGIC_BYTES - length)
    _, _, summary, offsets, crc = Struct("<BQQQI").unpack(file.read(length))
    return Footer(summary_start=summary, summary_offset_start=offsets, summary_crc=crc)


def _check_chunk_index(found: Container, file: IO[bytes], number: int, index: ChunkIndex) -> None:
    file.seek(index.chunk_start_offset)
    opcode, length, first_ns, last_ns = _CHUNK_HEAD.unpack(file.read(_CHUNK_HEAD.size))
    there = (opcode, length + _RECORD_HEAD, first_ns, last_ns)
    listed = (
        *(Opcode.CHUNK, index.chunk_length),
        *(index.message_start_time, index.message_end_time),
    )
    if there != listed:
        found.index_wrong.append(f"chunk {number} is not where, or not what, the index says")
    for channel, offset in index.message_index_offsets.items():
        file.seek(offset)
        opcode, _, its_channel = _INDEX_HEAD.unpack(file.read(_INDEX_HEAD.size))
        if (opcode, its_channel) != (Opcode.MESSAGE_INDEX, channel):
            found.index_wrong.append(f"chunk {number}: no index of channel {channel} at {offset}")


def _check_statistics(found: Container) -> None:
    statistics = found.statistics
    if statistics is None:
        return
    counted = {
        "messages": (statistics.message_count, found.number),
        "chunks": (statistics.chunk_count, found.chunks),
        "channels": (statistics.channel_count, len(found.channels)),
        "schemas": (statistics.schema_count, len(found.schemas)),
        "messages by channel": (statistics.channel_message_counts, found.messages),
    }
    for what, (listed, there) in counted.items():
        if listed != there:
            found.summary_wrong.append(f"{what}: the statistics say {listed}, the file {there}")
