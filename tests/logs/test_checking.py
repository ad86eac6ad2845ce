"""A whole log is good; whatever is taken from it makes the check inconclusive, never good."""

from __future__ import annotations

import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer

from bus import messages as m
from bus.wire import Sent
from logs.checking import GOOD, INCONCLUSIVE, WRONG, CheckedLog, check_log, checked_to_json
from logs.reader import LogReadError, read_run
from logs.run_log import METADATA, RunLog
from logs.schema import encode, schema, schema_name
from tests.logs.conftest import EPOCH_NS

Keep: TypeAlias = Callable[[Sent], bool]


@pytest.fixture(scope="module")
def said(late_run: Path) -> list[Sent]:
    with read_run(late_run) as reader:
        return list(reader)


def _complaints(checked: CheckedLog) -> list[str]:
    return [text for check in checked.checks for text in (*check.missing, *check.wrong)]


def _rewritten(said: list[Sent], path: Path, epoch_ns: int = EPOCH_NS) -> CheckedLog:
    with RunLog(path, epoch_ns, {"hop_ns": "100000"}, {}) as log:
        for sent in said:
            log.write(sent)
    return check_log(path)


def test_a_real_log_is_good_and_says_how_much_was_checked(late_run: Path, said: list[Sent]) -> None:
    checked = check_log(late_run)
    assert _complaints(checked) == []
    assert checked.verdict == GOOD
    spans = sum(sent.topic == "clock/span" for sent in said)
    counted = [check.counted for check in checked.checks]
    assert counted[0].startswith(f"{len(said):,} messages in ")
    assert any(text.startswith(f"{spans:,} spans") for text in counted)
    assert checked_to_json(checked)["verdict"] == GOOD


@pytest.mark.parametrize("share", [0.05, 0.5, 0.97, 0.9999])
def test_a_truncated_log_is_inconclusive(late_run: Path, tmp_path: Path, share: float) -> None:
    data = late_run.read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(data[: int(len(data) * share)])
    checked = check_log(cut)
    assert checked.verdict == INCONCLUSIVE
    assert checked.checks[0].missing


_GONE: dict[str, tuple[Keep, str]] = {
    "a ping": (
        lambda s: not (s.topic == "percept/sonar" and s.said_ns > 10**12),
        "of the messages of world",
    ),
    "the end": (lambda s: s.topic != "run/ended", "run/ended: why the run ended"),
    "a span": (
        lambda s: (
            not (
                isinstance(s.message, m.Span)
                and (s.message.process, s.message.topic) == ("decider", "asked/path")
                and s.said_ns < 10**12
            )
        ),
        "decider passed over",
    ),
    "what the spans are of": (lambda s: s.topic != "belief/map", "of messages that are not there"),
    "the ledger of a miss": (
        lambda s: not (isinstance(s.message, m.LedgerEntry) and s.message.cause),
        "was missed and has no entry",
    ),
    "a process": (
        lambda s: (
            s.source != "decider"
            and not (isinstance(s.message, m.Span) and s.message.process == "decider")
        ),
        "decider neither said nor handled anything",
    ),
}


@pytest.mark.parametrize("gone", _GONE)
def test_what_is_missing_makes_it_inconclusive(gone: str, said: list[Sent], tmp_path: Path) -> None:
    keep, complaint = _GONE[gone]
    kept = [sent for sent in said if keep(sent)]
    assert 0 < len(kept) < len(said)
    checked = _rewritten(kept, tmp_path / "RUN.mcap")
    assert checked.verdict == INCONCLUSIVE
    assert any(complaint in text for text in _complaints(checked)), _complaints(checked)


def test_a_process_that_died_makes_it_inconclusive(said: list[Sent], tmp_path: Path) -> None:
    died = [
        replace(s, message=m.RunEnded("process down: decider")) if s.topic == "run/ended" else s
        for s in said
    ]
    checked = _rewritten(died, tmp_path / "RUN.mcap")
    assert checked.verdict == INCONCLUSIVE
    assert "what it did not do: process down: decider" in _complaints(checked)


def test_simulated_time_without_an_epoch_is_no_date(said: list[Sent], tmp_path: Path) -> None:
    checked = _rewritten(said, tmp_path / "RUN.mcap", epoch_ns=0)
    assert checked.verdict == WRONG
    (complaint,) = _complaints(checked)
    assert complaint.endswith("stamps in the index are not, seen as Unix time")


def test_an_index_that_points_elsewhere_is_wrong(late_run: Path, tmp_path: Path) -> None:
    data = bytearray(late_run.read_bytes())
    with late_run.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    index = summary.chunk_indexes[0]
    listed = struct.pack("<Q", index.chunk_start_offset)
    at = data.rindex(struct.pack("<Q", index.message_end_time) + listed) + 8
    data[at : at + 8] = struct.pack("<Q", index.chunk_start_offset + 1)
    path = tmp_path / "wrong.mcap"
    path.write_bytes(data)
    checked = check_log(path)
    assert checked.verdict == WRONG
    complaints = _complaints(checked)
    assert "chunk 1 is not where, or not what, the index says" in complaints
    assert "the summary's checksum is not that of its bytes" in complaints


def _foreign(path: Path, said: list[Sent], *, chunked: bool, compressed: bool) -> None:
    """The same messages by the writer of the mcap package."""
    from mcap.writer import CompressionType

    with path.open("wb") as file:
        compression = CompressionType.ZSTD if compressed else CompressionType.NONE
        writer = Writer(file, use_chunking=chunked, compression=compression)
        writer.start()
        writer.add_metadata(METADATA, {"epoch_ns": str(EPOCH_NS)})
        channels: dict[str, int] = {}
        for sent in said:
            if sent.topic not in channels:
                described = schema(sent.topic).SerializeToString()
                number = writer.register_schema(schema_name(sent.topic), "protobuf", described)
                channels[sent.topic] = writer.register_channel(sent.topic, "protobuf", number)
            stamp_ns = EPOCH_NS + sent.said_ns
            writer.add_message(
                channels[sent.topic], stamp_ns, encode(sent), stamp_ns, sent.sequence
            )
        writer.finish()  # type: ignore[no-untyped-call]


def test_a_log_in_chunks_of_another_writer_is_checked_alike(
    said: list[Sent], tmp_path: Path
) -> None:
    path = tmp_path / "other.mcap"
    _foreign(path, said, chunked=True, compressed=False)
    checked = check_log(path)
    assert "the data section has none" in _complaints(checked)  # that writer makes no such sum
    assert not any(check.wrong for check in checked.checks)


def test_a_log_without_chunks_cannot_be_read_by_the_viewers(
    said: list[Sent], tmp_path: Path
) -> None:
    path = tmp_path / "flat.mcap"
    _foreign(path, said, chunked=False, compressed=False)
    checked = check_log(path)
    assert checked.verdict == INCONCLUSIVE
    assert any("are outside of the chunks" in text for text in _complaints(checked))


def test_what_is_not_a_log_is_refused(tmp_path: Path) -> None:
    with pytest.raises(LogReadError, match="cannot be read"):
        check_log(tmp_path / "nothing.mcap")
