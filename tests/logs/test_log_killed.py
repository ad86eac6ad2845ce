"""A recorder that is killed, or whose disk is full, loses nothing that it had written."""

from __future__ import annotations

import random
import resource
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from logs.reader import read_run
from logs.recover import recover
from logs.run_log import LogWriteError, RunLog
from logs.tail import tail_path
from tests.logs.endless_run import EPOCH_NS, message

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("seed", range(4))
def test_sigkill_at_a_random_moment_loses_nothing_that_was_written(
    tmp_path: Path, seed: int
) -> None:
    path = tmp_path / "RUN.mcap"
    wanted = random.Random(seed).randint(1, 3000)
    command = [sys.executable, "-m", "tests.logs.steady_writer", str(path)]
    writer = subprocess.Popen(command, stdout=subprocess.PIPE, cwd=ROOT)
    assert writer.stdout is not None
    for _ in range(wanted):
        assert writer.stdout.readline()
    writer.kill()
    said = wanted + len(writer.stdout.readlines())
    writer.wait()
    writer.stdout.close()
    recovered = recover(path, tmp_path / "whole.mcap")
    # it may be killed between writing a message and saying so, or while saying so
    assert said - 1 <= recovered.messages <= said + 1
    assert (recovered.missing, recovered.damage, recovered.closed) == ({}, (), False)
    found = list(read_run(tmp_path / "whole.mcap"))
    assert [sent.sequence for sent in found] == list(range(recovered.messages))
    assert found[-1].said_ns == message(recovered.messages - 1, 10**9).said_ns


@pytest.fixture(params=[40_000, 60_000, 100_000])
def file_limit(request: pytest.FixtureRequest) -> Iterator[int]:
    """No file may grow beyond this: the system then refuses as it does on a full disk."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (request.param, limits[1]))
    yield request.param
    resource.setrlimit(resource.RLIMIT_FSIZE, limits)


def test_all_that_was_written_before_the_disk_was_full_can_be_recovered(
    tmp_path: Path, file_limit: int
) -> None:
    path = tmp_path / "RUN.mcap"
    written = 0
    with (
        pytest.raises(LogWriteError, match=r"RUN.mcap: cannot write the log: File too large"),
        RunLog(path, EPOCH_NS, {}, {}) as log,
    ):
        while True:
            log.write(message(written, 10**7))  # chunks end by size: it is the tail that fills
            written += 1
    assert tail_path(path).stat().st_size <= file_limit
    resource.setrlimit(resource.RLIMIT_FSIZE, resource.getrlimit(resource.RLIMIT_FSIZE)[1:] * 2)
    recovered = recover(path, tmp_path / "whole.mcap")
    # the message that did not fit may be there without its view
    assert written <= recovered.messages <= written + 1
    assert (recovered.missing, written > 20) == ({}, True)
