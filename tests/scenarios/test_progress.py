"""What a launch shows while it runs: on a terminal a live view, elsewhere a line now and then."""

from __future__ import annotations

import os
import pty
import re
import sys
from pathlib import Path

import pytest

from scenarios.show import ProgressShow
from scenarios.supervisor import Progress
from tests.scenarios.launches import SHORT


def progress(simulated_s: float) -> Progress:
    return Progress(True, simulated_s, 2, 6, 31, 4, 900, {"world": "running", "decider": "running"})


def test_without_a_terminal_a_line_comes_at_first_and_then_every_five_seconds(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    with ProgressShow("aces", 1, quiet=False) as show:
        for now_s in (100.0, 100.2, 104.9, 105.1, 106.0, 110.2):
            monkeypatch.setattr("time.monotonic", lambda now_s=now_s: now_s)
            show.update(progress(now_s * 60.0))
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.splitlines() == [
        f"aces, seed 1: {time} simulated, errands 2/6, decisions 31 on time, 4 late"
        for time in ("1:40:00", "1:45:06", "1:50:12")
    ]


def test_quiet_says_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    with ProgressShow("aces", 1, quiet=True) as show:
        show.update(progress(60.0))
    assert capsys.readouterr() == ("", "")


def test_a_terminal_shows_time_errands_decisions_and_the_state_of_each_process(
    tmp_path: Path,
) -> None:
    scenario, log = tmp_path / "short.toml", str(tmp_path / "run.mcap")
    scenario.write_text(SHORT)
    pid, terminal = pty.fork()
    if pid == 0:
        words = [sys.executable, "-m", "waywiser", "launch", str(scenario), "--log", log]
        os.execve(sys.executable, words, {**os.environ, "COLUMNS": "120", "TERM": "xterm"})
    shown = b""
    while True:
        try:
            more = os.read(terminal, 65536)
        except OSError:
            break
        if not more:
            break
        shown += more
    _, status = os.waitpid(pid, 0)
    os.close(terminal)
    assert os.waitstatus_to_exitcode(status) == 0
    text = re.sub(r"\x1b\[[0-9;?]*[a-zA-Z]", "", shown.decode())
    for expected in (
        r"short, seed 1: starting, \d of 8 processes ready",
        r"starting: world, recorder, reactor",
        r"short, seed 1: 0:0\d:\d\d simulated, errands \d/1, decisions \d+ on time, 0 late",
        r"running: world, recorder, reactor, sensor, detectors, classifier, geographer, decider",
        r"ended: world, recorder, reactor, sensor, detectors, classifier, geographer, decider",
        r"done after 3\d\d\.",
    ):
        assert re.search(expected, text), expected
