"""Which junctions a recorded robot came through, and when: its day in the words of the grid."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from bus.grid import DIRECTIONS, STEP
from simworld.building import Building
from simworld.carmen import Scan
from simworld.playback import nearest_place, since_ns

NEAR_M = 2.5
"""A robot so near to where grid lines cross is at that junction: junctions are squares of some
two metres, and lie some decimetres beside the lines."""


@dataclass(frozen=True)
class Stop:
    """A junction that the robot was at, from ``came_ns`` to ``left_ns``, in ns of the log.

    ``heading`` is the direction of the corridor by which it came; 0 for the first.
    """

    place: int
    heading: int
    came_ns: int
    left_ns: int


def tour(scans: Iterable[Scan], begins_s: float, building: Building) -> tuple[Stop, ...]:
    """The stops by corridors of the building, as far as the robot kept to them.

    ``scans`` have their poses on the building's grid lines. Where the robot left the corridors,
    through a room say, the tour ends.
    """
    stops: list[Stop] = []
    for stop in _stays(scans, begins_s, building):
        if stops:
            heading = _corridor(building, stops[-1].place, stop.place)
            if heading == 0:
                break
            stop = replace(stop, heading=heading)
        stops.append(stop)
    return tuple(stops)


def _stays(scans: Iterable[Scan], begins_s: float, building: Building) -> Iterator[Stop]:
    """Each junction that the robot was near, once for each time that it came from another."""
    stay: Stop | None = None
    for scan in scans:
        place = nearest_place(building, scan.x_m, scan.y_m)
        x_m, y_m = building.position_m(*building.grid.place(place))
        if math.dist((x_m, y_m), (scan.x_m, scan.y_m)) > NEAR_M:
            continue
        at_ns = since_ns(scan.time_s, begins_s)
        if stay is not None and stay.place == place:
            stay = replace(stay, left_ns=at_ns)
            continue
        if stay is not None:
            yield stay
        stay = Stop(place, 0, at_ns, at_ns)
    if stay is not None:
        yield stay


def _corridor(building: Building, start: int, end: int) -> int:
    """The direction of the corridor from one intersection to another; 0 if there is none."""
    grid = building.grid
    x, y = grid.place(start)
    for direction in DIRECTIONS:
        dx, dy = STEP[direction]
        corridor = grid.corridor(x, y, direction)
        if corridor >= 0 and building.corridors[corridor] and grid.place(end) == (x + dx, y + dy):
            return direction
    return 0
