"""What the echoes of a detector's pings say about its feature.

"On the basis of the data gathered during the execution of a given feature detector, a
probability distribution is determined for the random variable corresponding to the proposition
that the feature is present at a specific location" (paper, section 2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bus.features import (
    CONCAVE_CORNER,
    CONVEX_CORNER,
    DOOR_JAMB,
    FLAT_WALL,
    OPENING,
    USUAL,
    Wedges,
)
from modules.detectors.actions import check_width
from modules.detectors.surfaces import Sector, hear
from modules.detectors.views import DetectorError, View, view_of
from modules.detectors.walls import fit_wall

CLASS_BOUNDS = (0.1, 0.5, 0.9)
"""Probabilities that part the evidence classes 0 (surely absent) .. 3 (surely present)."""

CORNER_RANGES = (0.65, 1.30)
"""Nearest and farthest echo of a corner, in half diagonals: widths 1.7 to 2.2 m for a nominal 2 m,
0.1 m to either side, and errors on the way to the vantage."""

AHEAD_OF_CORNER_RAD = math.radians(20.0)
"""Half width of the sector in which a corner answers: in a narrow corridor, off its axis and
askew, it is up to 18 degrees from where it should be."""

BEYOND_WALL = 1.12
"""A corner where a wall ends is further than the wall by at least this. The wall itself answers
up to 22.5 degrees from its normal, that is up to 1/cos(22.5 deg) = 1.08 times as far away, where
a cone beside the view hears it; the nearest corner is 1.15 times as far away."""

BESIDE_CORNER_RAD = math.radians(45.0)
"""Where the normals of the walls are that may meet at a corner, to either side of the view."""


@dataclass(frozen=True)
class Finding:
    """What a detector found.

    ``probability`` of X_{f,w} from these echoes alone (even odds before); ``evidence`` 0 surely
    absent, 1 rather absent, 2 rather present, 3 surely present; ``statistic`` the log odds that
    both are read from.
    """

    probability: float
    evidence: int
    statistic: float


@dataclass(frozen=True)
class SquareOn:
    """What is seen square on a side: probabilities of a wall, and of a doorway in such a wall."""

    wall: float
    doorway: float

    def feature(self, feature: int) -> float:
        """Probability of a feature. Corners are none that this view could show."""
        return {
            OPENING: 1 - self.wall,
            FLAT_WALL: self.wall,
            DOOR_JAMB: self.wall * self.doorway,
        }.get(feature, self.wall * (1 - self.wall))


@dataclass(frozen=True)
class AtCorner:
    """Probabilities that something answers at a corner, and walls to the left and right of it."""

    ahead: float
    left: float
    right: float

    def feature(self, feature: int) -> float:
        """Probability of a feature. Openings and door jambs are none that this view could show."""
        neither = (1 - self.left) * (1 - self.right)
        return {
            FLAT_WALL: self.left * (1 - self.right) + self.right * (1 - self.left),
            CONVEX_CORNER: self.ahead * neither,
            CONCAVE_CORNER: self.left * self.right,
        }.get(feature, (1 - self.ahead) * neither)


Seen: TypeAlias = SquareOn | AtCorner


def interpret(
    feature: int,
    wedge: int,
    ranges_m: NDArray[np.float64],
    heading_offsets_rad: NDArray[np.float64],
    nominal_width_m: float,
    wedges: Wedges = USUAL,
) -> Finding:
    """The finding of detector d_{f,w} from its echoes, as for :func:`see`. Raises DetectorError."""
    view = view_of(feature, wedge, wedges)
    return finding(feature, see(view, ranges_m, heading_offsets_rad, nominal_width_m))


def see(
    view: View,
    ranges_m: NDArray[np.float64],
    heading_offsets_rad: NDArray[np.float64],
    nominal_width_m: float,
) -> Seen:
    """Which surfaces echoes from a view show.

    ``ranges_m`` is (pings, transducers), nan for no echo, transducer i looking i * 2 pi /
    transducers counter-clockwise; ``heading_offsets_rad`` (pings,) is how far the robot was
    turned from the view's direction at each ping. Raises DetectorError.
    """
    check_width(nominal_width_m)
    bearings_rad = _bearings_rad(ranges_m, heading_offsets_rad)
    half_m = nominal_width_m / 2
    if view.at_corner:
        return _at_corner(ranges_m, bearings_rad, half_m)
    wall = fit_wall(ranges_m, bearings_rad, 0.0, half_m, view.approach * half_m)
    return SquareOn(wall.probability, wall.doorway)


def finding(feature: int, seen: Seen) -> Finding:
    """What the surfaces that were seen say about a feature."""
    probability = seen.feature(feature)
    return Finding(
        probability=probability,
        evidence=sum(probability > bound for bound in CLASS_BOUNDS),
        statistic=math.log(probability / (1 - probability)),
    )


def _bearings_rad(
    ranges_m: NDArray[np.float64], heading_offsets_rad: NDArray[np.float64]
) -> NDArray[np.float64]:
    if ranges_m.ndim != 2 or 0 in ranges_m.shape or heading_offsets_rad.shape != ranges_m.shape[:1]:
        raise DetectorError(
            f"expected echoes (pings, transducers) and as many headings as pings, found "
            f"{ranges_m.shape} and {heading_offsets_rad.shape}"
        )
    transducers = ranges_m.shape[1]
    axes = np.arange(transducers) * (2 * math.pi / transducers)
    bearings: NDArray[np.float64] = heading_offsets_rad[:, None] + axes[None, :]
    return bearings


def _at_corner(
    ranges_m: NDArray[np.float64], bearings_rad: NDArray[np.float64], half_m: float
) -> Seen:
    left, right = (
        fit_wall(ranges_m, bearings_rad, side_rad, half_m)
        for side_rad in (BESIDE_CORNER_RAD, -BESIDE_CORNER_RAD)
    )
    nearest_m, farthest_m = (math.sqrt(2) * half_m * share for share in CORNER_RANGES)
    beyond_m = (BEYOND_WALL * wall.range_m for wall in (left, right) if wall.probability > 0.5)
    corner = Sector(0.0, AHEAD_OF_CORNER_RAD, max([nearest_m, *beyond_m]), farthest_m)
    ahead = hear(ranges_m, bearings_rad, corner)
    return AtCorner(ahead.probability, left.probability, right.probability)
