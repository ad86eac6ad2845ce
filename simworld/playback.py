"""A real robot's log as percepts: what its laser and wheels said, at the times of the log.

Its scans are heard as pings of a ring (:mod:`simworld.laser_ring`), its odometry as reports of the
wheels. Times are ns since the log begins.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import chain, pairwise
from typing import TypeAlias

from bus.messages import Message, Odometry, Sonar, TruePose
from simworld import carmen
from simworld.building import Building
from simworld.carmen import CarmenError, CarmenLog, Scan
from simworld.laser_ring import ring_of_scan

Timed: TypeAlias = tuple[int, Message]


def percepts(log: CarmenLog, scans: Iterable[Scan], building: Building) -> tuple[Timed, ...]:
    """What the recorded robot sensed, and at each scan where it really was, in order.

    ``scans`` are the log's, their poses moved onto the building's grid lines. Of several at one
    moment the truth comes first, then the wheels. Raises CarmenError for a log with fewer than two
    reports of the wheels.
    """
    begins_s = log_begins_s(log)
    poses, pings = [], []
    for number, scan in enumerate(scans, 1):
        at_ns = since_ns(scan.time_s, begins_s)
        pings.append((at_ns, Sonar(number, 0, at_ns, ring_of_scan(scan))))
        place = nearest_place(building, scan.x_m, scan.y_m)
        poses.append((at_ns, TruePose(scan.x_m, scan.y_m, scan.heading_rad, place)))
    moves = [
        (since_ns(after.time_s, begins_s), _moved(before, after))
        for before, after in pairwise(_timed(log.odometry))
    ]
    said: chain[Timed] = chain(poses, moves, pings)
    return tuple(sorted(said, key=lambda timed: timed[0]))


def log_begins_s(log: CarmenLog) -> float:
    """The time of the first report of the wheels or scan. Raises CarmenError."""
    reports = tuple(_timed(log.odometry))
    if len(reports) < 2:
        raise CarmenError(
            f"found {len(reports)} ODOM lines with times, expected at least two to play back"
        )
    return min(reports[0].time_s, *(scan.time_s for scan in log.scans))


def since_ns(time_s: float, begins_s: float) -> int:
    """A time of the log in ns since its beginning."""
    return round((time_s - begins_s) * 1e9)


def nearest_place(building: Building, x_m: float, y_m: float) -> int:
    """The intersection nearest to a point."""
    x = min(range(len(building.columns_m)), key=lambda k: abs(building.columns_m[k] - x_m))
    y = min(range(len(building.rows_m)), key=lambda k: abs(building.rows_m[k] - y_m))
    return building.grid.intersection(x, y)


def _timed(reports: Iterable[carmen.Odometry]) -> Iterator[carmen.Odometry]:
    """Those later than all before. What a mapper has put in between has no time of its own."""
    latest_s = 0.0
    for report in reports:
        if report.time_s > latest_s:
            latest_s = report.time_s
            yield report


def _moved(before: carmen.Odometry, after: carmen.Odometry) -> Odometry:
    """How far ahead the wheels went, and how far they turned, from one report to the next."""
    dx_m, dy_m = after.x_m - before.x_m, after.y_m - before.y_m
    turn_rad = math.remainder(after.heading_rad - before.heading_rad, math.tau)
    along_rad = before.heading_rad + turn_rad / 2
    ahead_m = dx_m * math.cos(along_rad) + dy_m * math.sin(along_rad)
    return Odometry(ahead_m, turn_rad, after.time_s - before.time_s)
