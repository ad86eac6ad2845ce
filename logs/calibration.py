"""Whether what was believed with a probability came true as often as that.

Every published distribution is compared with what really was. *Brier* is the mean over the
distributions of the sum over the values of (probability - 1 if true else 0) squared (Brier 1950,
hence 0 to 2 for two values); *log score* is the mean of -ln(probability of the truth), in nats,
over those that held the truth possible. Both are better the smaller they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import JUNCTION_TYPES
from bus.messages import JunctionPrior, MapBelief, Reading
from logs.truth import Truth

BINS = 10


@dataclass(frozen=True)
class ReliabilityBin:
    """The probabilities from ``low`` up to ``high``: how high on average, how often true."""

    low: float
    high: float
    number: int
    mean: float
    true: float


@dataclass(frozen=True)
class Calibration:
    """How one kind of distribution compares with the truth.

    ``distributions`` were compared; ``impossible`` of them gave the truth a probability of 0.
    ``bins`` count every value of every distribution; bins that nothing fell into are left out.
    """

    about: str
    distributions: int
    brier: float | None
    log_score: float | None
    impossible: int
    bins: tuple[ReliabilityBin, ...]


class Scores:
    """Gathers one kind of distribution."""

    def __init__(self, about: str) -> None:
        self._about = about
        self._distributions = 0
        self._brier = 0.0
        self._log = 0.0
        self._impossible = 0
        self._number = np.zeros(BINS, np.int64)
        self._sum = np.zeros(BINS)
        self._true = np.zeros(BINS, np.int64)

    def add(self, probability: NDArray[np.float64], truth: NDArray[np.int64]) -> None:
        """Distributions, one a row (n, values), and the column of each that came true (n,)."""
        rows = np.arange(len(probability))
        came = np.zeros(probability.shape)
        came[rows, truth] = 1.0
        of_truth = probability[rows, truth]
        possible = of_truth > 0.0
        self._distributions += len(probability)
        self._brier += float(((probability - came) ** 2).sum())
        self._log -= float(np.log(of_truth[possible]).sum())
        self._impossible += int((~possible).sum())
        bins = np.minimum((probability * BINS).astype(np.int64), BINS - 1)
        np.add.at(self._number, bins, 1)
        np.add.at(self._sum, bins, probability)
        np.add.at(self._true, bins, came.astype(np.int64))

    def add_events(self, probability: NDArray[np.float64], came: NDArray[np.bool_]) -> None:
        """Probabilities (n,) of things that are or are not, and which of them are (n,)."""
        self.add(np.column_stack([1.0 - probability, probability]), came.astype(np.int64))

    def calibration(self) -> Calibration:
        """What it comes to."""
        possible = self._distributions - self._impossible
        return Calibration(
            self._about,
            self._distributions,
            self._brier / self._distributions if self._distributions else None,
            self._log / possible if possible else None,
            self._impossible,
            tuple(self._bin(k) for k in range(BINS) if self._number[k]),
        )

    def _bin(self, k: int) -> ReliabilityBin:
        number = int(self._number[k])
        mean, true = float(self._sum[k]) / number, float(self._true[k]) / number
        return ReliabilityBin(k / BINS, (k + 1) / BINS, number, mean, true)


class Calibrations:
    """Gathers all distributions of one log; those about a visit wait until its place is known."""

    def __init__(self, truth: Truth) -> None:
        self._truth = truth
        self._features = Scores("reading/feature: a feature is there")
        self._priors = Scores("prior/junction: type of the junction ahead")
        self._junctions = Scores("belief/map: types of all junctions")
        self._corridors = Scores("belief/map: corridors exist")
        self._ahead: dict[int, list[JunctionPrior]] = {}

    def read(self, reading: Reading) -> None:
        """A reading: the robot stands at the junction it is about."""
        there = self._truth.feature(reading)
        if there is not None:
            self._features.add_events(np.array([reading.probability]), np.array([there]))

    def expected(self, prior: JunctionPrior) -> None:
        """A prior of the junction ahead."""
        self._ahead.setdefault(prior.visit, []).append(prior)
        if self._truth.place(prior.visit) is not None:
            self.arrived(prior.visit)

    def arrived(self, visit: int) -> None:
        """The place of a visit is known now."""
        junction_type = self._truth.junction_type(visit)
        for prior in self._ahead.pop(visit, []):
            if junction_type is not None:
                self._priors.add(prior.prior[None, :], np.array([junction_type]))

    def believed(self, belief: MapBelief) -> None:
        """A belief about the map; it must fit the building."""
        building = self._truth.building
        if building is None:
            return
        types = self._truth.types.astype(np.int64)
        self._junctions.add(belief.junctions.reshape(-1, JUNCTION_TYPES), types)
        self._corridors.add_events(belief.corridors, building.corridors.astype(bool))

    def all(self) -> tuple[Calibration, ...]:
        """What they come to."""
        scores = (self._features, self._priors, self._junctions, self._corridors)
        return tuple(score.calibration() for score in scores)
