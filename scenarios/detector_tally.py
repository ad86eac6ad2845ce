"""What the trials of a calibration add up to: evidence classes, and probabilities against truth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bus.features import Wedges
from modules.classifier.sensor_model import shape_of

BINS = 10
"""Bins of equal width for the probability that a detector states."""

TRIALS, STATED, HELD, SQUARED = range(4)
"""Sums of a bin: trials, stated probabilities, features that were there, squared errors."""


@dataclass(frozen=True, eq=False)
class Tally:
    """Sums over trials.

    ``counts`` is (feature, wedge, X, class); ``binned`` (feature, wedge, bin, sums) says of
    the probabilities that each detector stated how many there were, their sum, how often X held,
    and the sum of (probability - X)^2.
    """

    counts: NDArray[np.int64]
    binned: NDArray[np.float64]

    def plus(self, other: Tally) -> Tally:
        """Both together."""
        return Tally(self.counts + other.counts, self.binned + other.binned)

    def note(self, feature: int, wedge: int, x: int, evidence: int, probability: float) -> None:
        """Count one finding in place."""
        self.counts[feature, wedge, x, evidence] += 1
        sums = self.binned[feature, wedge, min(int(probability * BINS), BINS - 1)]
        sums += (1.0, probability, float(x), (probability - x) ** 2)

    @property
    def wedges(self) -> Wedges:
        """As many as it counts."""
        return Wedges(self.counts.shape[1])

    @property
    def brier(self) -> NDArray[np.float64]:
        """Mean of (probability - X)^2 by detector, (features, wedges); 0 is best, or no trials."""
        sums = self.binned.sum(axis=2)
        score: NDArray[np.float64] = sums[..., SQUARED] / np.maximum(sums[..., TRIALS], 1.0)
        return score

    def as_lists(self) -> dict[str, Any]:
        """For a line of JSON; read again by :func:`tally_of`, bit for bit."""
        return {"counts": self.counts.tolist(), "binned": self.binned.tolist()}


def empty_tally(wedges: Wedges) -> Tally:
    """No trials yet."""
    shape = shape_of(wedges)
    return Tally(np.zeros(shape, np.int64), np.zeros((*shape[:2], BINS, 4)))


def tally_of(lists: dict[str, Any], wedges: Wedges) -> Tally:
    """A tally as it was written. Raises KeyError, TypeError or ValueError for anything else."""
    counts = np.array(lists["counts"], dtype=np.int64)
    binned = np.array(lists["binned"], dtype=np.float64)
    empty = empty_tally(wedges)
    if counts.shape != empty.counts.shape or binned.shape != empty.binned.shape:
        raise ValueError(f"shapes {counts.shape} and {binned.shape}")
    return Tally(counts, binned)
