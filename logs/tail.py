"""The tail of a log: what is not in a finished chunk yet, in a file beside it.

A chunk of RUN.mcap is written when it is full, which may take a minute; until then its records
are in RUN.mcap.tail, handed to the system as soon as they are written, so that they outlive the
process. The file begins with a head (what it is, and the offset in RUN.mcap at which the
chunk will begin), then come frames (length, CRC-32, MCAP records). It is emptied when its chunk
is in RUN.mcap and removed when the log is closed.
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from io import FileIO
from pathlib import Path

_HEAD = struct.Struct("<16sQ")
_MAGIC = b"waywiser tail 1\n"
_FRAME = struct.Struct("<II")


def tail_path(log: Path) -> Path:
    """The file beside a log that holds its unfinished chunk."""
    return Path(f"{log}.tail")


class Tail:
    """Writes the tail of one log. What an earlier run left there is removed at once.

    The file is made when there is something to keep. Every method may raise OSError.
    """

    def __init__(self, log: Path) -> None:
        self._path = tail_path(log)
        self._path.unlink(missing_ok=True)
        self._file: FileIO | None = None

    def begin(self, offset: int) -> None:
        """Begin a chunk that will be at ``offset``."""
        if self._file is None:
            self._file = FileIO(self._path, "ab")
        self._write(_HEAD.pack(_MAGIC, offset))

    def add(self, records: bytes) -> None:
        """Keep records of the chunk that was begun."""
        self._write(_FRAME.pack(len(records), zlib.crc32(records)) + records)

    def _write(self, data: bytes) -> None:
        # no buffer: what is written belongs to the system, whatever becomes of this process
        assert self._file is not None
        written = self._file.write(data)
        while written < len(data):  # a disk that fills up takes a part, then says why
            written += self._file.write(data[written:])

    def clear(self) -> None:
        """The chunk is in the log: forget it."""
        if self._file is not None:
            self._file.truncate(0)

    def close(self) -> None:
        """Leave the file for :mod:`logs.recover`."""
        if self._file is not None:
            self._file.close()

    def remove(self) -> None:
        """The log is whole: nothing is left to keep."""
        self.close()
        self._path.unlink(missing_ok=True)


@dataclass(frozen=True)
class FoundTail:
    """What a tail holds: the ``offset`` of its chunk, the frames before any damage.

    ``cut_bytes`` are left at the end that are no whole frame.
    """

    offset: int
    frames: tuple[bytes, ...]
    cut_bytes: int


def read_tail(log: Path) -> FoundTail | None:
    """The tail beside a log, or None where there is none. Raises OSError if it is unreadable."""
    try:
        data = tail_path(log).read_bytes()
    except FileNotFoundError:
        return None
    if len(data) < _HEAD.size:
        return None
    magic, offset = _HEAD.unpack_from(data)
    if magic != _MAGIC:
        return None
    frames: list[bytes] = []
    at = _HEAD.size
    while (frame := _frame(data, at)) is not None:
        frames.append(frame)
        at += _FRAME.size + len(frame)
    return FoundTail(offset, tuple(frames), len(data) - at)


def _frame(data: bytes, at: int) -> bytes | None:
    if at + _FRAME.size > len(data):
        return None
    length, crc = _FRAME.unpack_from(data, at)
    frame = data[at + _FRAME.size : at + _FRAME.size + length]
    return frame if len(frame) == length and zlib.crc32(frame) == crc else None
