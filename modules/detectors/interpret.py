"""What the echoes of a detector's pings say about its feature.

"On the basis of the data gathered during the execution of a given feature detector, a
probability distribution is determined for the random variable corresponding to the proposition
that the feature is present at a specific location" (paper, section 2).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.features import CONVEX_CORNER, OPENING
from modules.detectors.actions import check_width
from modules.detectors.surfaces import Heard, Sector, hear
from modules.detectors.views import DetectorError, View, view_of

CLASS_BOUNDS = (0.1, 0.5, 0.9)
"""Probabilities that part the evidence classes 0 (surely absent) .. 3 (surely present)."""

WALL_RANGES = (0.55, 1.35)
"""Nearest and farthest echo of a wall, in half widths: widths 1.7 to 2.2 m for a nominal 2 m,
0.1 m to either side, and errors on the way to the vantage."""

CORNER_RANGES = (0.65, 1.30)
"""The same for a corner, in half diagonals."""

AHEAD_RAD = math.radians(5.0)
"""Half width of the sector ahead, square on a side: the transducer that faces the target, and no
other, for the ends of an open side are heard by cones further off."""

AHEAD_OF_CORNER_RAD = math.radians(20.0)
"""The same at a corner, with the next transducer to either side: in a narrow corridor, off its
axis and askew, a corner is up to 18 degrees from where it should be."""

BEYOND_WALL = 1.12
"""A corner where a wall ends is further than the wall by at least this. The wall itself answers
up to 22.5 degrees from its normal, that is up to 1/cos(22.5 deg) = 1.08 times as far away, where
a cone beside the view hears it; the nearest corner is 1.15 times as far away."""

BESIDE_WALL = (math.radians(30.0), math.radians(5.0))
"""Centre and half width of the sectors in which a wall seen square on still answers, and an
edge does not: a cone of 15 degrees at 30 hears the wall where sound still meets it steeply."""

BESIDE_CORNER = (math.radians(45.0), math.radians(5.0))
"""The same for walls that meet at a corner: one transducer, whose cone reaches neither the corner
between the walls nor, in a narrow corridor, the next one."""


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
class Surfaces:
    """Probabilities that a surface answers ahead, and beside it to the left and right."""

    ahead: float
    left: float
    right: float

    def feature(self, feature: int, at_corner: bool) -> float:
        """Probability of a feature, by which surfaces it shows in that kind of view."""
        neither = (1 - self.left) * (1 - self.right)
        if feature == OPENING:
            return (1 - self.ahead) * neither if at_corner else 1 - self.ahead
        if feature == CONVEX_CORNER:
            return self.ahead * neither
        if at_corner:
            runs_on = self.left * (1 - self.right) + self.right * (1 - self.left)
            return (1 - self.ahead) * runs_on
        return self.ahead * (1 - neither)


def interpret(
    feature: int,
    wedge: int,
    ranges_m: NDArray[np.float64],
    heading_offsets_rad: NDArray[np.float64],
    nominal_width_m: float,
) -> Finding:
    """The finding of detector d_{f,w} from its echoes.

    ``ranges_m`` is (pings, transducers), nan for no echo, transducer i looking i * 2 pi /
    transducers counter-clockwise; ``heading_offsets_rad`` (pings,) is how far the robot was
    turned from the view's direction at each ping. Raises DetectorError.
    """
    check_width(nominal_width_m)
    view = view_of(feature, wedge)
    surfaces = _surfaces(
        view, ranges_m, _bearings_rad(ranges_m, heading_offsets_rad), nominal_width_m
    )
    probability = surfaces.feature(feature, view.at_corner)
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


def _surfaces(
    view: View,
    ranges_m: NDArray[np.float64],
    bearings_rad: NDArray[np.float64],
    nominal_width_m: float,
) -> Surfaces:
    half_m = nominal_width_m / 2
    beside_rad, beside_half_rad = BESIDE_CORNER if view.at_corner else BESIDE_WALL
    ahead_half_rad = AHEAD_OF_CORNER_RAD if view.at_corner else AHEAD_RAD
    nearest_m, farthest_m = (half_m * share for share in WALL_RANGES)
    left, right = (
        hear(ranges_m, bearings_rad, Sector(centre_rad, beside_half_rad, nearest_m, farthest_m))
        for centre_rad in (beside_rad, -beside_rad)
    )
    if view.at_corner:
        nearest_m, farthest_m = (math.sqrt(2) * half_m * share for share in CORNER_RANGES)
        nearest_m = max(nearest_m, _beyond(left), _beyond(right))
    ahead = hear(ranges_m, bearings_rad, Sector(0.0, ahead_half_rad, nearest_m, farthest_m))
    return Surfaces(ahead.probability, left.probability, right.probability)


def _beyond(wall: Heard) -> float:
    """The range beyond which an echo is not that of a wall which most pings heard."""
    return BEYOND_WALL * wall.range_m if wall.share > 0.5 else 0.0
