"""Is there a surface in a sector? Echoes of one surface agree in range, chance ones do not."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

AGREE_M = 0.12
"""Width of a cluster of ranges: three standard deviations to each side of a wall at 1 m."""

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

    ``ranges_m`` (nan for no echo) and ``bearings_rad`` are (pings, transducers). The range is
    found by clustering: of all windows of AGREE_M the one that most pings have an echo in, the
    nearest of equals; its median is the range.
    """
    off = np.abs(np.remainder(bearings_rad - sector.centre_rad + math.pi, 2 * math.pi) - math.pi)
    heard = (
        (off <= sector.half_width_rad)
        & (ranges_m >= sector.nearest_m)
        & (ranges_m <= sector.farthest_m)
    )
    ping, _ = np.nonzero(heard)
    found = ranges_m[heard]
    if len(found) == 0:
        return Heard(0.0, math.nan)
    above = found[None, :] - found[:, None]
    in_window = (above >= 0.0) & (above <= AGREE_M)
    of_ping = ping[:, None] == np.arange(len(ranges_m))
    pings_in_window = (in_window.astype(np.float64) @ of_ping > 0).sum(axis=1)
    best = np.lexsort((found, -pings_in_window))[0]
    return Heard(
        share=float(pings_in_window[best]) / len(ranges_m),
        range_m=float(np.median(found[in_window[best]])),
    )
