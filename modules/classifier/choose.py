"""Which feature to test next, decided while the current detector runs (paper, section 5).

A sensing action takes thirty seconds to a minute, and its outcome is not known yet, so the
choice is contingent: one next detector for every evidence class the running one may find.
Each is the detector with the most expected information about J per second.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import JUNCTION_TYPES
from modules.classifier.geometry import DETECTORS, heading_number
from modules.classifier.likelihood import Reading, ReadingError, junction_likelihood, once_each
from modules.classifier.sensor_model import EVIDENCE_CLASSES, SensorModel, entropy_nats

STOP = -1
"""In place of a next detector: conclude, no detector is worth its time."""

DECIMALS = 12
"""Information is rounded to so many decimals: what differs only by the order of additions
is a tie, broken by the lowest code, whatever the machine."""


SMALLEST = float(np.nextafter(0.0, 1.0))
"""Stopping is worth at least this, in nats per second: no information is never worth a test."""


class PriorError(ValueError):
    """A prior that is no distribution over the 16 types, or that the readings contradict."""


@dataclass(frozen=True)
class ChoiceSettings:
    """How much information a second of sensing must bring for sensing to go on."""

    worth_nats_per_s: float = 0.0002


@dataclass(frozen=True, eq=False)
class Choice:
    """What to do next, by the evidence class of the running detector (one row if none runs).

    ``next_detector`` is a code or STOP; ``concluded_type`` the most probable type given that
    outcome; ``information_nats`` the expected information of the next detector (0 for STOP);
    ``belief`` is P(J|prior, readings, outcome), (outcomes, 16); ``cells`` the table entries
    touched.
    """

    next_detector: NDArray[np.int64]
    concluded_type: NDArray[np.int64]
    information_nats: NDArray[np.float64]
    belief: NDArray[np.float64]
    cells: int


def choose(
    prior: NDArray[np.float64],
    readings: Sequence[Reading],
    running: int | None,
    heading: int,
    model: SensorModel,
    settings: ChoiceSettings = ChoiceSettings(),
) -> Choice:
    """The best next detector for every outcome of the running one.

    ``prior`` is pi(J), (16,), any positive scale. A detector is used at most once a visit.
    Raises PriorError, HeadingError, and ReadingError where a detector is used twice.
    """
    free = _free_detectors(readings, running)
    number = heading_number(heading)
    belief = _beliefs(prior, readings, running, heading, model)
    information = _information(
        belief,
        model.class_given_type[number, free],
        model.class_entropy_given_type[number, free],
    )
    codes = np.append(free, STOP)
    information = np.pad(information, ((0, 0), (0, 1)))
    rate_nats_per_s = information / np.append(model.duration_by_detector_s[free], np.inf)
    rate_nats_per_s[:, -1] = max(settings.worth_nats_per_s, SMALLEST)
    best = rate_nats_per_s.argmax(axis=1)
    return Choice(
        next_detector=codes[best],
        concluded_type=belief.argmax(axis=1),
        information_nats=information[np.arange(len(belief)), best],
        belief=belief,
        cells=cells_before(len(readings), running is not None),
    )


def cells_before(readings: int, running: bool) -> int:
    """The table entries a choice will touch, known before it starts.

    One for each type and reading to find the belief, and one for each outcome, free detector,
    type and class to find the information.
    """
    outcomes = EVIDENCE_CLASSES if running else 1
    free = DETECTORS - readings - int(running)
    believed = JUNCTION_TYPES * (readings + outcomes)
    return believed + outcomes * free * JUNCTION_TYPES * EVIDENCE_CLASSES


def _free_detectors(readings: Sequence[Reading], running: int | None) -> NDArray[np.int64]:
    once_each(readings)
    used = [reading.detector for reading in readings]
    if running is not None:
        if not 0 <= running < DETECTORS:
            raise ReadingError(f"detectors are 0..{DETECTORS - 1}, got {running} running")
        if running in used:
            raise ReadingError(f"detector {running} runs again in one visit")
        used.append(running)
    return np.array([d for d in range(DETECTORS) if d not in used], dtype=np.int64)


def _beliefs(
    prior: NDArray[np.float64],
    readings: Sequence[Reading],
    running: int | None,
    heading: int,
    model: SensorModel,
) -> NDArray[np.float64]:
    """P(J|prior, readings, outcome) for every outcome of the running detector: (outcomes, 16)."""
    if prior.shape != (JUNCTION_TYPES,) or not (prior >= 0).all() or not np.isfinite(prior).all():
        raise PriorError(f"a prior is {JUNCTION_TYPES} finite numbers >= 0, got {prior!r}")
    joint = (prior * junction_likelihood(readings, heading, model))[None, :]
    if running is not None:
        joint = joint * model.class_given_type[heading_number(heading), running].T
    evidence = joint.sum(axis=1, keepdims=True)
    if not (evidence > 0).all():
        raise PriorError(
            f"the prior {prior.tolist()} gives no weight to any type that can be entered "
            f"with heading {heading}"
        )
    belief: NDArray[np.float64] = joint / evidence
    return belief


def _information(
    belief: NDArray[np.float64],
    class_given_type: NDArray[np.float64],
    class_entropy: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Expected fall in the entropy of J by each detector, in nats: (outcomes, detectors).

    Mutual information read from the side of S, H(S) - sum_J P(J) H(S|J): it needs no posterior
    for each class.
    """
    mixed = (belief.T[:, :, None, None] * class_given_type.transpose(1, 0, 2)[:, None]).sum(axis=0)
    expected = (belief.T[:, :, None] * class_entropy.T[:, None]).sum(axis=0)
    information: NDArray[np.float64] = np.round(entropy_nats(mixed) - expected, DECIMALS)
    return np.maximum(information, 0.0)
