"""Is there a wall, where, and a doorway in it? A line fitted to the echoes by least squares.

A smooth wall answers every cone that holds a direction near its normal, from the nearest point of
the wall that the cone holds: at d / cos(max(0, |b - a| - half a cone)) for a cone at bearing b, a
wall at distance d and its normal at bearing a. A doorway leaves enough of the wall that some cones
hear it still, but others hear the jambs, or a door that stands back, or nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

HALF_CONE_RAD = math.radians(15.0)

ANSWERS_RAD = math.radians(28.0)
"""Cones within this of where a wall's normal should be hear it, be the robot askew or not."""

FITTED_RAD = math.radians(33.0)
"""Echoes of cones within this are fitted."""

RANGES = (0.55, 1.40)
"""Nearest and farthest echo of a wall, in half corridor widths: widths 1.7 to 2.2 m for a nominal
2 m, 0.1 m to either side, errors on the way to the vantage, and a door that stands back."""

ASKEW_RAD = math.radians(8.0)
"""A wall's normal is within this of where it should be."""

FEWEST = 4
"""Ranges that a line is fitted to; two would always fit."""

SOFT_M = 0.03
"""What lies further from the line than this pulls at it less and less (soft L1 loss)."""

EVEN_SHARE, SURE_SHARE = 0.25, 0.2
"""A wall is as likely as not if this share of its cones answers, and certain if so much more do:
a third of them at least where there is a doorway, none where the side is open."""

EVEN_AHEAD, SURE_AHEAD = 0.6, 0.3
"""A wall answers the cone that faces it at nearly every heading; through an open doorway that cone
hears what is behind at many, even if all others hear the jambs."""

MOST_NATS = 6.6

PLAIN_M = 0.0197
DOORWAY_NATS = (26.0, 18.0)
"""A doorway in a wall is as likely as not if the fit leaves so much (root mean square) and every
cone answers. Nats more for a residual e times as large, and if none answered. Fitted to trials:
noise leaves 13 mm of a plain wall, a doorway 30 to 100."""

LEAST_M = 1e-3
"""No fit is better than this: noise is ten times as large."""

MOST_DOORWAY_NATS = 4.0
"""No finding is surer than this: somebody may have stood there."""


@dataclass(frozen=True)
class Wall:
    """The wall that fits best: its distance, the shares of its cones that answered, what is left.

    ``shares`` are those of each heading, ``ahead`` is the share of headings at which the cone that
    faces it answered; ``range_m`` and ``residual_m`` are nan where too few answered to tell.
    """

    range_m: float
    shares: tuple[float, ...]
    residual_m: float
    ahead: float

    @property
    def share(self) -> float:
        """The share of the heading at which the fewest cones answered."""
        return min(self.shares)

    @property
    def probability(self) -> float:
        """P(wall|echoes), even odds before.

        Somebody may have stood before an opening or a wall during a part of the sweep. So the
        heading at which the fewest cones answered counts, and that in the middle: where they
        disagree, nothing is sure.
        """
        shares = (self.share, float(np.median(self.shares)))
        nats = [MOST_NATS * (share - EVEN_SHARE) / SURE_SHARE for share in shares]
        by_share = sum(min(MOST_NATS, max(-MOST_NATS, n)) for n in nats) / 2
        by_ahead = MOST_NATS * (self.ahead - EVEN_AHEAD) / SURE_AHEAD
        return _chance(max(-MOST_NATS, min(by_share, by_ahead)))

    @property
    def doorway(self) -> float:
        """P(doorway|echoes, wall), even odds before."""
        if math.isnan(self.residual_m):
            return 0.5
        by_residual, by_silence = DOORWAY_NATS
        nats = by_residual * math.log(max(self.residual_m, LEAST_M) / PLAIN_M)
        nats += by_silence * (1 - self.share)
        return _chance(min(MOST_DOORWAY_NATS, max(-MOST_DOORWAY_NATS, nats)))


class Look(NamedTuple):
    """What the cones heard at one heading: ranges, nan where most pings heard none, and bearings.

    Bearings are from where the wall's normal should be.
    """

    found_m: NDArray[np.float64]
    off_rad: NDArray[np.float64]

    @property
    def share(self) -> float:
        """Of the cones that would hear a wall, the share that heard one."""
        inside = np.abs(self.off_rad) <= ANSWERS_RAD
        return float((np.isfinite(self.found_m) & inside).sum() / max(1, inside.sum()))

    @property
    def ahead(self) -> bool:
        """Whether the cone that faces the wall heard one."""
        return bool(np.isfinite(self.found_m[np.abs(self.off_rad).argmin()]))

    def residual_m(self, range_m: float, normal_rad: float) -> float:
        """Root mean square distance, along the cones, from a wall."""
        left = _left_over(np.array([range_m, normal_rad]), self.off_rad, self.found_m)
        return math.sqrt(float(np.nanmean(left**2)))


def fit_wall(
    ranges_m: NDArray[np.float64],
    bearings_rad: NDArray[np.float64],
    normal_rad: float,
    half_m: float,
    nearer_m: float = 0.0,
) -> Wall:
    """The wall whose normal should be at a bearing, half a corridor's width away.

    ``ranges_m`` (nan for no echo) and ``bearings_rad`` are (pings, transducers), from ``nearer_m``
    nearer than the corridor's axis. The residual is the median over the headings, since somebody
    may have stood about at some of them.
    """
    off_rad = np.remainder(bearings_rad - normal_rad + math.pi, 2 * math.pi) - math.pi
    nearest_m, farthest_m = (share * half_m - nearer_m for share in RANGES)
    looks = list(_looks(ranges_m, off_rad, nearest_m, farthest_m))
    shares = tuple(look.share for look in looks)
    ahead = sum(look.ahead for look in looks) / len(looks)
    found_m, at_rad = (np.concatenate([look[k] for look in looks]) for k in (0, 1))
    heard = np.isfinite(found_m)
    if heard.sum() < FEWEST:
        return Wall(math.nan, shares, math.nan, ahead)
    fitted = least_squares(
        _left_over,
        [float(np.median(found_m[heard])), 0.0],
        bounds=([0.0, -ASKEW_RAD], [np.inf, ASKEW_RAD]),
        args=(at_rad[heard], found_m[heard]),
        loss="soft_l1",
        f_scale=SOFT_M,
    )
    range_m, askew_rad = fitted.x.tolist()
    left_m = [
        look.residual_m(range_m, askew_rad) for look in looks if np.isfinite(look.found_m).any()
    ]
    return Wall(range_m, shares, float(np.median(left_m)), ahead)


def _left_over(
    wall: NDArray[np.float64], off_rad: NDArray[np.float64], found_m: NDArray[np.float64]
) -> NDArray[np.float64]:
    """How much nearer each cone heard a wall than it should; ``wall`` is distance and normal."""
    beside_rad = np.maximum(np.abs(off_rad - wall[1]) - HALF_CONE_RAD, 0.0)
    left: NDArray[np.float64] = wall[0] / np.cos(beside_rad) - found_m
    return left


def _looks(
    ranges_m: NDArray[np.float64], off_rad: NDArray[np.float64], nearest_m: float, farthest_m: float
) -> list[Look]:
    """One for each heading of the sweep."""
    looks = []
    within_m = np.where((ranges_m >= nearest_m) & (ranges_m <= farthest_m), ranges_m, np.nan)
    for heading_rad in np.unique(off_rad[:, 0]).tolist():
        pings = off_rad[:, 0] == heading_rad
        at_rad = off_rad[pings][0]
        near = np.abs(at_rad) <= FITTED_RAD
        looks.append(Look(_medians(within_m[pings][:, near]), at_rad[near]))
    return looks


def _medians(ranges_m: NDArray[np.float64]) -> NDArray[np.float64]:
    """The median of each column's numbers, nan where most are nan."""
    # Numbers sort before nan, so the median of n of them is that of places (n-1)//2 and n//2.
    ordered = np.sort(ranges_m, axis=0)
    heard = np.isfinite(ranges_m).sum(axis=0)
    column = np.arange(ranges_m.shape[1])
    low, high = (ordered[np.maximum(place, 0) // 2, column] for place in (heard - 1, heard))
    return np.where(2 * heard > len(ranges_m), (low + high) / 2, np.nan)


def _chance(nats: float) -> float:
    return 1.0 / (1.0 + math.exp(-nats))
