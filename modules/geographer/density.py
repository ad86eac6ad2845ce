"""Priors on a map's density: its number of corridors over the possible number.

The paper prefers "maps of medium density over very sparse or very dense maps" (section 3). What is
made here goes to ConnectedMaps.posterior as `corridor_count_weights`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from modules.geographer.checks import checked
from modules.geographer.errors import EvidenceError

Floats = NDArray[np.float64]


def medium_density(corridors: int, mean: float = 0.6, spread: float = 0.1) -> Floats:
    """P(number of corridors), (corridors + 1,): a normal curve around a density, none for 0.

    `mean` and `spread` (standard deviation) are shares of the possible corridors. Raises
    EvidenceError unless 0 < mean <= 1 and spread > 0.
    """
    if not (0.0 < mean <= 1.0 and spread > 0.0 and np.isfinite(spread)):
        raise EvidenceError(
            f"density: found mean {mean} and spread {spread}, expected 0 < mean <= 1, spread > 0"
        )
    density = np.arange(corridors + 1) / corridors
    logs = -0.5 * ((density - mean) / spread) ** 2
    curve = np.exp(logs - logs[1:].max())
    curve[0] = 0.0
    result: Floats = curve / curve.sum()
    return result


def weights_for(probability: ArrayLike, maps_by_corridors: Sequence[int]) -> Floats:
    """Weights that give each number of corridors this probability, if all odds are 1.

    `probability` and `maps_by_corridors` (ConnectedMaps.count_by_corridors) are (corridors + 1,);
    maps of equally many corridors are equally probable. Raises EvidenceError for numbers that
    are no probabilities, or where no map has so many corridors.
    """
    given = checked("probability", probability, (len(maps_by_corridors),))
    impossible = [k for k, n in enumerate(maps_by_corridors) if n == 0 and given[k] > 0.0]
    if impossible or given.sum() == 0.0:
        raise EvidenceError(
            f"probability: found {given[impossible].tolist()} for {impossible} corridors and a "
            f"sum of {given.sum()}, expected 0 where no connected map is and a positive sum"
        )
    # Counts are beyond floats on wide grids: logs of whole numbers, then a scale that fits.
    logs = [
        np.log(p) - float(np.log(float(n >> shift)) + shift * np.log(2.0)) if p > 0.0 else -np.inf
        for p, n in zip(given, maps_by_corridors, strict=True)
        for shift in [max(0, n.bit_length() - 64)]
    ]
    weights: Floats = np.exp(np.array(logs) - max(logs))
    return weights
