"""What a sonar cone hears of a round thing: range and whether it is heard at all.

A transducer hears the nearest point inside its cone. A thing that only grazes the cone is
heard a little further off than its nearest point, and that difference between neighbouring
transducers is what tells on which side of the centre line a person walks.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

from bus.facts import Ring

Floats: TypeAlias = NDArray[np.float64]

TRANSDUCERS = 24
HALF_ANGLE_RAD = math.radians(15.0)
AXES_RAD: Floats = np.deg2rad([0.0, 15.0, -15.0, 30.0, -30.0])
"""Where the five transducers that look ahead point; a *cone* is an index into this."""

EDGES: Floats = np.stack(
    [
        np.cos(AXES_RAD + HALF_ANGLE_RAD),
        np.sin(AXES_RAD + HALF_ANGLE_RAD),
        np.cos(AXES_RAD - HALF_ANGLE_RAD),
        np.sin(AXES_RAD - HALF_ANGLE_RAD),
    ],
    axis=1,
)
"""Unit vectors along the left and the right edge of each cone, (cones, 4)."""


class RingError(ValueError):
    """A sonar ring whose cones are not those that the reactor's tables are made for."""


def check_ring(ring: Ring) -> None:
    """Raise RingError unless the ring's cones ahead are the five of AXES_RAD."""
    if not (ring.transducers == TRANSDUCERS and math.isclose(ring.half_angle_rad, HALF_ANGLE_RAD)):
        raise RingError(
            f"found a ring of {ring.transducers} transducers with cones of "
            f"{math.degrees(ring.half_angle_rad):g} degrees to each side, "
            f"expected {TRANSDUCERS} of {math.degrees(HALF_ANGLE_RAD):g}"
        )


@njit(cache=True)
def heard_in_cone(ahead_m: float, left_m: float, radius_m: float, cone: int) -> tuple[float, bool]:
    """Range to a disc's nearest point in a cone at the origin, and whether the cone holds any.

    ``ahead_m`` and ``left_m`` are the disc's centre in the robot's frame (x ahead, y left).
    Where nothing is heard the range is of no use.
    """
    away = math.sqrt(ahead_m * ahead_m + left_m * left_m)
    if away < radius_m * 1.0001:  # inside the disc: as if at its rim
        return 0.0001 * radius_m, ahead_m > 0.0
    beyond_left = EDGES[cone, 0] * left_m - EDGES[cone, 1] * ahead_m
    beyond_right = EDGES[cone, 3] * ahead_m - EDGES[cone, 2] * left_m
    if beyond_left <= 0.0 and beyond_right <= 0.0:
        return away - radius_m, True
    if beyond_left > 0.0:
        along = EDGES[cone, 0] * ahead_m + EDGES[cone, 1] * left_m
        inside = radius_m * radius_m - beyond_left * beyond_left
    else:
        along = EDGES[cone, 2] * ahead_m + EDGES[cone, 3] * left_m
        inside = radius_m * radius_m - beyond_right * beyond_right
    if inside < 0.0 or along < 0.0:
        return along, False
    return along - math.sqrt(inside), True
