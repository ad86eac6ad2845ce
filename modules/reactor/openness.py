"""Where it is free around the robot, and which ways past the clutter are open.

Neighbouring cones overlap: each direction is covered by two, so that a surface there would be
heard by both, and the longer of the two ranges is how far it is free at least (as far as the
surface echoes). That halves the angle in which an echo may lie, and tells a door frame beside
the way from a box in it. A *sector* is what lies between the axes of two neighbours.
"""

from __future__ import annotations

import numpy as np

from modules.reactor.cone import Floats
from modules.reactor.meeting import Body

STEP_RAD = np.deg2rad(15.0)
LAST = 8
"""Transducers from straight ahead to 120 degrees on either side."""

CONES = np.arange(-LAST, LAST + 1)
AXES_RAD: Floats = CONES * STEP_RAD
MIDDLES_RAD: Floats = (AXES_RAD[1:] + AXES_RAD[:-1]) / 2
ACROSS: Floats = np.maximum(np.abs(np.sin(AXES_RAD[1:])), np.abs(np.sin(AXES_RAD[:-1])))
"""A wall beside the robot echoes at the edge of a sector that is nearest to its normal."""

OPEN_M = 0.95
"""A way is open where this far ahead of the robot's centre nothing is in it (assumption)."""

SPARE_M = 0.02
"""Beside the robot, that counts as in its way."""

SPARE_BACK_M = 0.12
"""The same on the way back from beside a thing: half a sector at that distance, and more."""

BEHIND_M = -0.3
"""What is further behind is passed."""

ASIDE_RAD = np.deg2rad(45.0)
"""From this bearing on a sector looks to the side."""


def sectors_m(mean_m: Floats) -> Floats:
    """How far each sector is free, from right to left: (16,), inf where no echo came back.

    ``mean_m`` (transducers,) ranges, NaN for no echo. One that heard another's ping does not
    shorten a sector, for the other of the two did not.
    """
    heard = np.nan_to_num(mean_m[CONES], nan=np.inf)
    free: Floats = np.maximum(heard[1:], heard[:-1])
    return free


def walls_m(free_m: Floats) -> tuple[float, float]:
    """How far to the left and right of the robot's centre the nearest surfaces are; inf for none.

    ``free_m`` as of :func:`sectors_m`.
    """
    across = free_m * ACROSS
    left_m = across[MIDDLES_RAD > ASIDE_RAD].min()
    right_m = across[MIDDLES_RAD < -ASIDE_RAD].min()
    return float(left_m), float(right_m)


def open_acts(free_m: Floats, goals_m: Floats, lateral_m: float, body: Body) -> Floats:
    """Which acts lead where nothing stands, (acts,) of 0 and 1.

    ``free_m`` as of :func:`sectors_m`; ``goals_m`` (acts,) is where across the corridor each act
    ends, ``lateral_m`` where the robot is.
    """
    left = _surfaces_m(free_m, lateral_m)
    closed = np.abs(left[None, :] - goals_m[:, None]) < body.radius_m + SPARE_M
    return np.where(closed.any(axis=1), 0.0, 1.0)


def back_is_open(free_m: Floats, lateral_m: float, body: Body) -> bool:
    """Whether nothing stands where the robot would be in the middle, by a wide margin."""
    left = _surfaces_m(free_m, lateral_m)
    return not (np.abs(left) < body.radius_m + SPARE_BACK_M).any()


def _surfaces_m(free_m: Floats, lateral_m: float) -> Floats:
    """How far left of the centre line the surfaces are that are not passed, nor far ahead."""
    near = np.isfinite(free_m)
    ahead = free_m[near] * np.cos(MIDDLES_RAD[near])
    left: Floats = free_m[near] * np.sin(MIDDLES_RAD[near]) + lateral_m
    return left[(ahead > BEHIND_M) & (ahead < OPEN_M)]
