"""Following a corridor by the echoes of its walls: where in it the robot is, and how it steers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

GLIMPSES = 50
"""So many are fitted together: 1.5 m of wall, which tells the heading to a third of a degree."""

STRAYS_M = 0.08
"""What is further off the line is of no wall: a door frame, a lost echo, or another's."""

NEAR, FAR = 0.35, 1.7
"""Echoes of a wall, in half widths of the corridor."""

ASKEW_BEFORE = 0.4
"""The slope is about 0 beforehand: an echo's standard deviation, 2 cm, to the slope's, 3 degrees.
So the first echoes, one of which may be another's, do not turn the robot round."""

LEAD_M = 0.8
"""The robot aims at the corridor's middle so far ahead."""

STEERS = 0.3
"""Share of the error in heading that one step corrects."""

MOST_RAD = math.radians(4.0)


@dataclass(frozen=True)
class Glimpse:
    """What one firing said of both walls, by the wheels' count since the approach began.

    ``forward_m, left_m`` and ``turned_rad`` are the place by dead reckoning, ``to_left_m`` and
    ``to_right_m`` the ranges on both sides, nan for none.
    """

    forward_m: float
    left_m: float
    turned_rad: float
    to_left_m: float
    to_right_m: float


@dataclass(frozen=True)
class InCorridor:
    """Where the robot is in the corridor: left of its middle, and turned to the left of it."""

    left_m: float
    askew_rad: float


def offset_m(glimpse: Glimpse, half_m: float) -> float:
    """How far left of the middle one firing says that the robot is; nan where no wall was heard.

    ``half_m`` is half the corridor's width as known before, for a wall that is heard alone.
    """
    left = _of_wall_m(glimpse.to_left_m, half_m)
    right = _of_wall_m(glimpse.to_right_m, half_m)
    if math.isnan(left):
        return right - half_m
    return half_m - left if math.isnan(right) else (right - left) / 2.0


def _of_wall_m(range_m: float, half_m: float) -> float:
    return range_m if NEAR * half_m <= range_m <= FAR * half_m else math.nan


def wall_m(ranges_m: Sequence[float], half_m: float) -> float:
    """How far a side's wall is, by all that was heard of it; ``half_m`` where nothing was."""
    heard = [range_m for range_m in ranges_m if not math.isnan(_of_wall_m(range_m, half_m))]
    return float(np.median(heard)) if heard else half_m


def located(glimpses: Sequence[Glimpse], half_m: float) -> InCorridor:
    """The place in the corridor by a line through the last glimpses, by least squares.

    In the frame of the wheels the corridor is a straight line, so the offsets less the way that
    the wheels say was gone sideways lie on one.
    """
    last = glimpses[-GLIMPSES:]
    now = last[-1]
    along = np.array([glimpse.forward_m for glimpse in last])
    off = np.array([offset_m(glimpse, half_m) - glimpse.left_m for glimpse in last])
    heard = np.isfinite(off)
    if heard.sum() < 3:
        return InCorridor(float(off[heard].mean()) if heard.any() else 0.0, 0.0)
    at_zero, slope = _line(along[heard], off[heard])
    strays = np.abs(off - at_zero - slope * along) > STRAYS_M
    if strays.any() and (heard & ~strays).sum() >= 3:
        at_zero, slope = _line(along[heard & ~strays], off[heard & ~strays])
    return InCorridor(
        left_m=at_zero + slope * now.forward_m + now.left_m,
        askew_rad=math.atan(slope) + now.turned_rad,
    )


def _line(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float]:
    """Value at zero and slope of the line with the least squares, the slope being small."""
    lever = np.vstack([np.column_stack([np.ones(len(x)), x]), [0.0, ASKEW_BEFORE]])
    at_zero, slope = np.linalg.lstsq(lever, np.append(y, 0.0), rcond=None)[0]
    return float(at_zero), float(slope)


def steering_rad(place: InCorridor) -> float:
    """How far to turn in the next step, towards the middle a little ahead."""
    wanted = math.atan2(-place.left_m, LEAD_M)
    wanted = max(-MOST_RAD, min(MOST_RAD, wanted))
    return STEERS * (wanted - place.askew_rad)
