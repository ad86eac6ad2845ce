"""How several registrations lie to one another on one grid, and where a robot could look."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import DIRECTIONS, Grid
from modules.decider.as_if_kernels import Frames
from modules.decider.options import levels_at
from modules.decider.roads import PLANNED, SEEN_ABSENT, roads_of
from modules.decider.route_kernels import ways_to
from modules.decider.situation import Situation

Ints = NDArray[np.int64]


def frames_of(situations: Sequence[Situation], junction_type: int) -> Frames:
    """The registrations of ``situations``, once the type at the intersection ahead is known."""
    grid = situations[0].grid
    seconds = np.array([s.corridor_s for s in situations])
    roads = roads_of(grid, seconds[0])
    places = [s.place for s in situations]
    return Frames(
        roads.corridor,
        roads.neighbour,
        seconds,
        np.array([levels_at(s, junction_type) for s in situations]),
        np.array([[shifted(grid, of, to) for to in places] for of in places]),
        np.array([[corridors_shifted(grid, of, to) for to in places] for of in places]),
        situations[0].sensing_s,
        roads.penalty_s,
    )


def shifted(grid: Grid, of: int, to: int) -> Ints:
    """(intersections,): where each intersection lies if ``of`` lies at ``to``; -1 off the grid."""
    (x0, y0), (x1, y1) = grid.place(of), grid.place(to)
    found = np.full(grid.intersections, -1, np.int64)
    for v in range(grid.intersections):
        x, y = grid.place(v)
        x, y = x + x1 - x0, y + y1 - y0
        if 0 <= x < grid.columns and 0 <= y < grid.rows:
            found[v] = grid.intersection(x, y)
    return found


def corridors_shifted(grid: Grid, of: int, to: int) -> Ints:
    """(corridors,): which corridor comes to lie on each if ``of`` lies at ``to``; or -1."""
    back = shifted(grid, to, of)
    found = np.full(grid.corridors, -1, np.int64)
    for v in range(grid.intersections):
        for direction in DIRECTIONS[:2]:
            corridor = grid.corridor(*grid.place(v), direction)
            if corridor >= 0 and back[v] >= 0:
                found[corridor] = grid.corridor(*grid.place(int(back[v])), direction)
    return found


@dataclass(frozen=True, eq=False)
class Route:
    """A way to somewhere to look, as the registration of ``frame`` has it.

    ``steps`` are direction numbers; it leads to the intersection ``to``.
    """

    frame: int
    steps: Ints
    to: int


def routes_to_look(situations: Sequence[Situation], frames: Frames, most: int) -> list[Route]:
    """The ``most`` nearest places that a registration knows a way to, each way once.

    Ways over corridors that are known to exist, in order of their time; of ways with the same
    steps the first registration's.
    """
    found: dict[tuple[int, ...], tuple[float, Route]] = {}
    for number, s in enumerate(situations):
        roads = roads_of(s.grid, s.corridor_s)
        known = np.where(frames.levels[number] == PLANNED, PLANNED, SEEN_ABSENT).astype(np.uint8)
        places = np.array([v for v in range(s.grid.intersections) if v != s.place], np.int64)
        ways = ways_to(roads, known, PLANNED, s.place, places)
        for to, way in zip(places.tolist(), ways, strict=True):
            steps = tuple(way[way >= 0].tolist())
            if steps and steps not in found:
                route = Route(number, np.array(steps, np.int64), to)
                found[steps] = _time_s(s, steps), route
    order = sorted(found, key=lambda steps: (found[steps][0], steps))
    return [found[steps][1] for steps in order[:most]]


def _time_s(situation: Situation, steps: Sequence[int]) -> float:
    grid, place, total = situation.grid, situation.place, 0.0
    roads = roads_of(grid, situation.corridor_s)
    for step in steps:
        total += float(roads.seconds[roads.corridor[place, step]])
        place = int(roads.neighbour[place, step])
    return total
