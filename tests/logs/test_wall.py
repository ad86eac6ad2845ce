"""Wall stamps stand apart from the log, and say whether the cost model holds."""

from __future__ import annotations

from pathlib import Path

import pytest

from bus.coordinator import Handled
from logs.reader import read_run
from logs.wall import cost_checks, wall_path
from scenarios.launch import launch_in_process, prepare
from scenarios.wall_record import WallRecord


def _handled(topic: str, cells: int, modelled_ns: int, took_ns: int) -> Handled:
    return Handled(topic, "world", cells, 0, modelled_ns, cells, 0, "", took_ns)


def test_medians_ratio_and_correlation_by_hand(tmp_path: Path) -> None:
    log = tmp_path / "a.mcap"
    log.touch()
    with WallRecord(log, prepare("aces", [], 1).script) as wall:
        for cells in (10, 20, 60):  # takes 3 ns a cell where the model says 2
            wall.measured("decider", _handled("belief/map", cells, 2 * cells, 3 * cells))
        wall.measured("sensor", _handled("percept/sonar", 5, 0, 7))
    first, second = cost_checks(log)
    assert (first.process, first.topic, first.handlers, first.cells) == (
        "decider",
        "belief/map",
        3,
        90,
    )
    assert first.measured_median_s == pytest.approx(60e-9)  # 3 * 20
    assert first.modelled_median_s == pytest.approx(40e-9)
    assert first.ratio == pytest.approx(1.5)
    assert first.correlation == pytest.approx(1.0)
    assert (second.ratio, second.correlation) == (None, None)


def test_the_log_holds_no_wall_stamp_and_the_other_file_every_handler(tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    launched = launch_in_process(prepare("aces", ["world.until_s=400"], 1), log)
    with read_run(log) as reader:
        topics = [sent.topic for sent in reader]
    assert "wall/span" not in topics
    assert sum(check.handlers for check in cost_checks(log)) == launched.handlers
    with read_run(wall_path(log)) as reader:
        assert "machine" in reader.metadata


def test_a_log_without_wall_stamps_has_no_cost_checks(tmp_path: Path) -> None:
    assert cost_checks(tmp_path / "a.mcap") == ()


def test_where_wall_stamps_cannot_be_written_the_run_goes_on(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    log = tmp_path / "a.mcap"
    log.touch()
    wall_path(log).mkdir()  # a folder stands in its place
    with WallRecord(log, prepare("aces", [], 1).script) as wall:
        wall.measured("sensor", _handled("percept/sonar", 5, 0, 7))
    assert "no wall stamps" in capfd.readouterr().err
