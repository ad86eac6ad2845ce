"""Reading logs that are whole, cut, damaged, or something else."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mcap.writer import Writer

from bus import messages as m
from bus.topics import TOPICS
from bus.wire import Sent, pack
from logs.reader import LogReadError, read_run
from logs.run_log import METADATA
from logs.schema import encode, schema, schema_name


def _packed(said: list[Sent]) -> list[tuple[str, bytes]]:
    """Messages as something that can be compared (arrays cannot)."""
    return [(sent.topic, pack(sent)) for sent in said]


def test_a_whole_log_gives_back_all_that_was_said(run_path: Path, run: list[Sent]) -> None:
    reader = read_run(run_path)
    assert _packed(list(reader)) == _packed(run)
    assert (reader.truncated, reader.problem, reader.missing) == (False, "", {})
    assert reader.read == len(run)
    assert reader.counts["ledger"] == 5
    assert list(reader.counts) == list(TOPICS)
    assert reader.last_said_ns == 600 * 10**9


def test_metadata_and_attachments_are_there_before_the_messages(run_path: Path) -> None:
    with read_run(run_path) as reader:
        assert reader.metadata["scenario"] == "two by two"
        assert reader.attachments == {"scenario.toml": b"seed = 7\n"}


def test_a_topic_filter_skips_the_others_but_counts_them(run_path: Path, run: list[Sent]) -> None:
    reader = read_run(run_path, ["truth/pose", "ledger"])
    found = list(reader)
    assert _packed(found) == _packed([s for s in run if s.topic in ("truth/pose", "ledger")])
    assert reader.read == len(run)


def test_an_unknown_topic_is_refused(run_path: Path) -> None:
    with pytest.raises(LogReadError, match="no topic 'ledgers'; the topics are percept/odometry"):
        read_run(run_path, ["ledgers"])


def test_lost_messages_are_counted_for_their_source(
    run: list[Sent], make_log: Callable[[list[Sent]], Path]
) -> None:
    lost = [sent for sent in run if sent.topic not in ("belief/map", "asked/path")]
    reader = read_run(make_log(lost), ["ledger"])
    list(reader)
    # of the geographer nothing is left, so nothing tells that anything is missing there
    assert reader.missing == {"world": 2}


def test_a_log_cut_anywhere_yields_a_prefix_and_says_so(
    run_path: Path, run: list[Sent], tmp_path: Path
) -> None:
    whole, expected = run_path.read_bytes(), _packed(run)
    cut = tmp_path / "cut.mcap"
    lengths = set()
    for length in [*range(0, len(whole), 61), len(whole) - 1]:
        cut.write_bytes(whole[:length])
        try:
            reader = read_run(cut)
        except LogReadError as error:
            assert str(cut) in str(error)
            assert length < 300
            continue
        found = _packed(list(reader))
        assert reader.truncated
        assert f"{len(found)} messages could be read" in reader.problem
        assert found == expected[: len(found)]
        lengths.add(len(found))
    assert {0, len(run)} <= lengths
    assert len(lengths) > 3


def test_a_damaged_log_never_yields_what_was_not_said(
    run_path: Path, run: list[Sent], tmp_path: Path
) -> None:
    whole, expected = run_path.read_bytes(), _packed(run)
    rng = np.random.default_rng(3)
    damaged = tmp_path / "damaged.mcap"
    for _ in range(300):
        data = bytearray(whole)
        data[rng.integers(len(data))] ^= 1 << int(rng.integers(8))
        damaged.write_bytes(data)
        try:
            reader = read_run(damaged)
            found = _packed(list(reader))
        except LogReadError:
            continue
        left = iter(expected)
        assert all(one in left for one in found)  # in order; a damaged chunk may be missing
        assert reader.truncated or len(found) == len(expected)


def test_a_changed_attachment_is_noticed(run_path: Path, run: list[Sent]) -> None:
    whole = run_path.read_bytes()
    assert whole.count(b"seed = 7") == 1
    run_path.write_bytes(whole.replace(b"seed = 7", b"seed = 8"))
    reader = read_run(run_path)
    assert len(list(reader)) == len(run)
    assert reader.truncated
    assert "crc validation failed" in reader.problem


def _text(path: Path) -> None:
    path.write_text("this is not a log at all\n")


def _other_mcap(path: Path) -> None:
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        schema_id = writer.register_schema("Thing", "jsonschema", b"{}")
        channel = writer.register_channel("/things", "json", schema_id)
        writer.add_message(channel, 0, b"{}", 0)
        writer.finish()  # type: ignore[no-untyped-call]


def _magic_only(path: Path) -> None:
    path.write_bytes(b"\x89MCAP0\r\n")


NOT_LOGS: dict[str, tuple[Callable[[Path], object], str]] = {
    "missing": (str, "cannot be read: No such file or directory"),
    "empty": (Path.touch, "found an empty file"),
    "folder": (Path.mkdir, "cannot be read: Is a directory"),
    "text": (_text, "found a file that is not MCAP"),
    "short": (lambda path: path.write_bytes(b"\x89MC"), "found a file that is not MCAP"),
    "magic": (_magic_only, r"ends or is damaged before its metadata \(8 bytes\)"),
    "other": (_other_mcap, "found an MCAP file of something else"),
}


@pytest.mark.parametrize("case", NOT_LOGS)
def test_what_is_not_a_log_is_refused_in_one_sentence(case: str, tmp_path: Path) -> None:
    make, words = NOT_LOGS[case]
    path = tmp_path / "RUN.mcap"
    make(path)
    with pytest.raises(LogReadError, match=words) as error:
        read_run(path)
    text = str(error.value)
    assert text.startswith(f"{path}: ")
    assert "expected" in text
    assert "\n" not in text


def _with_channels(path: Path, channels: list[tuple[str, str, bytes, bytes]]) -> None:
    """A log with one message on each (topic, schema name, schema, data)."""
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        writer.add_metadata(METADATA, {"epoch_ns": "0"})
        for topic, name, described, data in channels:
            schema_id = writer.register_schema(name, "protobuf", described)
            channel = writer.register_channel(topic, "protobuf", schema_id)
            writer.add_message(channel, 0, data, 0)
        writer.finish()  # type: ignore[no-untyped-call]


ENDED = Sent("run/ended", "world", 0, -1, 0, (), m.RunEnded("done"))


def test_what_is_there_for_viewers_only_is_passed_over(tmp_path: Path) -> None:
    path = tmp_path / "RUN.mcap"
    described = schema("run/ended").SerializeToString()
    view = ("view/pose", "foxglove.PoseInFrame", b"", b"\x0a")
    _with_channels(path, [view, ("run/ended", schema_name("run/ended"), described, encode(ENDED))])
    assert list(read_run(path)) == [ENDED]


def test_a_message_without_a_checksum_is_not_believed(tmp_path: Path) -> None:
    path = tmp_path / "RUN.mcap"
    with path.open("wb") as file:
        writer = Writer(file, use_chunking=False)
        writer.start()
        writer.add_metadata(METADATA, {"epoch_ns": "0"})
        described = schema("run/ended").SerializeToString()
        schema_id = writer.register_schema(schema_name("run/ended"), "protobuf", described)
        channel = writer.register_channel("run/ended", "protobuf", schema_id)
        writer.add_message(channel, 0, encode(ENDED), 0)
        writer.finish()  # type: ignore[no-untyped-call]
    reader = read_run(path)
    assert list(reader) == []
    assert reader.truncated
    assert "a message outside of the chunks" in reader.problem


@pytest.mark.parametrize("described", [schema("ledger").SerializeToString(), b"\xff\xff"])
def test_a_topic_recorded_with_other_fields_is_refused(tmp_path: Path, described: bytes) -> None:
    path = tmp_path / "RUN.mcap"
    _with_channels(path, [("run/ended", "old.Ended", described, b"")])
    with pytest.raises(LogReadError, match=r"another old.Ended, expected waywiser\.RunEnded"):
        list(read_run(path))


def test_a_payload_that_is_no_message_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "RUN.mcap"
    described = schema("run/ended").SerializeToString()
    _with_channels(path, [("run/ended", schema_name("run/ended"), described, b"\xff")])
    with pytest.raises(LogReadError, match=r"RUN.mcap: run/ended: not a waywiser\.RunEnded"):
        list(read_run(path))


def test_the_whole_sequence_number_comes_back(make_log: Callable[[list[Sent]], Path]) -> None:
    far = replace(ENDED, sequence=2**40)
    assert list(read_run(make_log([far]))) == [far]
