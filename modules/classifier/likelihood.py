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

from bus.features import Wedges
from modules.classifier.geometry import enterable, heading_number
from modules.classifier.sensor_model import EVIDENCE_CLASSES, SensorModel


class ReadingError(ValueError):
    """A reading no detector could have given, or two of one detector in a visit."""


@dataclass(frozen=True)
class Reading:
    """The evidence class that one detector found; ``detector`` is feature * wedges + wedge.

    Raises ReadingError for a class that does not exist.
    """

    detector: int
    evidence: int

    def __post_init__(self) -> None:
        if not 0 <= self.evidence < EVIDENCE_CLASSES:
            raise ReadingError(f"evidence is 0..{EVIDENCE_CLASSES - 1}, got {self.evidence}")


def junction_likelihood(
    readings: Sequence[Reading], heading: int, model: SensorModel
) -> NDArray[np.float64]:
    """lambda(J) = P(readings, came by the corridor behind|J) for each of the 16 types.

    Not scaled: times the prior of J, its sum is the probability of the readings. Zero for the
    types without the corridor behind, even before the first reading.
    Raises HeadingError, and ReadingError where a detector has two readings or does not exist.
    """
    check_readings(readings, model.wedges)
    table = model.class_given_type[heading_number(heading)]
    product = enterable(heading).astype(np.float64)
    for reading in readings:
        product = product * table[reading.detector, :, reading.evidence]
    return product


def check_readings(readings: Sequence[Reading], wedges: Wedges) -> None:
    """Raise ReadingError where a detector has two readings in one visit, or does not exist."""
    detectors = [reading.detector for reading in readings]
    for detector in detectors:
        check_detector(detector, wedges)
    twice = sorted({d for d in detectors if detectors.count(d) > 1})
    if twice:
        raise ReadingError(f"each detector reads once a visit; {twice} read more often")


def check_detector(detector: int, wedges: Wedges) -> None:
    """Raise ReadingError unless there is a detector with this code."""
    if not 0 <= detector < wedges.detectors:
        raise ReadingError(f"detectors are 0..{wedges.detectors - 1}, got {detector}")
