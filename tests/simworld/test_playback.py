"""A CARMEN log as percepts, as a tour of junctions, and as what a ring would have heard."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from bus.grid import EAST, NORTH, WEST
from bus.messages import Odometry, Sonar, TruePose
from simworld.building import build
from simworld.carmen import CarmenError, CarmenLog, Scan
from simworld.carmen import Odometry as Report
from simworld.motion import Pose
from simworld.playback import log_begins_s, percepts
from simworld.recording import record
from simworld.sonar import SonarRing
from simworld.tour import tour
from tests.simworld.drawn_plans import corridor_boxes, drawn_plan
from tests.simworld.made_log import EVERY_M, SPEED_M_S, log_text, way_through

COLUMNS_M, ROWS_M = (0.0, 14.0), (0.0, 12.0)
RING = build(COLUMNS_M, ROWS_M, np.ones(4, np.uint8), 2.0)
AROUND = ((0.0, 0.0), (14.0, 0.0), (14.0, 12.0), (0.0, 12.0))


def report(time_s: float, x_m: float, y_m: float, heading_rad: float) -> Report:
    return Report(time_s, x_m, y_m, heading_rad, 0.0, 0.0)


def scan(time_s: float, x_m: float = 0.0, y_m: float = 0.0, heading_rad: float = 0.0) -> Scan:
    return Scan(time_s, x_m, y_m, heading_rad, np.full(180, 3.0))


def log_of(reports: Sequence[Report], scans: Sequence[Scan]) -> CarmenLog:
    return CarmenLog(tuple(scans), tuple(reports), {})


def test_percepts_come_in_order_at_the_times_of_the_log() -> None:
    reports = [
        report(10.0, 0.0, 0.0, 0.0),
        report(10.5, 0.2, 0.0, 0.0),
        report(0.0, 9.0, 9.0, 1.0),  # a mapper's, without a time
        report(11.0, 0.2, 0.0, math.pi / 2),
        report(12.0, 0.2, -0.3, math.pi / 2),
    ]
    log = log_of(reports, [scan(11.0), scan(10.2)])
    said = percepts(log, log.scans, RING)
    assert [at_ns for at_ns, _ in said] == [
        200_000_000, 200_000_000, 500_000_000, 10**9, 10**9, 10**9, 2 * 10**9,
    ]  # fmt: skip
    kinds = [type(message).__name__ for _, message in said]
    assert kinds == ["TruePose", "Sonar", "Odometry", "TruePose", "Odometry", "Sonar", "Odometry"]
    moves = [message for _, message in said if isinstance(message, Odometry)]
    assert (moves[0].distance_m, moves[0].elapsed_s) == pytest.approx((0.2, 0.5))
    assert (moves[1].distance_m, moves[1].turn_rad) == pytest.approx((0.0, math.pi / 2))
    assert (moves[2].distance_m, moves[2].elapsed_s) == pytest.approx((-0.3, 1.0))
    pings = [(at_ns, message) for at_ns, message in said if isinstance(message, Sonar)]
    for at_ns, ping in pings:
        assert (ping.fired_ns, ping.action) == (at_ns, 0)
        assert ping.ranges_m[[0, 5, 19]] == pytest.approx(3.0)
        assert np.isnan(ping.ranges_m[6:19]).all()


def test_a_log_without_wheels_cannot_be_played_back() -> None:
    with pytest.raises(CarmenError, match="found 1 ODOM lines with times, expected at least two"):
        log_begins_s(log_of([report(1.0, 0, 0, 0), report(0.0, 1, 1, 0)], [scan(1.0)]))


def test_a_tour_tells_the_junctions_and_by_which_corridors() -> None:
    way = [(0.0, 1.0), (0.3, 0.5), (7.0, 0.2), (13.0, 0.0), (14.2, 1.0), (14.0, 7.0), (13.5, 12.0)]
    stops = tour([scan(k, *at) for k, at in enumerate(way)], 0.0, RING)
    assert [(s.place, s.heading) for s in stops] == [(0, 0), (1, EAST), (3, NORTH)]
    assert [(s.came_ns, s.left_ns) for s in stops] == [
        (0, 10**9), (3 * 10**9, 4 * 10**9), (6 * 10**9, 6 * 10**9),
    ]  # fmt: skip


def test_a_tour_ends_where_the_robot_leaves_the_corridors() -> None:
    way = [(0.0, 0.0), (14.0, 0.0), (7.0, 6.0), (0.0, 12.0), (14.0, 12.0)]
    stops = tour([scan(k, *at) for k, at in enumerate(way)], 0.0, RING)
    assert [s.place for s in stops] == [0, 1]
    no_corridor = build(COLUMNS_M, ROWS_M, np.array([0, 1, 1, 1], np.uint8), 2.0)
    ends = [no_corridor.grid.ends(c) for c in (0,)]
    a, b = (no_corridor.position_m(*no_corridor.grid.place(p)) for p in ends[0])
    assert len(tour([scan(0, *a), scan(1, *b)], 0.0, no_corridor)) == 1


@pytest.fixture(scope="module")
def around(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A log of a robot that drives once around a ring of corridors, turned by 20 degrees."""
    turn = math.radians(20.0)
    plan = drawn_plan(corridor_boxes(COLUMNS_M, ROWS_M, np.ones(4, np.uint8), 2.0), turn)
    c, s = math.cos(turn), math.sin(turn)
    poses = way_through([(c * x - s * y, s * x + c * y) for x, y in (*AROUND, (0.0, 0.0))])
    path = tmp_path_factory.mktemp("log") / "robot.log"
    path.write_text(log_text(plan, poses))
    return path


def test_a_log_is_laid_onto_the_grid(around: Path) -> None:
    recording = record(around, RING)
    assert [s.heading for s in recording.stops[1:]] == [EAST, NORTH, WEST, 4]
    assert [s.place for s in recording.stops] == [0, 1, 3, 2, 0]
    poses = [message for _, message in recording.percepts if isinstance(message, TruePose)]
    assert (poses[0].x_m, poses[0].y_m) == pytest.approx((0.0, 0.0), abs=0.15)
    middle = poses[round(7.0 / EVERY_M)]
    assert (middle.y_m, middle.heading_rad) == pytest.approx((0.0, 0.0), abs=0.15)
    assert middle.x_m == pytest.approx(7.0, abs=0.6)
    at_ns = recording.percepts[-1][0]
    assert at_ns / 1e9 == pytest.approx(52.0 / SPEED_M_S + 1.5 * math.pi, rel=0.01)


def test_a_ring_hears_the_scans_and_where_nobody_looked_the_plan(around: Path) -> None:
    recording, ring = record(around, RING), SonarRing()
    heard = recording.ring_m(Pose(7.0, 0.0, 0.0), ring)
    # The wall at the end of the corridor, and those beside, all seen by the scans.
    assert heard[0] == pytest.approx(8.0, abs=0.2)
    assert heard[[5, 6, 18, 19]] == pytest.approx(1.0, abs=0.2)
    # From the northern corridor's end back: the robot never looked that way there.
    behind = recording.ring_m(Pose(3.0, 12.0, 0.0), ring)
    assert behind[[6, 18]] == pytest.approx(1.0, abs=0.2)
    assert behind[12] == pytest.approx(4.0, abs=0.3)


def test_a_grid_that_the_log_does_not_show_is_refused(around: Path) -> None:
    wide = build((0.0, 60.0), (0.0, 50.0), np.ones(4, np.uint8), 2.0)
    with pytest.raises(CarmenError, match=r"robot\.log: found a plan of .* expected one large"):
        record(around, wide)
