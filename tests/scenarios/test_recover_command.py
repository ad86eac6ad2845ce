"""``waywiser recover`` as a user meets it: a recorder that is killed, a disk that is full."""

from __future__ import annotations

import os
import resource
import signal
from pathlib import Path

import pytest

from bus.topics import TOPICS
from logs.analysis import analyse
from logs.reader import read_run
from logs.tail import tail_path
from scenarios.launch import claimed_log, launch_in_process, prepare
from tests.scenarios.launches import (
    ENDLESS,
    SHORT,
    ended,
    processes_of,
    start,
    wait_until_running,
    waywiser,
)


@pytest.fixture
def short_log(tmp_path: Path) -> Path:
    """The log of a whole short run."""
    (tmp_path / "short.toml").write_text(SHORT)
    prepared = prepare(str(tmp_path / "short.toml"), [], None)
    with claimed_log(prepared, str(tmp_path / "short.mcap")) as log:
        launch_in_process(prepared, log)
    return log


def test_a_whole_log_is_good(short_log: Path) -> None:
    out = short_log.with_name("out.mcap")
    said = waywiser("recover", str(short_log), str(out), "--json")
    assert said.status == 0
    facts = said.json
    assert (facts["missing"], facts["damage"], facts["ended"]) == ({}, [], True)
    assert facts["messages"] == sum(analyse(short_log).topics.values())
    assert out.read_bytes() == short_log.read_bytes()
    assert "the run is all there" in waywiser("recover", str(short_log), str(out)).out


def test_a_log_with_its_end_cut_off_is_inconclusive(short_log: Path) -> None:
    short_log.write_bytes(short_log.read_bytes()[: short_log.stat().st_size // 2])
    out = short_log.with_name("out.mcap")
    said = waywiser("recover", str(short_log), str(out))
    assert said.status == 3
    assert "the log does not say how the run ended: its end is missing" in said.out
    assert not read_run(out).truncated


def test_what_is_no_log_is_bad_input(tmp_path: Path) -> None:
    (tmp_path / "short.toml").write_text(SHORT)
    said = waywiser("recover", str(tmp_path / "short.toml"), str(tmp_path / "out.mcap"))
    assert said.status == 2
    assert "short.toml: found a file that is not MCAP, expected the log of a run" in said.err
    said = waywiser("recover", str(tmp_path / "none.mcap"), str(tmp_path / "out.mcap"))
    assert (said.status, (tmp_path / "out.mcap").exists()) == (2, False)


def test_a_recorder_that_is_killed_leaves_all_it_had_written(tmp_path: Path) -> None:
    scenario, log = tmp_path / "endless.toml", tmp_path / "run.mcap"
    scenario.write_text(ENDLESS)
    launched = start("launch", str(scenario), "--log", str(log), "--json")
    wait_until_running(log)
    os.kill(processes_of(log.with_suffix(".output"))["recorder"], signal.SIGKILL)
    assert ended(launched).status == 3
    assert tail_path(log).exists()
    found = read_run(log, ())
    list(found)
    said = waywiser("recover", str(log), str(tmp_path / "out.mcap"), "--json")
    facts = said.json
    assert (said.status, facts["missing"], facts["damage"]) == (3, {}, [])
    assert facts["messages"] == found.read + facts["from_tail"]
    assert facts["from_tail"] > 0


def test_a_disk_that_fills_up_leaves_all_that_was_written(tmp_path: Path) -> None:
    scenario, log = tmp_path / "endless.toml", tmp_path / "run.mcap"
    scenario.write_text(ENDLESS)

    def fill() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))

    launched = start("launch", str(scenario), "--log", str(log), "--json", preexec_fn=fill)
    facts = ended(launched).json
    assert (facts["status"], list(facts["failed"])) == (3, ["recorder"])
    assert f"waywiser recover {log} OUT saves what is there" in facts["failed"]["recorder"]
    out = tmp_path / "out.mcap"
    said = waywiser("recover", str(log), str(out), "--json")
    assert (said.status, said.json["missing"], said.json["damage"]) == (3, {}, [])
    reader = read_run(out, list(TOPICS))
    assert len(list(reader)) == said.json["messages"]
