"""Recognising the port of an LDP by an abrupt change in one wall, from the ring's echoes.

"A corridor is defined as a piece of rectangular space bounded on two sides by uninterrupted
parallel surfaces ... and bounded on the other two sides by *ports* indicated by abrupt changes in
one of the two parallel surfaces" (paper, section 2).

A transducer that looks ahead and aside hears the wall, then the corner where it ends, and at once
nothing near any more: the corner left its cone at a known bearing, a little before the robot is
abreast of it, so that the robot can stop in time. Where both walls run on, a wall ahead tells how
far it is; where nothing changes at all, the wheels do.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simworld.sonar import SonarRing

Floats = NDArray[np.float64]

LEAVES_RAD = math.radians(75.0)
"""The bearing at which a corner should leave the cone of the transducer that is listened to: a
quarter of the corridor's width before the robot is abreast of it."""

NEVER_LATER_RAD = math.radians(86.0)

GONE = 1.6
"""Beyond this share of the wall's distance it is not that wall, whose corner is 1.41 times as far
away when it enters the cone."""

WALL_BEFORE = 4
WALL_OF = 6
GONE_AFTER = 12
MOST_STRAYS = 1
"""An abrupt change: heard four times of six, then but once in twelve, which is 36 cm further. One
echo in fifty is lost and one in a hundred is another's. Where only a door interrupts the wall, its
far jamb is heard before: one of 0.7 m at once, one of a metre just in time."""

END_AGREES_M = 0.08
END_GLIMPSES = 5
"""A wall ahead is there if so many glimpses agree about where it is."""


class PortError(ValueError):
    """A ring that cannot tell ports."""


@dataclass(frozen=True)
class Ears:
    """Which transducers look left, right, ahead, behind, and ahead and aside.

    ``leaves_rad`` is the bearing at which a corner leaves the cones of the last two.
    """

    left: int
    right: int
    ahead: int
    behind: int
    early_left: int
    early_right: int
    leaves_rad: float


def ears_of(ring: SonarRing) -> Ears:
    """The transducers that follow walls and find ports.

    Raises PortError for a ring without one that a corner leaves before the robot is abreast of it.
    """
    axes = np.remainder(ring.axes_rad(0.0) + math.pi, 2.0 * math.pi) - math.pi
    leaves = axes + ring.half_angle_rad
    useful = (axes > 0.0) & (leaves < NEVER_LATER_RAD)
    if not useful.any():
        raise PortError(
            f"found a ring of {ring.transducers} transducers of "
            f"{math.degrees(ring.half_angle_rad):g} degrees to each side, expected one that looks "
            f"ahead and aside and not beyond {math.degrees(NEVER_LATER_RAD):g} degrees"
        )
    early = int(np.where(useful, np.abs(leaves - LEAVES_RAD), np.inf).argmin())
    side = _nearest(axes, math.pi / 2), _nearest(axes, -math.pi / 2)
    mirrored = _nearest(axes, -float(axes[early]))
    on = _nearest(axes, 0.0), _nearest(axes, math.pi)
    return Ears(*side, *on, early, mirrored, float(leaves[early]))


def _nearest(axes: Floats, bearing_rad: float) -> int:
    off = np.abs(np.remainder(axes - bearing_rad + math.pi, 2.0 * math.pi) - math.pi)
    return int(off.argmin())


def has_ended(early_m: Sequence[float], wall_m: float) -> bool:
    """Whether a wall ended before the last ``GONE_AFTER`` glimpses, and just before them.

    ``early_m`` is what the transducer ahead and aside heard at each place, nan for no echo;
    ``wall_m`` how far the wall is to that side.
    """
    heard = [range_m <= GONE * wall_m for range_m in early_m[-(WALL_OF + GONE_AFTER) :]]
    before, after = heard[:-GONE_AFTER], heard[-GONE_AFTER:]
    wall = len(before) == WALL_OF and before[-1] and sum(before) >= WALL_BEFORE
    return wall and not after[0] and sum(after) <= MOST_STRAYS


def end_at_m(driven_m: Sequence[float], ahead_m: Sequence[float]) -> float | None:
    """Where the wall ahead is: metres from where the count began, None for none.

    The last echoes must agree; what somebody else's ping or a lost one says does not.
    """
    places = np.asarray(driven_m[-END_GLIMPSES:]) + np.asarray(ahead_m[-END_GLIMPSES:])
    places = places[np.isfinite(places)]
    if len(places) == 0:
        return None
    middle = float(np.median(places))
    agree = np.abs(places - middle) <= END_AGREES_M
    return middle if agree.sum() >= END_GLIMPSES - 1 else None
