"""From what the decider is told to the situation that it decides on."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bus.grid import OPPOSITE, Grid
from bus.messages import AskedErrand, AskedPath, MapBelief, Registrations
from modules.decider.settings import Settings
from modules.decider.situation import Situation
from modules.decider.whereabouts import Whereabouts


def situation_of(grid: Grid, settings: Settings, asked: AskedPath, belief: MapBelief) -> Situation:
    """The situation of a robot that knows where it is."""
    return Situation(
        grid=grid,
        place=grid.intersection(belief.x, belief.y),
        came_from=OPPOSITE[belief.heading],
        waypoints=tuple(asked.waypoints.tolist()),
        tasks=asked.tasks,
        expected=_expected(settings, asked),
        maps=belief.maps,
        weights=belief.weights,
        log_probability=belief.log_probability,
        corridor_probability=belief.corridors,
        corridor_s=belief.drive_s,
        sensing_s=settings.sensing_s,
    )


def whereabouts_of(
    grid: Grid,
    settings: Settings,
    asked: AskedPath,
    said: Registrations | None,
    due: AskedErrand | None,
) -> Whereabouts | None:
    """A situation for each place where the robot may be; None where it knows its place.

    The path is asked for what is left if nobody waits at the junction ahead: where somebody does,
    it is asked for again. So a place that would be the errand's end is left out. In spare time the
    likeliest place counts alone.
    """
    if said is None or said.visit != asked.visit:
        return None
    if len(asked.waypoints):
        rows = np.flatnonzero(said.places != asked.waypoints[0])
    else:
        rows = np.array([said.weights.argmax()])
    if not len(rows):
        return None
    weights = said.weights[rows]
    hurried = due is not None and due.visit == asked.visit
    return Whereabouts(
        tuple(_registered(grid, settings, asked, said, int(row)) for row in rows),
        weights / weights.sum(),
        said.ahead[rows],
        (due.due_ns - asked.until_ns) / 1e9 if due is not None and hurried else np.inf,
        due.late_price if due is not None and hurried else 0.0,
    )


def _registered(
    grid: Grid, settings: Settings, asked: AskedPath, said: Registrations, row: int
) -> Situation:
    """The situation if the robot is where one registration says."""
    maps = said.of == row
    return Situation(
        grid=grid,
        place=int(said.places[row]),
        came_from=OPPOSITE[said.heading],
        waypoints=tuple(asked.waypoints.tolist()),
        tasks=asked.tasks,
        expected=_expected(settings, asked),
        maps=said.maps[maps],
        weights=said.map_weights[maps],
        log_probability=said.log_probability[maps],
        corridor_probability=said.corridors[row],
        corridor_s=said.drive_s[row],
        sensing_s=settings.sensing_s,
    )


def _expected(settings: Settings, asked: AskedPath) -> NDArray[np.float64]:
    return asked.expected if settings.explores else np.zeros_like(asked.expected)
