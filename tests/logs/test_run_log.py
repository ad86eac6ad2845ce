"""The written file: what is in it, that it repeats, and that it survives its process."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.records import ChunkIndex
from mcap_protobuf.decoder import DecoderFactory

from bus import messages as m
from bus.topics import TOPICS
from bus.wire import Sent
from logs.mcap_file import CHUNK_BYTES
from logs.reader import read_run
from logs.run_log import LogWriteError, RunLog
from logs.schema import SchemaError
from logs.views import VIEWS

S = 10**9
EPOCH_NS = 1_767_225_600 * S

HASHED = """
import sys
from bus import messages as m
from bus.wire import Sent
from logs.run_log import RunLog
with RunLog(sys.argv[1], 10**18, {"b": "1", "a": "2"}, {"x.toml": b"x", "a.bin": b"y"}) as log:
    for i in range(100):
        log.write(Sent("truth/pose", "world", i, i - 1, i * 10**9, (), m.TruePose(i, 0.5, 0.25, i)))
    log.write(Sent("run/ended", "world", 100, -1, 10**11, (("world", 3),), m.RunEnded("done")))
"""


def _pose(sequence: int, at_s: float) -> Sent:
    message = m.TruePose(1.0, 2.0, 3.0, sequence)
    return Sent("truth/pose", "world", sequence, sequence - 1, int(at_s * S), (), message)


def _chunks(path: Path) -> list[ChunkIndex]:
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    return summary.chunk_indexes


def test_the_same_calls_leave_the_same_bytes(
    run: list[Sent], make_log: Callable[[list[Sent]], Path]
) -> None:
    first = make_log(run).read_bytes()
    assert make_log(run).read_bytes() == first
    assert make_log(run[:-1]).read_bytes() != first


def test_the_bytes_do_not_depend_on_the_process_that_writes_them(tmp_path: Path) -> None:
    root = Path(__file__).parents[2]
    written = []
    for seed in ("0", "1"):
        path = tmp_path / f"{seed}.mcap"
        environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(root)}
        command = [sys.executable, "-c", HASHED, str(path)]
        subprocess.run(command, env=environment, check=True, cwd=tmp_path)
        written.append(path.read_bytes())
    assert written[0] == written[1]


def test_another_library_reads_every_message_as_it_was_said(
    run_path: Path, run: list[Sent]
) -> None:
    with run_path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        found = list(reader.iter_decoded_messages(list(TOPICS), log_time_order=False))
    assert len(found) == len(run)
    for (schema, channel, stamped, record), sent in zip(found, run, strict=True):
        assert schema is not None
        assert schema.name == f"waywiser.{type(sent.message).__name__}"
        assert (channel.topic, channel.message_encoding) == (sent.topic, "protobuf")
        assert stamped.log_time == stamped.publish_time == EPOCH_NS + sent.said_ns
        assert stamped.sequence == sent.sequence
        envelope = (record.source, record.sequence, record.previous, record.said_ns)
        assert envelope == (sent.source, sent.sequence, sent.previous, sent.said_ns)
        assert tuple((p.source, p.sequence) for p in record.parents) == sent.parents
        _same_fields(record, sent.message)


def _same_fields(record: Any, message: m.Message) -> None:
    for name, value in msgspec.structs.asdict(message).items():
        recorded = f"about_{name}" if name in ("source", "sequence") else name
        found = getattr(record, recorded)
        if isinstance(value, np.ndarray):
            found = list(found)  # bytes and repeated fields alike
            assert found == value.ravel().tolist()
            if value.ndim > 1:
                assert tuple(getattr(record, f"{recorded}_shape")) == value.shape
        else:
            assert found == value


def test_the_channels_are_those_of_the_tables_whoever_speaks(
    make_log: Callable[[list[Sent]], Path],
) -> None:
    ended = Sent("run/ended", "world", 0, -1, 0, (), m.RunEnded("done"))
    with make_log([ended]).open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert [summary.channels[i].topic for i in sorted(summary.channels)] == [*TOPICS, *VIEWS]


def test_metadata_and_attachments_are_there_with_the_epoch_as_their_time(run_path: Path) -> None:
    with run_path.open("rb") as file:
        reader = make_reader(file)
        (metadata,) = reader.iter_metadata()
        (attachment,) = reader.iter_attachments()
        assert reader.get_header().library == "waywiser"
    expected = {"scenario": "two by two", "seed": "7", "epoch_ns": str(EPOCH_NS)}
    assert (metadata.name, metadata.metadata) == ("waywiser", expected)
    assert (attachment.name, attachment.data) == ("scenario.toml", b"seed = 7\n")
    assert attachment.create_time == attachment.log_time == EPOCH_NS


def test_a_chunk_spans_less_than_a_minute_of_simulated_time(
    make_log: Callable[[list[Sent]], Path],
) -> None:
    path = make_log([_pose(i, at_s) for i, at_s in enumerate((5, 6, 64.9, 65, 70, 300))])
    spans = [
        (c.message_start_time - EPOCH_NS, c.message_end_time - EPOCH_NS) for c in _chunks(path)
    ]
    # the first chunk begins at 5 s, so it may hold what was said before 65 s
    assert spans == [(5 * S, int(64.9 * S)), (65 * S, 70 * S), (300 * S, 300 * S)]


def test_a_chunk_ends_by_size_too(make_log: Callable[[list[Sent]], Path]) -> None:
    sonar = m.Sonar(0, 0, 0, np.zeros(1000))  # 8 kB each
    said = [Sent("percept/sonar", "world", i, i - 1, i, (), sonar) for i in range(30)]
    chunks = _chunks(make_log(said))
    assert len(chunks) > 3
    assert all(c.uncompressed_size < CHUNK_BYTES + 32_000 for c in chunks)


def test_a_long_sequence_number_keeps_its_low_bits_in_mcap(
    make_log: Callable[[list[Sent]], Path],
) -> None:
    path = make_log([replace(_pose(0, 0), sequence=2**32 + 70_000)])
    with path.open("rb") as file:
        (found,) = make_reader(file).iter_messages("truth/pose")
    assert found[2].sequence == 70_000
    assert [sent.sequence for sent in read_run(path)] == [2**32 + 70_000]


def test_what_is_a_minute_old_is_on_disk_while_the_run_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "RUN.mcap"
    log = RunLog(path, EPOCH_NS, {}, {})
    for i in range(121):
        log.write(_pose(i, i))
    killed = tmp_path / "killed.mcap"
    killed.write_bytes(path.read_bytes())  # as SIGKILL would leave it at 120 s
    log.close()
    reader = read_run(killed)
    assert [sent.sequence for sent in reader] == list(range(120))
    assert reader.truncated
    assert [sent.sequence for sent in read_run(path)] == list(range(121))


def test_a_run_without_messages_is_a_whole_log(make_log: Callable[[list[Sent]], Path]) -> None:
    reader = read_run(make_log([]))
    assert (list(reader), reader.truncated) == ([], False)


def test_nothing_is_written_after_the_end(tmp_path: Path) -> None:
    log = RunLog(tmp_path / "RUN.mcap", EPOCH_NS, {}, {})
    log.close()
    log.close()
    with pytest.raises(LogWriteError, match=r"RUN.mcap: the log is closed"):
        log.write(_pose(0, 0))


def test_a_time_before_the_unix_epoch_is_refused(tmp_path: Path) -> None:
    with RunLog(tmp_path / "RUN.mcap", 0, {}, {}) as log:
        with pytest.raises(SchemaError, match="said at -1 ns"):
            log.write(replace(_pose(0, 0), said_ns=-1))
        log.write(_pose(0, 0))
    assert len(list(read_run(tmp_path / "RUN.mcap"))) == 1


@pytest.mark.parametrize(
    ("name", "words"), [("no/such/folder.mcap", "No such file"), (".", "Is a directory")]
)
def test_a_path_that_cannot_be_made_is_named(tmp_path: Path, name: str, words: str) -> None:
    path = tmp_path / name
    with pytest.raises(LogWriteError, match=words) as error:
        RunLog(path, EPOCH_NS, {}, {})
    assert str(path) in str(error.value)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here")
def test_a_full_disk_is_named_at_the_start() -> None:
    with pytest.raises(LogWriteError, match="/dev/full: cannot write the log: No space left"):
        RunLog("/dev/full", EPOCH_NS, {}, {})


@pytest.fixture
def small_files() -> Iterator[int]:
    """No file may grow beyond this: the system then refuses as it does on a full disk."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, limits[1]))
    yield 60_000
    resource.setrlimit(resource.RLIMIT_FSIZE, limits)


def test_a_disk_that_fills_up_leaves_what_was_written(tmp_path: Path, small_files: int) -> None:
    path = tmp_path / "RUN.mcap"
    rng = np.random.default_rng(1)  # noise, so that it does not compress
    with (
        pytest.raises(LogWriteError, match=r"RUN.mcap: cannot write the log: File too large"),
        RunLog(path, EPOCH_NS, {}, {}) as log,
    ):
        for i in range(1000):
            sonar = m.Sonar(i, 0, 0, rng.random(16))
            log.write(Sent("percept/sonar", "world", i, i - 1, i * 3 * S, (), sonar))
    reader = read_run(path)
    said = [sent.sequence for sent in reader]
    assert said == list(range(len(said)))
    assert 20 <= len(said) < 1000
    assert reader.truncated
    assert path.stat().st_size <= small_files
