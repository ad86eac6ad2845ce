"""What the readings of one visit say about the junction: lambda(J) = P(readings|J).

The network is J -> X_{f,w} -> S. X follows from J by the geometry, and from which of the junction's
ways begin with a doorway: its layout. Readings are independent given the layout, so the tables for
one reading, P(S=class|layout), are made once per model and multiplied. A visit may also have gone
astray: the robot is not where it thinks, all its readings are of some other place, and none of them
says anything of J. So no single visit rules a type out, and a second one may.

The classifier never sees the prior's history: the owner of J multiplies (the two pass distributions
back and forth; paper, section 5).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.features import Wedges
from bus.grid import JUNCTION_TYPES, NORTH
from modules.classifier.geometry import enterable, heading_number, layouts, shares
from modules.classifier.sensor_model import EVIDENCE_CLASSES, SensorModel

STATES = len(layouts(NORTH)) + 1
"""How a visit may be: a layout of the junction, or gone astray."""


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


def visit_likelihood(
    readings: Sequence[Reading], heading: int, model: SensorModel
) -> NDArray[np.float64]:
    """P(readings, how the visit went|J): (layouts + 1,).

    For each layout its share of its type times P(readings|layout), the visit being as it should;
    last P(readings|astray), which is the same for every type. Raises as
    :func:`junction_likelihood`.
    """
    check_readings(readings, model.wedges)
    number = heading_number(heading)
    found = np.append((1.0 - model.astray) * shares(heading), model.astray)
    for reading in readings:
        found = found * model.class_given_state[number, reading.detector, :, reading.evidence]
    return found


def by_type(of_visit: NDArray[np.float64], heading: int) -> NDArray[np.float64]:
    """What is given for layouts, summed for each type: (..., layouts) to (..., 16)."""
    summed = np.zeros((*of_visit.shape[:-1], JUNCTION_TYPES))
    for k, layout in enumerate(layouts(heading)):
        summed[..., layout.type] += of_visit[..., k]
    return summed


def junction_likelihood(
    readings: Sequence[Reading], heading: int, model: SensorModel
) -> NDArray[np.float64]:
    """lambda(J) = P(readings, came by the corridor behind|J) for each of the 16 types.

    Not scaled: times the prior of J, its sum is the probability of the readings. Zero for the
    types without the corridor behind, even before the first reading.
    Raises HeadingError, and ReadingError where a detector has two readings or does not exist.
    """
    entered = enterable(heading).astype(np.float64)
    if not readings:
        return entered  # nothing read says nothing, not even by rounding
    of_visit = visit_likelihood(readings, heading, model)
    found: NDArray[np.float64] = by_type(of_visit[:-1], heading) + entered * of_visit[-1]
    return found


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
