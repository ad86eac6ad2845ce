"""Following a corridor by the echoes of its walls: where in it the robot is, and how it steers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

GLIMPSES = 50
"""So many are fitted together: 1.5 m of wall, which tells the heading to a third of a degree."""

STRAYS_M = 0.03
"""An echo so far off the line counts half: a door frame, a recess, or another's echo. Passes of
reweighted least squares (Cauchy's weights) find the line that most of them lie on."""

STRAYS_OFF_M = 0.06
"""Three standard deviations of an echo at a metre: further off the line it is not of the wall."""

PASSES = 4

ASKEW_BEFORE = 0.5
"""The slope is about 0 beforehand, as much as this says beside errors of one: the robot came along
the corridor, and recesses err all together."""

MOST_SLOPE = math.tan(math.radians(6.0))
"""Nobody who comes along a corridor is more askew; echoes that say so are not of its walls."""

NEAR, FAR = 0.35, 1.7
"""Echoes of a wall, in half widths of the corridor."""

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
        return InCorridor(left_m=0.0, askew_rad=now.turned_rad)
    at_zero, slope = _line(along[heard], off[heard])
    return InCorridor(
        left_m=at_zero + slope * now.forward_m + now.left_m,
        askew_rad=math.atan(slope) + now.turned_rad,
    )


def stray_share(glimpses: Sequence[Glimpse]) -> float:
    """The share of what was heard to the left and the right that is not of one straight wall each.

    Nothing heard is not of a wall, either.
    """
    along = np.array([glimpse.forward_m for glimpse in glimpses])
    left = np.array([glimpse.to_left_m + glimpse.left_m for glimpse in glimpses])
    right = np.array([glimpse.to_right_m - glimpse.left_m for glimpse in glimpses])
    return sum(_strays(along, side) for side in (left, right)) / (2 * len(glimpses))


def _strays(along: NDArray[np.float64], side: NDArray[np.float64]) -> int:
    heard = np.isfinite(side)
    if heard.sum() < 3:
        return len(side)
    at_zero, slope = _line(along[heard], side[heard])
    return int((~(np.abs(side - at_zero - slope * along) <= STRAYS_OFF_M)).sum())


def _line(x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[float, float]:
    """Value at zero and slope of the line that fits most points, the slope being small."""
    lever = np.vstack([np.column_stack([np.ones(len(x)), x]), [0.0, ASKEW_BEFORE]])
    wanted = np.append(y, 0.0)
    line = np.array([np.median(y), 0.0])
    for _ in range(PASSES):
        off = wanted - lever @ line
        weight = 1.0 / np.sqrt(1.0 + (off / STRAYS_M) ** 2)
        weight[-1] = 1.0
        line = np.linalg.lstsq(lever * weight[:, None], wanted * weight, rcond=None)[0]
    slope = max(-MOST_SLOPE, min(MOST_SLOPE, float(line[1])))
    return float(np.median(y - slope * x)) if abs(slope) == MOST_SLOPE else float(line[0]), slope


def steering_rad(place: InCorridor) -> float:
    """How far to turn in the next step, towards the middle a little ahead."""
    wanted = math.atan2(-place.left_m, LEAD_M)
    wanted = max(-MOST_RAD, min(MOST_RAD, wanted))
    return STEERS * (wanted - place.askew_rad)
