"""The file beside a log: there while a chunk is unfinished, gone when the log is whole."""

from __future__ import annotations

from pathlib import Path

import pytest

from logs.run_log import RunLog
from logs.tail import Tail, read_tail, tail_path
from tests.logs.endless_run import EPOCH_NS, message


def _log(path: Path) -> RunLog:
    return RunLog(path, EPOCH_NS, {"seed": "1"}, {})


def test_a_frame_is_on_disk_when_add_returns(tmp_path: Path) -> None:
    tail = Tail(tmp_path / "a.mcap")
    tail.begin(77)
    tail.add(b"schemas")
    tail.add(b"one")
    found = read_tail(tmp_path / "a.mcap")
    assert found is not None
    assert (found.offset, found.frames, found.cut_bytes) == (77, (b"schemas", b"one"), 0)
    tail.clear()
    assert read_tail(tmp_path / "a.mcap") is None
    tail.begin(99)
    tail.add(b"two")
    found = read_tail(tmp_path / "a.mcap")
    assert found is not None
    assert (found.offset, found.frames) == (99, (b"two",))


def test_a_frame_that_is_cut_or_altered_ends_the_tail(tmp_path: Path) -> None:
    log = tmp_path / "a.mcap"
    tail = Tail(log)
    tail.begin(0)
    for frame in (b"first", b"second", b"third"):
        tail.add(frame)
    tail.close()
    data = tail_path(log).read_bytes()
    tail_path(log).write_bytes(data[:-1])
    found = read_tail(log)
    assert found is not None
    assert (found.frames, found.cut_bytes) == ((b"first", b"second"), 8 + 4)
    tail_path(log).write_bytes(data.replace(b"second", b"sEcond"))
    found = read_tail(log)
    assert found is not None
    assert found.frames == (b"first",)


@pytest.mark.parametrize("data", [b"", b"waywiser tail", b"something else altogether"])
def test_a_file_that_is_no_tail_holds_nothing(tmp_path: Path, data: bytes) -> None:
    tail_path(tmp_path / "a.mcap").write_bytes(data)
    assert read_tail(tmp_path / "a.mcap") is None


def test_the_tail_appears_with_the_first_message_and_goes_with_the_last(tmp_path: Path) -> None:
    path = tmp_path / "RUN.mcap"
    log = _log(path)
    assert not tail_path(path).exists()
    log.write(message(0))
    assert tail_path(path).exists()
    log.close()
    assert sorted(found.name for found in tmp_path.iterdir()) == ["RUN.mcap"]


def test_the_tail_holds_one_chunk_however_long_the_run(tmp_path: Path) -> None:
    path = tmp_path / "RUN.mcap"
    with _log(path) as log:
        sizes = []
        for sequence in range(3000):
            log.write(message(sequence))
            sizes.append(tail_path(path).stat().st_size)
    assert max(sizes[100:]) < 10_000 < path.stat().st_size


def test_what_an_earlier_run_left_is_not_taken_for_this_one(tmp_path: Path) -> None:
    path = tmp_path / "RUN.mcap"
    killed = _log(path)
    killed.write(message(0))
    log = _log(path)
    assert not tail_path(path).exists()
    log.close()
    killed._file.close()


def test_a_log_with_and_without_a_tail_is_the_same_file(tmp_path: Path) -> None:
    """What is written to a device has no tail; here the device is a pipe's other name."""
    with _log(tmp_path / "a.mcap") as log:
        for sequence in range(100):
            log.write(message(sequence))
    with _log(tmp_path / "b.mcap") as log:
        log._mcap._tail = None
        for sequence in range(100):
            log.write(message(sequence))
    assert (tmp_path / "a.mcap").read_bytes() == (tmp_path / "b.mcap").read_bytes()
