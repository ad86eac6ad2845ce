"""Whether something near hides who comes: a transducer hears the nearest surface only.

In a real corridor door frames and what leans against the walls lie in the cones ahead. A person
behind them is heard for the first time when he is nearer than they are; the ring must then fire
more often, or he is there before he is noticed. A wall across the way hides nobody.
"""

from __future__ import annotations

import numpy as np

from modules.reactor.cone import Floats

SEES_M = 5.5
"""Sight that is enough when the ring fires every 2 s: who comes at 1.3 m/s is heard a second late
on the average, half a second later known to come, and must be known 2.2 s before he is here."""

ACROSS_M = 0.05
"""What the neighbours hear no further than this beyond what is heard straight ahead, but for three
standard deviations, is across the whole way."""


def hides(echoes: Floats) -> bool:
    """Whether what is heard straight ahead hides who comes.

    ``echoes`` (cones, 2): range and standard deviation, NaN for no echo, in the order of
    :class:`modules.reactor.cone.Cones`.
    """
    ahead_m, sigma_m = echoes[0]
    beside_m = np.nan_to_num(echoes[1:3, 0], nan=np.inf).max()
    return bool(ahead_m < SEES_M and beside_m > ahead_m + ACROSS_M + 3.0 * sigma_m)
