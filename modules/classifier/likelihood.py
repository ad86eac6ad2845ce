"""What the readings of one visit say about the junction: lambda(J) = P(readings|J).

The network is J -> X_{f,w} -> S. X follows from J by the geometry, and readings are
independent given J, so the tables for one reading, P(S=class|J), are made once per model and
multiplied. The classifier never sees the prior's history: the owner of J multiplies
(the two pass distributions back and forth; paper, section 5).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.features import DETECTORS, WEDGES
from modules.classifier.geometry import enterable, heading_number
from modules.classifier.sensor_model import EVIDENCE_CLASSES, SensorModel


class ReadingError(ValueError):
    """A reading no detector could have given, or two of one detector in a visit."""


@dataclass(frozen=True)
class Reading:
    """The evidence class that one detector found; ``detector`` is feature * wedges + wedge.

    Raises ReadingError for a detector or class that does not exist.
    """

    detector: int
    evidence: int

    def __post_init__(self) -> None:
        if not 0 <= self.detector < DETECTORS:
            raise ReadingError(f"detectors are 0..{DETECTORS - 1}, got {self.detector}")
        if not 0 <= self.evidence < EVIDENCE_CLASSES:
            raise ReadingError(f"evidence is 0..{EVIDENCE_CLASSES - 1}, got {self.evidence}")

    @property
    def feature(self) -> int:
        """The number of the feature looked for."""
        return self.detector // WEDGES

    @property
    def wedge(self) -> int:
        """The number of the wedge looked at."""
        return self.detector % WEDGES


def junction_likelihood(
    readings: Sequence[Reading], heading: int, model: SensorModel
) -> NDArray[np.float64]:
    """lambda(J) = P(readings, came by the corridor behind|J) for each of the 16 types.

    Not scaled: times the prior of J, its sum is the probability of the readings. Zero for the
    types without the corridor behind, even before the first reading.
    Raises HeadingError, and ReadingError where a detector has two readings.
    """
    once_each(readings)
    table = model.class_given_type[heading_number(heading)]
    product = enterable(heading).astype(np.float64)
    for reading in readings:
        product = product * table[reading.detector, :, reading.evidence]
    return product


def once_each(readings: Sequence[Reading]) -> None:
    """Raise ReadingError where a detector has two readings in one visit."""
    detectors = [reading.detector for reading in readings]
    twice = sorted(d for d in range(DETECTORS) if detectors.count(d) > 1)
    if twice:
        raise ReadingError(f"each detector reads once a visit; {twice} read more often")
