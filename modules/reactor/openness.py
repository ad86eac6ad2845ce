"""Where it is free around the robot, and which ways past the clutter are open.

Where cones overlap, a surface would be heard by each of them, and the longest of their ranges is
how far it is free at least (as far as the surface echoes). That narrows the angle in which an echo
may lie, and tells a door frame beside the way from a box in it. A *sector* is what lies between two
neighbouring edges of cones, so that the same cones cover all of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.facts import Ring
from modules.reactor.cone import Floats
from modules.reactor.meeting import Body

LAST_RAD = math.radians(120.0)
"""So far to either side sectors are looked at."""

OPEN_M = 0.95
"""A way is open where this far ahead of the robot's centre nothing is in it (assumption)."""

SPARE_M = 0.02
"""Beside the robot, that counts as in its way."""

SPARE_BACK = 0.92
"""The same on the way back from beside a thing, as a share of half a sector's angle: at that
distance an echo may lie so far to either side of where it is taken to be."""

BEHIND_M = -0.3
"""What is further behind is passed."""

ASIDE_RAD = np.deg2rad(45.0)
"""From this bearing on a sector looks to the side."""


@dataclass(frozen=True, eq=False)
class Sectors:
    """The sectors of a ring, from right to left.

    ``covers`` (sectors, transducers) says whose cones cover each; ``middle_rad`` is its middle,
    ``across`` the larger sine at its two edges: a wall beside the robot echoes at the edge that is
    nearest to its normal. ``half_rad`` is half the angle of the widest.
    """

    covers: NDArray[np.bool_]
    middle_rad: Floats
    across: Floats
    half_rad: float

    def free_m(self, mean_m: Floats) -> Floats:
        """How far each sector is free: (sectors,), inf where no echo came back.

        ``mean_m`` (transducers,) ranges, NaN for no echo. One that heard another's ping does not
        shorten a sector that another covers, too.
        """
        heard = np.where(np.isnan(mean_m), np.inf, mean_m)
        free: Floats = np.where(self.covers, heard, 0.0).max(axis=1)
        return free


def sectors_of(ring: Ring) -> Sectors:
    """The sectors of a ring. What lies between its cones counts to the nearest of them."""
    step_rad = 2.0 * math.pi / ring.transducers
    half_rad = max(ring.half_angle_rad, step_rad / 2)
    last = ring.transducers // 2
    axes = np.arange(-last, last + 1) * step_rad
    ends = np.sort(np.concatenate([axes - half_rad, axes + half_rad]))
    ends = ends[np.abs(ends) <= LAST_RAD + 1e-9]
    ends = ends[np.append(True, np.diff(ends) > 1e-9)]
    middle = (ends[1:] + ends[:-1]) / 2
    off = np.remainder(middle[:, None] - np.arange(ring.transducers) * step_rad + math.pi, math.tau)
    sines = np.abs(np.sin(ends))
    return Sectors(
        covers=np.abs(off - math.pi) < half_rad,
        middle_rad=middle,
        across=np.maximum(sines[1:], sines[:-1]),
        half_rad=float(np.diff(ends).max()) / 2,
    )


def walls_m(free_m: Floats, sectors: Sectors) -> tuple[float, float]:
    """How far to the left and right of the robot's centre the nearest surfaces are; inf for none.

    ``free_m`` as of :meth:`Sectors.free_m`.
    """
    across = free_m * sectors.across
    left_m = across[sectors.middle_rad > ASIDE_RAD].min()
    right_m = across[sectors.middle_rad < -ASIDE_RAD].min()
    return float(left_m), float(right_m)


def open_acts(
    free_m: Floats, sectors: Sectors, goals_m: Floats, lateral_m: float, body: Body
) -> Floats:
    """Which acts lead where nothing stands, (acts,) of 0 and 1.

    ``free_m`` as of :meth:`Sectors.free_m`; ``goals_m`` (acts,) is where across the corridor each
    act ends, ``lateral_m`` where the robot is.
    """
    left = _surfaces_m(free_m, sectors, lateral_m)
    closed = np.abs(left[None, :] - goals_m[:, None]) < body.radius_m + SPARE_M
    return np.where(closed.any(axis=1), 0.0, 1.0)


def back_is_open(free_m: Floats, sectors: Sectors, lateral_m: float, body: Body) -> bool:
    """Whether nothing stands where the robot would be in the middle, by a wide margin.

    Nor between there and the robot: of what is beside it only the nearest point is heard.
    """
    reach_m = body.radius_m + SPARE_BACK * sectors.half_rad
    if (np.abs(_surfaces_m(free_m, sectors, lateral_m)) < reach_m).any():
        return False
    beside = _surfaces_m(free_m, sectors, lateral_m, -BEHIND_M)
    between = (beside > min(lateral_m, -reach_m)) & (beside < max(lateral_m, reach_m))
    return not between.any()


def _surfaces_m(
    free_m: Floats, sectors: Sectors, lateral_m: float, until_m: float = OPEN_M
) -> Floats:
    """How far left of the centre line the surfaces are that are not passed, nor further ahead."""
    near = np.isfinite(free_m)
    ahead = free_m[near] * np.cos(sectors.middle_rad[near])
    left: Floats = free_m[near] * np.sin(sectors.middle_rad[near]) + lateral_m
    return left[(ahead > BEHIND_M) & (ahead < until_m)]
