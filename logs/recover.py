"""Putting together what a run that was killed has left: its log and the tail beside it.

What is kept is copied bit for bit, so a recovered log equals what the recorder would have
written had the run ended there. Only what a checksum covers is believed. A damaged chunk is
left out and what comes after it is kept.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from mcap.exceptions import EndOfFile
from mcap.records import Attachment, Channel, Chunk, Header, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import StreamReader

from bus.topics import TOPICS
from logs.mcap_file import McapFile
from logs.reader import DAMAGE, LogReadError, read_run
from logs.records import RawMessage, chunk_records
from logs.run_log import LogWriteError
from logs.tail import FoundTail, read_tail


@dataclass(frozen=True)
class Recovered:
    """What was found in a log, and what is missing.

    ``messages`` were kept, ``from_tail`` of them from the tail; views are not counted.
    ``closed`` says whether the log had been closed, ``ended`` whether it says how the run
    ended, ``damage`` what could not be read, and ``missing`` how many messages of each source
    are not there though later ones are.
    """

    messages: int
    from_tail: int
    closed: bool
    ended: bool
    damage: tuple[str, ...]
    missing: dict[str, int]

    @property
    def whole(self) -> bool:
        """Whether the run is all there, from its beginning to its end."""
        return self.ended and not self.damage and not self.missing


def recover(log: str | Path, out: str | Path) -> Recovered:
    """Write all that can be read of a log into a whole, indexed one.

    Raises LogReadError if ``log`` is not the log of a run, or is the same file as ``out``;
    LogWriteError if ``out`` cannot be written.
    """
    log, out = Path(log), Path(out)
    read_run(log).close()
    if out.exists() and out.samefile(log):
        raise LogReadError(f"{out}: found the log itself, expected another file to write to")
    try:
        with log.open("rb") as found, out.open("wb") as file:
            rescue = _Rescue(McapFile(file), log.stat().st_size)
            rescue.copy_log(found)
            tail = read_tail(log)
            if tail is not None:
                rescue.copy_tail(tail)
            rescue.finish()
    except OSError as error:
        raise LogWriteError(f"{out}: cannot write the log: {error.strerror or error}") from error
    return rescue.recovered(out)


class _Rescue:
    """Copies records into a new file, and keeps account of them."""

    def __init__(self, out: McapFile, size: int) -> None:
        self._out = out
        self._size = size
        self._topic_of: dict[int, str] = {}
        self._copied: dict[int, None] = {}
        self._messages = 0
        self._from_tail = 0
        self._unreadable = 0
        self._closed = False
        self._damage: list[str] = []

    def copy_log(self, file: BinaryIO) -> None:
        """Copy all that is whole, up to where the file ends or makes no sense any more."""
        stream = StreamReader(file, emit_chunks=True, record_size_limit=self._size)
        at = 0
        try:
            for record in stream.records:
                self._copy(record, at)
                at = file.tell()
            self._closed = True
        except EndOfFile:
            pass  # the log was not closed
        except DAMAGE as error:
            if file.read(1):  # else it is its last record that is cut
                self._damage.append(f"from byte {at} on, the log makes no sense: {_how(error)}")

    def _copy(self, record: McapRecord, at: int) -> None:
        match record:
            case Header():
                self._out.head(record.library)
            case Metadata():
                self._out.metadata(record.name, record.metadata)
            case Attachment():
                self._out.attachment(record)
            case Chunk():
                self._copy_chunk(record, at)
            case Message():
                self._damage.append(f"a message outside of the chunks at byte {at}")

    def _copy_chunk(self, chunk: Chunk, at: int) -> None:
        try:
            records = list(chunk_records(chunk))
        except DAMAGE as error:
            self._damage.append(f"the chunk at byte {at} is damaged: {_how(error)}")
            return
        self._copied[at] = None
        self._take(records)

    def copy_tail(self, tail: FoundTail) -> None:
        """Copy the tail, unless its chunk was finished after all."""
        if tail.offset in self._copied:
            return
        before = self._messages
        for frame in tail.frames:
            self._take(chunk_records(_chunk_of(frame)))
        self._from_tail = self._messages - before

    def _take(self, records: Iterable[RawMessage | Schema | Channel]) -> None:
        for record in records:
            if isinstance(record, tuple):
                self._take_message(*record)
            elif isinstance(record, Schema):
                self._out.schema(record)
            else:
                self._topic_of[record.id] = record.topic
                self._out.channel(record)

    def _take_message(self, channel: int, sequence: int, stamp_ns: int, data: bytes) -> None:
        topic = self._topic_of.get(channel)
        if topic is None:  # it was named in a chunk that is damaged
            self._unreadable += 1
            return
        self._messages += topic in TOPICS
        self._out.message(channel, sequence, stamp_ns, data)

    def finish(self) -> None:
        """Close the new file."""
        self._out.finish()
        if self._unreadable:
            self._damage.append(f"{self._unreadable} messages whose channels are lost")

    def recovered(self, out: Path) -> Recovered:
        """What the new file holds, as a reader finds it."""
        with read_run(out, ()) as reader:
            for _ in reader:
                pass
        return Recovered(
            messages=self._messages,
            from_tail=self._from_tail,
            closed=self._closed,
            ended=reader.counts["run/ended"] > 0,
            damage=tuple(self._damage),
            missing=reader.missing,
        )


def _chunk_of(frame: bytes) -> Chunk:
    """A tail's frame, which its own checksum covers, as a chunk."""
    return Chunk(
        compression="",
        data=frame,
        message_start_time=0,
        message_end_time=0,
        uncompressed_crc=0,
        uncompressed_size=len(frame),
    )


def _how(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}"
