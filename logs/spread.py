"""Many numbers in a few: quantiles of times, counts in bins."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

NS_PER_S = 1e9


@dataclass(frozen=True)
class Spread:
    """How a time is spread, in seconds; all None where ``number`` is 0.

    A quantile is the least value that the given share does not exceed: one that occurred.
    """

    number: int
    min_s: float | None = None
    median_s: float | None = None
    p95_s: float | None = None
    max_s: float | None = None


def spread(times_ns: array[int] | Sequence[int]) -> Spread:
    """The spread of times in ns."""
    if not len(times_ns):
        return Spread(0)
    found = np.quantile(np.asarray(times_ns), (0.0, 0.5, 0.95, 1.0), method="inverted_cdf")
    return Spread(len(times_ns), *(float(value) / NS_PER_S for value in found))
