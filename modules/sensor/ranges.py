"""From raw echoes to a distribution of ranges: how far, how sure, and is it an echo at all.

A reading is a real echo, or cross-talk of another transducer: too short by any amount. What
was heard at the ping before says which: a real echo mostly comes from where one came before,
less the way driven since.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

CROSS_TALK = 0.01
"""Share of readings that are cross-talk (assumption, as for the simulated ring)."""

SURPRISE = 0.1
"""Share of real echoes from elsewhere than before: doors, corners, people (assumption)."""

FARTHEST_M = 10.7
NOISE_SHARE, NOISE_M = 0.01, 0.01
"""Standard deviation of a range: 1 % and 10 mm, the accuracy that the Polaroid 6500 states."""

MOTION_SIGMA_M = 0.05


@dataclass(frozen=True)
class RangeBelief:
    """Gaussians over the range, (transducers,), and the probability that the echo is real."""

    mean_m: NDArray[np.float64]
    sigma_m: NDArray[np.float64]
    echo: NDArray[np.float64]


def range_belief(
    ranges_m: NDArray[np.float64], before_m: NDArray[np.float64], driven_m: float
) -> RangeBelief:
    """The distribution given raw ``ranges_m`` (NaN: no echo) and those of the ping before.

    ``driven_m`` is the way driven straight ahead in between; ``before_m`` all NaN after a turn.
    """
    heard = ~np.isnan(ranges_m)
    sigma_m = np.where(heard, NOISE_SHARE * ranges_m + NOISE_M, 0.0)
    axes = np.arange(len(ranges_m)) * (2 * math.pi / len(ranges_m))
    expected_m = before_m - driven_m * np.cos(axes)
    spread_m = np.hypot(np.where(heard, sigma_m, 1.0), MOTION_SIGMA_M)
    off = (ranges_m - expected_m) / spread_m
    again = np.exp(-0.5 * off * off) / (spread_m * math.sqrt(2 * math.pi))
    again = np.where(np.isnan(again), 1.0 / FARTHEST_M, again)
    real = (1.0 - CROSS_TALK) * ((1.0 - SURPRISE) * again + SURPRISE / FARTHEST_M)
    false = CROSS_TALK / FARTHEST_M
    return RangeBelief(ranges_m.copy(), sigma_m, np.where(heard, real / (real + false), 0.0))
