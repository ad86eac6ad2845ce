"""Keeping to the middle of a corridor: a reflex below the decision processes.

The corridors of a :class:`~simworld.building.Building` lie on their grid lines; those of a real
building are some decimetres beside them, and everybody walks where the corridor is.
"""

from __future__ import annotations

import numpy as np

from simworld.floor_plan import FloorPlan
from simworld.motion import Pose
from simworld.sonar import Surroundings

ACROSS_M = np.linspace(-0.7, 0.7, 29)
"""Where the middle is looked for, left of the grid line."""

ALONG_M = np.linspace(-1.5, 1.5, 16)
"""What is looked at for it: a box or a door makes nobody turn aside, a bent wall does."""

ROOM_M = 1.0
"""More room than this (half the paper's widest corridor) on both sides makes no difference."""

LEAN = 0.05
"""Metres of room that a metre off the grid line must gain."""

BUMPER_M = 0.3
"""From the robot's centre to a wall at which it goes no further sideways: its radius and 5 cm."""

SHARES = np.linspace(1.0, 0.0, 14)
"""Of the way aside, the farthest first."""


def in_the_middle(surroundings: Surroundings, on_line: Pose) -> Pose:
    """The pose moved sideways from the grid line to the middle of the corridor there.

    The middle is where there is most room, on the average over a little way ahead and behind.
    """
    if not isinstance(surroundings, FloorPlan):
        return on_line
    c, s = np.cos(on_line.heading_rad), np.sin(on_line.heading_rad)
    along, across = ALONG_M[:, None], ACROSS_M[None, :]
    x_m, y_m = on_line.x_m + along * c - across * s, on_line.y_m + along * s + across * c
    room = np.minimum(surroundings.clearance_m(x_m, y_m), ROOM_M) - LEAN * np.abs(across)
    return on_line.beside(float(ACROSS_M[room.argmax(axis=1)].mean()))


def off_the_walls(surroundings: Surroundings, middle: Pose, left_m: float) -> Pose:
    """The pose so far left of the middle, or as far as leaves ``BUMPER_M`` to the walls."""
    there = middle.beside(left_m)
    if not isinstance(surroundings, FloorPlan):
        return there
    tried_m = left_m * SHARES
    c, s = np.cos(middle.heading_rad), np.sin(middle.heading_rad)
    room = surroundings.clearance_m(middle.x_m - tried_m * s, middle.y_m + tried_m * c)
    clear = np.flatnonzero(room >= BUMPER_M)
    return middle.beside(float(tried_m[clear[0]])) if len(clear) else there
