"""What a calibration's trial takes place in: one junction, doors in its walls, somebody about."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from bus.features import DOOR_JAMB, PLACES, Place
from bus.grid import DIRECTIONS, EAST, NORTH, OPPOSITE, Grid
from modules.classifier.geometry import JAMB_RATE
from simworld.building import Building, build
from simworld.fittings import Doorway, Side, fitted
from simworld.motion import HEADING_RAD, Pose

CORRIDOR_M = 20.0
"""Longer than the sonar reaches, so that a far end never looks like a wall of the junction."""

DOOR_WIDTHS_M = (0.7, 1.0)
DOOR_OFF = 0.3
"""Doorways are uniform over these widths, their middles over so many half corridor widths to
either side of their place (assumption)."""

DOOR_DEPTHS_M = (0.08, 0.3)
"""How far a closed door stands back from the wall (assumption)."""

ROOM_M = 3.0
OPEN_SHARE = 0.1
"""Share of doors that stand open, to a room so deep (assumption)."""

BYSTANDER_RADIUS_M = 0.25
BYSTANDER_KEEPS_OFF_M = 0.6
"""The least distance between the centres of a bystander and the robot."""

_OTHER: dict[Side, Side] = {"left": "right", "right": "left"}


def junction(junction_type: int, width_m: float, doorways: Sequence[Doorway] = ()) -> Building:
    """A building of nothing but one junction and the corridors it has, its centre at (0, 0)."""
    grid = Grid(3, 3)
    corridors = np.zeros(grid.corridors, dtype=np.uint8)
    for direction in DIRECTIONS:
        corridors[grid.corridor(1, 1, direction)] = bool(junction_type & direction)
    lines_m = (-CORRIDOR_M, 0.0, CORRIDOR_M)
    return fitted(build(lines_m, lines_m, corridors, width_m), doorways)


def jambs(junction_type: int, heading: int, rng: np.random.Generator) -> dict[Place, bool]:
    """Where there are door jambs, drawn with the rate of the geometry, and where not."""
    return {
        place: place.shows(DOOR_JAMB, junction_type, heading) is None
        and bool(rng.random() < JAMB_RATE)
        for place in PLACES
        if DOOR_JAMB in place.holds
    }


def doorway(place: Place, heading: int, width_m: float, rng: np.random.Generator) -> Doorway:
    """A doorway of random size beside a place, in the frame of a corridor ``width_m`` wide."""
    ahead_m = (place.x - 1.0 + float(rng.uniform(-DOOR_OFF, DOOR_OFF))) * width_m / 2
    side: Side = "left" if place.y > 0 else "right"
    depth_m = ROOM_M if rng.random() < OPEN_SHARE else float(rng.uniform(*DOOR_DEPTHS_M))
    forwards = heading in (EAST, NORTH)
    return Doorway(
        corridor=Grid(3, 3).corridor(1, 1, OPPOSITE[heading]),
        at_m=CORRIDOR_M + ahead_m if forwards else -ahead_m,
        side=side if forwards else _OTHER[side],
        width_m=float(rng.uniform(*DOOR_WIDTHS_M)),
        depth_m=depth_m,
    )


def at_port(
    building: Building, heading: int, lateral_m: float, askew_rad: float, along_m: float = 0.0
) -> Pose:
    """``along_m`` beyond the port line, ``lateral_m`` to the left of the axis, turned to the left.

    ``askew_rad`` is how far it is turned.
    """
    axis = HEADING_RAD[heading]
    back_m = along_m - building.corridor_width_m / 2
    return Pose(
        back_m * math.cos(axis) - lateral_m * math.sin(axis),
        back_m * math.sin(axis) + lateral_m * math.cos(axis),
        axis + askew_rad,
    )


def bystander(
    building: Building, robot: Pose, rng: np.random.Generator
) -> tuple[tuple[float, float, float], ...]:
    """Somebody within three half widths of the junction's centre, clear of walls and robot."""
    reach_m = 1.5 * building.corridor_width_m
    while True:
        x_m, y_m = (float(v) for v in rng.uniform(-reach_m, reach_m, size=2))
        off_m = math.hypot(x_m - robot.x_m, y_m - robot.y_m)
        if off_m >= BYSTANDER_KEEPS_OFF_M and building.clearance_m(x_m, y_m) >= BYSTANDER_RADIUS_M:
            return ((x_m, y_m, BYSTANDER_RADIUS_M),)
