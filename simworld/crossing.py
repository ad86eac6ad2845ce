"""Where the junctions of a real building are: a reflex below the decision processes.

On a :class:`~simworld.building.Building` a junction lies where its grid lines cross. In a real one
each corridor lies some decimetres beside its line, and a doorway anywhere in its wall; a robot that
stops "at a port" (paper, section 2) stops where the walls really open.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from bus.grid import DIRECTIONS, EAST, NORTH, SOUTH, WEST
from simworld.building import Building
from simworld.floor_plan import FloorPlan
from simworld.motion import HEADING_RAD
from simworld.sonar import Surroundings

ACROSS_M = np.linspace(-0.7, 0.7, 57)
"""Where the way into a corridor is looked for, beside its grid line."""

INTO_M = np.linspace(0.0, 1.5, 16)
"""How far into a corridor, from the nominal port on, its narrowest place is looked for."""

ROOM_M = 1.0
"""More room than this (half the paper's widest corridor) makes no way better."""

LEAN = 0.05
"""Metres of room that a metre off the grid line must gain."""


def crossing_m(surroundings: Surroundings, building: Building, place: int) -> tuple[float, float]:
    """Where the ways into a junction's corridors cross, x and y in metres.

    The way into a corridor is the straight one, along its grid line, that has most room at its
    narrowest place: the middle of the corridor, or of the doorway. Along an axis on which no
    corridor leads to the junction, the grid line counts.
    """
    x, y = building.grid.place(place)
    at_m = building.position_m(x, y)
    if not isinstance(surroundings, FloorPlan):
        return at_m
    sides = [side for side in DIRECTIONS if building.truth_type(x, y) & side]
    half_m = building.corridor_width_m / 2
    east_m = _off_line_m(surroundings, at_m, [s for s in sides if s in (NORTH, SOUTH)], half_m)
    north_m = _off_line_m(surroundings, at_m, [s for s in sides if s in (EAST, WEST)], half_m)
    return at_m[0] + east_m, at_m[1] + north_m


def _off_line_m(
    plan: FloorPlan, at_m: tuple[float, float], sides: list[int], half_m: float
) -> float:
    """How far east of a column, or north of a row, the way into corridors on this line is."""
    if not sides:
        return 0.0
    room_m = np.minimum.reduce([_narrowest_m(plan, at_m, side, half_m) for side in sides])
    best = room_m - LEAN * np.abs(ACROSS_M)
    return float(ACROSS_M[best >= best.max() - plan.cells.resolution_m / 2].mean())


def _narrowest_m(
    plan: FloorPlan, at_m: tuple[float, float], side: int, half_m: float
) -> NDArray[np.float64]:
    """Least room on each way into the corridor on one side, (ways,), west or south first."""
    c, s = math.cos(HEADING_RAD[side]), math.sin(HEADING_RAD[side])
    along, across = half_m + INTO_M[:, None], ACROSS_M[None, :]
    x_m = at_m[0] + along * c + across * abs(s)
    y_m = at_m[1] + along * s + across * abs(c)
    room_m: NDArray[np.float64] = np.minimum(plan.clearance_m(x_m, y_m), ROOM_M).min(axis=0)
    return room_m
