"""Playing back a real robot's log: through the real processes, at the times of the log."""

from __future__ import annotations

import gzip
import math
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from bus.messages import MapBelief, Ranges, RunEnded, Scan, Sonar, TrueBuilding
from logs.reader import read_run
from scenarios.scenario import ScenarioError, load
from simworld.carmen import read_carmen
from tests.scenarios.launches import waywiser
from tests.scenarios.outcomes import probability_of_truth
from tests.scenarios.runs import MAPS, of_kind
from tests.simworld.drawn_plans import corridor_boxes, drawn_plan
from tests.simworld.made_log import BEGINS_S, log_text, way_through

COLUMNS_M, ROWS_M = (0.0, 14.0), (0.0, 12.0)
AROUND = ((0.0, 0.0), (14.0, 0.0), (14.0, 12.0), (0.0, 12.0), (0.0, 1.0))
A_ROOM = "".join(
    f"ODOM 0 0 {h} 0 0 0 {t} host {t}\nFLASER 180 {'3.0 ' * 180}0 0 {h} 0 0 {h} {t} host {t}\n"
    for t, h in enumerate((0.0, 3.14159) * 3, 1)
)
"""Walls all around at 3 m."""

ACES = MAPS / "aces" / "aces-corrected.log.gz"


@pytest.fixture(scope="module")
def robot_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A robot that drives around a ring of four corridors, turned by 15 degrees."""
    turn = math.radians(15.0)
    plan = drawn_plan(corridor_boxes(COLUMNS_M, ROWS_M, np.ones(4, np.uint8), 2.0), turn)
    c, s = math.cos(turn), math.sin(turn)
    poses = way_through([(c * x - s * y, s * x + c * y) for x, y in AROUND])
    path = tmp_path_factory.mktemp("robot") / "robot.log.gz"
    path.write_bytes(gzip.compress(log_text(plan, poses).encode()))
    return path


@pytest.fixture(scope="module")
def run(robot_log: Path) -> Path:
    """The log of a run that played it back."""
    log = robot_log.with_name("run.mcap")
    said = waywiser(
        "replay-carmen", str(robot_log), "--in-process", "--log", str(log),
        "--scenario", str(robot_log.with_name("robot.toml")), "--json",
    )  # fmt: skip
    assert (said.status, said.json["reason"]) == (0, "done"), said
    return log


def test_the_scans_are_heard_at_the_times_of_the_log(robot_log: Path, run: Path) -> None:
    said = tuple(read_run(run))
    times_ns = [round((scan.time_s - BEGINS_S) * 1e9) for scan in read_carmen(robot_log).scans]
    driving = [message for message in of_kind(said, Sonar) if message.action == 0]
    assert [ping.fired_ns for ping in driving] == times_ns
    ranges = of_kind(said, Ranges)
    assert [belief.fired_ns for belief in ranges] == times_ns
    assert max(belief.speed_m_s for belief in ranges) == pytest.approx(0.4, abs=0.05)


def test_the_map_is_learnt_and_the_log_is_whole(run: Path) -> None:
    said = tuple(read_run(run))
    (building,) = of_kind(said, TrueBuilding)
    assert building.corridors.tolist() == [1, 1, 1, 1]
    assert probability_of_truth(of_kind(said, MapBelief)[-1], building) > 0.99
    assert of_kind(said, RunEnded)[-1].reason == "done"
    assert of_kind(said, Scan)  # some junctions were looked at
    assert waywiser("check", str(run)).status == 0
    assert waywiser("analyse", str(run)).status == 0


def test_it_repeats_and_its_scenario_says_the_same(robot_log: Path, run: Path) -> None:
    again = robot_log.with_name("again.mcap")
    said = waywiser(
        "launch", str(robot_log.with_name("robot.toml")), "--in-process", "--log", str(again)
    )
    assert said.status == 0
    assert waywiser("diff", str(run), str(again)).status == 0


def test_processes_of_their_own_leave_the_same_log(robot_log: Path) -> None:
    logs = [robot_log.with_name(name) for name in ("apart.mcap", "together.mcap")]
    for log, how in zip(logs, ((), ("--in-process",)), strict=True):
        said = waywiser("replay-carmen", str(robot_log), "--until", "50", "--log", str(log), *how)
        assert said.status == 0, said
        assert "time after 50.0 s simulated" in said.out
    assert logs[0].read_bytes() == logs[1].read_bytes()


def spoilt(log: Path, folder: Path, spoil: Callable[[str], str]) -> Path:
    path = folder / "spoilt.log"
    path.write_text(spoil(gzip.decompress(log.read_bytes()).decode()))
    return path


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (lambda text: text[:-100], "FLASER: found .* values, expected 189; is it cut off"),
        (lambda _text: "a shopping list\n", "found no FLASER line, expected a CARMEN log"),
        (lambda text: text.replace("FLASER 180", "FLASER 170"), "found 170 beams, expected one of"),
        (lambda text: text.replace("ODOM", "odom"), "found 0 ODOM lines with times, expected at"),
        (lambda _text: A_ROOM, "without corridors"),
    ],
)
def test_bad_logs_are_bad_input(
    robot_log: Path, tmp_path: Path, spoil: Callable[[str], str], says: str
) -> None:
    path = spoilt(robot_log, tmp_path, spoil)
    said = waywiser("replay-carmen", str(path), "--in-process", "--log", str(tmp_path / "x.mcap"))
    assert (said.status, said.out) == (2, "")
    assert len(said.err.splitlines()) == 1
    assert str(path) in said.err
    assert re.search(says, said.err), said.err
    assert not (tmp_path / "x.mcap").exists()


def test_cut_compression_is_bad_input(robot_log: Path, tmp_path: Path) -> None:
    path = tmp_path / "cut.log.gz"
    path.write_bytes(robot_log.read_bytes()[:-2000])
    said = waywiser("replay-carmen", str(path), "--in-process")
    assert said.status == 2
    assert "found compressed data that is cut off or damaged after line" in said.err


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ('world.floor_plan="x.yaml"', "world.floor_plan: found beside world.carmen, expected none"),
        ("random_errands.count=2", "random_errands: found beside world.carmen, expected none"),
        ("world.sonar.transducers=16", "found 16, expected 24 beside world.carmen"),
    ],
)
def test_what_was_not_recorded_is_refused(
    robot_log: Path, run: Path, change: str, says: str
) -> None:
    assert run.exists()
    with pytest.raises(ScenarioError, match=says):
        load(robot_log.with_name("robot.toml"), [change])


def test_another_beginning_than_the_logs_is_refused(robot_log: Path, run: Path) -> None:
    assert run.exists()
    said = waywiser(
        "launch", str(robot_log.with_name("robot.toml")), "--in-process",
        "--set", 'world.start={junction=[0, 0], heading="W"}',
    )  # fmt: skip
    assert said.status == 2
    assert "world.start: found junction [0, 0], heading W, expected [1, 0], heading E" in said.err


@pytest.mark.skipif(not ACES.is_file(), reason=f"needs the log {ACES}")
def test_the_real_robots_log_teaches_the_real_building(tmp_path: Path) -> None:
    log = tmp_path / "aces.mcap"
    said = waywiser(
        "replay-carmen", str(ACES), "--in-process", "--until", "400", "--log", str(log), "--json"
    )
    assert (said.status, said.json["reason"]) == (0, "time")
    messages = tuple(read_run(log))
    (building,) = of_kind(messages, TrueBuilding)
    assert building.corridors.tolist() == [1] * 12
    pings = [ping for ping in of_kind(messages, Sonar) if ping.action == 0]
    begins_s = read_carmen(ACES).odometry[0].time_s
    times_s = [scan.time_s - begins_s for scan in read_carmen(ACES).scans]
    assert [ping.fired_ns for ping in pings] == [round(t * 1e9) for t in times_s if t < 400.0]
    # Five corridors driven by then; none of the twelve that there are is given up.
    believed = of_kind(messages, MapBelief)[-1].corridors
    assert (believed > 0.99).sum() >= 5
    assert believed.min() > 0.1
