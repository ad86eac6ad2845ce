"""The records of one MCAP chunk, taken apart with as little work as that needs.

The mcap package makes an object of every record; a message here is a tuple, its data untouched,
so that a reader may count a message without paying for it.
"""

from __future__ import annotations

from collections.abc import Iterator
from io import BytesIO
from struct import Struct
from typing import TypeAlias

from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, McapRecord, Schema
from mcap.stream_reader import StreamReader, get_chunk_data_stream

RawMessage: TypeAlias = tuple[int, int, int, bytes]
"""A message in its chunk: channel, sequence (its low 32 bits), log time in ns, data."""

_HEAD = Struct("<BQ")
_MESSAGE = Struct("<HIQQ")


def chunk_records(chunk: Chunk) -> Iterator[RawMessage | Schema | Channel]:
    """What a chunk holds, in its order.

    Raises what reading a damaged chunk raises: ValueError (a checksum that is not right, a
    record longer than the chunk), struct.error, zstandard.ZstdError.
    """
    stream, length = get_chunk_data_stream(chunk, validate_crc=True)
    data = stream.read(length)
    head, message = _HEAD.unpack_from, _MESSAGE.unpack_from
    at = 0
    while at < length:
        opcode, size = head(data, at)
        begin = at + _HEAD.size
        at = begin + size
        if at > length:
            raise ValueError(f"a record of {size} bytes in a chunk with {length - begin} left")
        if opcode == Opcode.MESSAGE:
            channel, sequence, log_ns, _ = message(data, begin)
            yield channel, sequence, log_ns, data[begin + _MESSAGE.size : at]
        elif opcode == Opcode.SCHEMA:
            yield Schema.read(ReadDataStream(BytesIO(data[begin:at])))
        elif opcode == Opcode.CHANNEL:
            yield Channel.read(ReadDataStream(BytesIO(data[begin:at])))


class SequentialReader(StreamReader):
    """Passes over the indexes after each chunk: taking them apart takes longer than all else."""

    def _read_record(self, opcode: int, length: int) -> McapRecord | None:
        if opcode == Opcode.MESSAGE_INDEX:
            self._stream.read(length)
            return None
        return super()._read_record(opcode, length)
