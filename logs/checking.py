"""Whether a log is whole, and whether the viewers will read it.

Evidence comes before the verdict: what is missing makes it *inconclusive*, never good. What is
there but contradicts itself, or keeps a viewer from reading it, makes it *wrong*.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.message import DecodeError
from mcap.records import Channel, Schema

from logs.analysis import PROCESS_LOST
from logs.container import Container, look_into
from logs.reader import LogReadError
from logs.run_check import RunFacts, run_facts

GOOD, WRONG, INCONCLUSIVE = "good", "wrong", "inconclusive"

NS_PER_S = 10**9
UNIX_FROM_NS = 946_684_800 * NS_PER_S
UNIX_UNTIL_NS = 4_102_444_800 * NS_PER_S
"""Stamps of the years 2000 to 2100: what a viewer shows as a date that is one."""

COMPRESSIONS = ("zstd", "lz4", "none")


@dataclass(frozen=True)
class Check:
    """One thing that was looked at: how much of it, what of it is missing, what is wrong."""

    about: str
    counted: str
    missing: tuple[str, ...] = ()
    wrong: tuple[str, ...] = ()


@dataclass(frozen=True)
class CheckedLog:
    """All that was looked at in one log."""

    path: str
    checks: tuple[Check, ...]

    @property
    def verdict(self) -> str:
        """Inconclusive if anything is missing, else wrong if anything is, else good."""
        if any(check.missing for check in self.checks):
            return INCONCLUSIVE
        return WRONG if any(check.wrong for check in self.checks) else GOOD


def check_log(path: Path) -> CheckedLog:
    """Check a log. Raises LogReadError if it is not the log of a run."""
    run = run_facts(path)
    try:
        file = look_into(path)
    except OSError as error:
        raise LogReadError(f"{path}: cannot be read: {error.strerror}") from error
    checks = (
        _file(file, run),
        _checksums(file),
        _index(file),
        _sequences(run),
        _end(run),
        _processes(run),
        _spans(run),
        _ledger(run),
        _viewers_chunks(file),
        _viewers_schemas(file, run),
        _viewers_stamps(file),
    )
    return CheckedLog(str(path), checks)


def checked_to_json(checked: CheckedLog) -> dict[str, Any]:
    """A plain dict of what was checked, the verdict among it."""
    return {"verdict": checked.verdict, **asdict(checked)}


def _said(*texts: str | bool) -> tuple[str, ...]:
    """Those of the texts that are said."""
    return tuple(text for text in texts if isinstance(text, str) and text)


def _number(count: int, what: str) -> str:
    return f"{count:,} {what}"


def _file(file: Container, run: RunFacts) -> Check:
    problem = run.problem or file.problem
    return Check(
        "the file ends as it should",
        f"{_number(run.messages, 'messages')} in {_number(file.chunks, 'chunks')}",
        missing=_said(problem, not run.messages and "there is no message"),
    )


def _checksums(file: Container) -> Check:
    without = file.chunks_without_crc
    return Check(
        "checksums are there and right",
        f"{_number(file.chunks - without, 'chunks')}, data and summary",
        missing=_said(
            without > 0 and f"{without} chunks have none",
            not file.data_crc and "the data section has none",
            not file.summary_crc and "the summary has none",
        ),
    )


def _index(file: Container) -> Check:
    return Check(
        "index and summary are there and right",
        f"{_number(file.index_entries, 'entries')}, {len(file.chunk_indexes)} chunks",
        missing=_said(
            not file.chunk_indexes and "no index of the chunks",
            file.statistics is None and "no statistics",
        ),
        wrong=(*_few(file.index_wrong), *file.summary_wrong),
    )


def _sequences(run: RunFacts) -> Check:
    gaps = [f"{topic}: {of.gaps} messages" for topic, of in run.counts.items() if of.gaps]
    lost = [f"{number} of the messages of {source}" for source, number in run.missing.items()]
    spoken = sum(bool(of.said_ns) for of in run.counts.values())
    return Check("no message was lost", f"{spoken} topics", missing=(*gaps, *lost))


def _end(run: RunFacts) -> Check:
    return Check(
        "the run came to an end of its own",
        run.ended or "-",
        missing=_said(
            not run.ended and "run/ended: why the run ended",
            run.ended.startswith(PROCESS_LOST) and f"what it did not do: {run.ended}",
        ),
    )


def _processes(run: RunFacts) -> Check:
    return Check(
        "every process took part",
        f"{len(run.handled_by)} processes with handlers",
        missing=tuple(f"{name} neither said nor handled anything" for name in run.silent),
    )


def _spans(run: RunFacts) -> Check:
    unheard = [
        f"{process} passed over {number} messages of {topic}"
        for (topic, process), number in run.unheard.items()
    ]
    astray = f"{run.astray} spans are of messages that are not there, or not theirs to handle"
    return Check(
        "every handler has its message, every message its handlers",
        f"{_number(run.spans, 'spans')}; {run.waiting} messages still on their way at the end",
        missing=(*unheard, *_said(run.astray > 0 and astray)),
    )


def _ledger(run: RunFacts) -> Check:
    missed = [number for number in run.missed if number not in run.settled]
    unasked = [number for number in run.settled if number not in run.asked]
    open_ = sum(number not in run.settled for number in run.asked)
    return Check(
        "the ledger has every decision that came or was missed",
        f"{len(run.asked)} asked, {len(run.settled)} entries, {len(run.missed)} missed; "
        f"{open_} without entry: open at the end, or needed no more",
        missing=(
            *_few([f"decision {number} was missed and has no entry" for number in missed]),
            *_said(not run.settled and "the ledger is empty"),
        ),
        wrong=_few(
            [f"decision {number} has an entry, but was not asked for" for number in unasked]
        ),
    )


def _viewers_chunks(file: Container) -> Check:
    unknown = [name for name in file.compressions if name not in COMPRESSIONS]
    return Check(
        "Foxglove, Lichtblick, Rerun: indexed chunks, compressed as they know",
        ", ".join(f"{number} {name}" for name, number in file.compressions.items()) or "none",
        missing=_said(not file.chunks and "chunks"),
        wrong=_said(
            file.outside > 0 and f"{file.outside} messages are outside of the chunks",
            *(f"compression {name!r}" for name in unknown),
        ),
    )


def _viewers_schemas(file: Container, run: RunFacts) -> Check:
    found = [_unreadable(of, file.schemas.get(of.schema_id)) for of in file.channels.values()]
    return Check(
        "Foxglove, Lichtblick, PlotJuggler, Rerun: protobuf, each topic with its schema",
        f"{len(file.channels)} channels, {len(file.schemas)} schemas",
        missing=_said(not file.channels and "channels in the summary"),
        wrong=_said(*found, run.undecodable),
    )


def _unreadable(channel: Channel, schema: Schema | None) -> str:
    if channel.message_encoding != "protobuf":
        return f"{channel.topic}: encoded as {channel.message_encoding!r}"
    if schema is None or schema.encoding != "protobuf":
        return f"{channel.topic}: has no protobuf schema"
    try:
        described = FileDescriptorSet.FromString(schema.data)
    except DecodeError:
        return f"{channel.topic}: its schema is not a FileDescriptorSet"
    names = {f"{f.package}.{m.name}" for f in described.file for m in f.message_type}
    if schema.name not in names:
        return f"{channel.topic}: its schema does not describe {schema.name}"
    return ""


def _viewers_stamps(file: Container) -> Check:
    stamps = [
        stamp_ns
        for index in file.chunk_indexes
        for stamp_ns in (index.message_start_time, index.message_end_time)
    ]
    beyond = sum(not UNIX_FROM_NS <= stamp_ns < UNIX_UNTIL_NS for stamp_ns in stamps)
    return Check(
        "viewers show stamps as dates: all within 2000 to 2100",
        f"{len(file.chunk_indexes)} chunks",
        missing=_said(not stamps and "stamps in the index"),
        wrong=_said(beyond > 0 and f"{beyond} stamps in the index are not, seen as Unix time"),
    )


def _few(texts: Iterable[str], most: int = 5) -> tuple[str, ...]:
    """The first few, and how many more."""
    all_texts = list(texts)
    more = len(all_texts) - most
    return (*all_texts[:most], *((f"and {more} more",) if more > 0 else ()))
