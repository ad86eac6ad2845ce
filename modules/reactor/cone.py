"""What a sonar cone hears of a round thing: range and whether it is heard at all.

A transducer hears the nearest point inside its cone. A thing that only grazes the cone is
heard a little further off than its nearest point, and that difference between neighbouring
transducers is what tells on which side of the centre line a person walks.
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
Flags: TypeAlias = NDArray[np.bool_]


def heard_in_cone(
    ahead_m: Floats, left_m: Floats, radius_m: float, axis_rad: float, half_angle_rad: float
) -> tuple[Floats, Flags]:
    """Range to a disc's nearest point in a cone at the origin, and whether the cone holds any.

    ``ahead_m`` and ``left_m`` are the disc's centre in the robot's frame (x ahead, y left);
    they broadcast, and so do the answers. Where nothing is heard the range is that of the
    nearest edge of the cone, a lower bound that is of no use.
    """
    away = np.maximum(np.hypot(ahead_m, left_m), radius_m * 1.0001)
    bearing = np.arctan2(left_m, ahead_m)
    looks = np.clip(bearing, axis_rad - half_angle_rad, axis_rad + half_angle_rad)
    off = looks - bearing
    heard: Flags = np.abs(off) <= np.arcsin(radius_m / away)
    inside = np.maximum(radius_m**2 - (away * np.sin(off)) ** 2, 0.0)
    return away * np.cos(off) - np.sqrt(inside), heard
