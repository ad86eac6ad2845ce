"""Is there a surface in a sector? Echoes of one surface agree in range, chance ones do not."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.hierarchy import fcluster, linkage

GAP_M = 0.05
"""Ranges further apart are not of one surface: two standard deviations of an echo at 1.4 m, while
a surface leaves a dozen echoes or more that are closer."""

EXPECTED_HIT = 0.9
"""P(a ping hears a surface that is there), and of not hearing one that is not (assumption)."""

EFFECTIVE_PINGS = 3.0
"""Pings from one vantage err together, so that all of them count as so many (assumption)."""


@dataclass(frozen=True)
class Sector:
    """Directions (relative to the view) and ranges within which a surface would answer."""

    centre_rad: float
    half_width_rad: float
    nearest_m: float
    farthest_m: float


@dataclass(frozen=True)
class Heard:
    """What answered in a sector: the share of pings that heard it, and its range (nan: nothing)."""

    share: float
    range_m: float

    @property
    def probability(self) -> float:
        """P(surface|share of the pings that heard it), even odds before."""
        hit_nats = math.log(EXPECTED_HIT / (1 - EXPECTED_HIT))
        return 1.0 / (1.0 + math.exp(-EFFECTIVE_PINGS * hit_nats * (2.0 * self.share - 1.0)))


def hear(ranges_m: NDArray[np.float64], bearings_rad: NDArray[np.float64], sector: Sector) -> Heard:
    """The range in a sector that the most pings heard.

    ``ranges_m`` (nan for no echo) and ``bearings_rad`` are (pings, transducers). Ranges are
    clustered by single linkage; of the clusters the one that most pings have an echo in, the
    nearest of equals, is the surface, its median the range.
    """
    off = np.abs(np.remainder(bearings_rad - sector.centre_rad + math.pi, 2 * math.pi) - math.pi)
    heard = (
        (off <= sector.half_width_rad)
        & (ranges_m >= sector.nearest_m)
        & (ranges_m <= sector.farthest_m)
    )
    ping, _ = np.nonzero(heard)
    clusters = [
        Heard(len(np.unique(ping[of_it])) / len(ranges_m), float(np.median(ranges_m[heard][of_it])))
        for of_it in _clusters(ranges_m[heard])
    ]
    return max(clusters, key=lambda c: (c.share, -c.range_m), default=Heard(0.0, math.nan))


def _clusters(found_m: NDArray[np.float64]) -> list[NDArray[np.bool_]]:
    """Which ranges belong to each cluster."""
    if len(found_m) < 2:
        return [np.ones(1, np.bool_)] * len(found_m)
    labels = fcluster(linkage(found_m[:, None], "single"), GAP_M, "distance")
    return [labels == label for label in range(1, labels.max() + 1)]
