"""A run is a function of its scenario and its seed: the log's bytes say so."""

from __future__ import annotations

from pathlib import Path

import pytest

from scenarios.scenario import Scenario
from tests.scenarios import spoilt
from tests.scenarios.runs import (
    LITTLE,
    everything_said,
    log_in_process,
    log_of_processes,
    scenario_of,
    script_of,
    shipped,
)


def little(seed: int = 1) -> Scenario:
    return scenario_of(LITTLE, seed=seed)


def test_the_same_seed_leaves_the_same_bytes_however_it_is_run(tmp_path: Path) -> None:
    script = script_of(little())
    alone = log_in_process(script, tmp_path / "alone.mcap")
    launched, apart = log_of_processes(script, tmp_path / "apart.mcap")
    _, again = log_of_processes(script, tmp_path / "again.mcap")
    assert (launched.reason, launched.failed) == ("done", {})
    assert apart == again
    assert apart == alone


def test_a_long_run_in_processes_leaves_the_bytes_of_one_in_process(tmp_path: Path) -> None:
    script = shipped("aces")
    _, apart = log_of_processes(script, tmp_path / "apart.mcap")
    assert apart == log_in_process(script, tmp_path / "alone.mcap")


def test_another_seed_says_other_things() -> None:
    def what_was_said(seed: int) -> list[tuple[str, str, int]]:
        return [(s.topic, s.source, s.said_ns) for s in everything_said(little(seed))]

    assert what_was_said(1) == what_was_said(1)
    assert what_was_said(1) != what_was_said(2)


def test_a_handler_that_reads_the_wall_clock_is_noticed(tmp_path: Path) -> None:
    script, build = script_of(little()), spoilt.build("wall clock")
    first = log_in_process(script, tmp_path / "first.mcap", build)
    assert first != log_in_process(script, tmp_path / "again.mcap", build)


@pytest.mark.parametrize("how, repeats", [("sound", True), ("set", False)])
def test_a_handler_that_iterates_a_set_is_noticed(how: str, repeats: bool, tmp_path: Path) -> None:
    logs = [spoilt.log_in_a_process(how, seed, tmp_path / f"{seed}.mcap") for seed in (1, 2)]
    assert (logs[0] == logs[1]) is repeats
