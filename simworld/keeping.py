"""Keeping to the middle of a corridor: a reflex below the decision processes.

The corridors of a :class:`~simworld.building.Building` lie on their grid lines; those of a real
building are some decimetres beside them, and everybody walks where the corridor is.
"""

from __future__ import annotations

from typing import NamedTuple

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

ASIDE_M = np.linspace(0.0, 1.0, 41)
"""Where room beside the middle is looked for."""


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


class Beside(NamedTuple):
    """How far left and right of the middle of a corridor the robot can be, metres.

    Where something stands in the middle (``clear`` is false), to the outer side of what is free
    beside it.
    """

    left_m: float
    right_m: float
    clear: bool = True


def room_beside(surroundings: Surroundings, middle: Pose) -> Beside:
    """The room beside the middle of a corridor."""
    if not isinstance(surroundings, FloorPlan):
        room_m = max(0.0, surroundings.corridor_width_m / 2 - BUMPER_M)
        return Beside(room_m, room_m)
    return Beside(
        _room_m(surroundings, middle, 1.0),
        _room_m(surroundings, middle, -1.0),
        bool(surroundings.clearance_m(middle.x_m, middle.y_m) >= BUMPER_M),
    )


def _room_m(plan: FloorPlan, middle: Pose, sign: float) -> float:
    """To one side: ``sign`` is 1 for left."""
    c, s = np.cos(middle.heading_rad), np.sin(middle.heading_rad)
    aside_m = sign * ASIDE_M
    clear = plan.clearance_m(middle.x_m - aside_m * s, middle.y_m + aside_m * c) >= BUMPER_M
    begins = int(clear.argmax())
    if not clear[begins]:
        return 0.0
    ends = begins + int((~np.append(clear[begins:], False)).argmax()) - 1
    return float(ASIDE_M[ends])
