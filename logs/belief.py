"""How the belief over maps compares with the building that really is."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from bus.messages import MapBelief, TrueBuilding

SURE = 0.99
"""A corridor whose marginal reaches this, or one less this, counts as known."""

NOT_SAMPLED = "not among the sampled maps"


@dataclass(frozen=True)
class FinalBelief:
    """The last belief of a run against the truth.

    ``true_map`` is the probability of the true map, 0 where it was ``sampled`` in none of the
    maps that the belief lists; ``note`` then says so. ``right``, ``wrong`` and ``open`` count
    the corridors known rightly, known wrongly, and not known (see :data:`SURE`).
    """

    at_s: float
    visit: int
    true_map: float
    sampled: bool
    note: str
    entropy: float
    right: int
    wrong: int
    open: int


def fits(belief: MapBelief, building: TrueBuilding) -> bool:
    """Whether a belief is about a grid with as many corridors as the building's."""
    corridors = len(building.corridors)
    return len(belief.corridors) == corridors and belief.maps.shape[1:] == (corridors,)


def true_map_probability(belief: MapBelief, building: TrueBuilding) -> float | None:
    """The probability of the true map, or None if it is not among the maps of the belief."""
    rows = np.flatnonzero((belief.maps == building.corridors).all(axis=1))
    return math.exp(belief.log_probability[rows[0]]) if len(rows) else None


def final_belief(belief: MapBelief, building: TrueBuilding, at_s: float) -> FinalBelief:
    """Compare a belief with the building; they must fit each other (:func:`fits`)."""
    probability = true_map_probability(belief, building)
    exists = building.corridors.astype(bool)
    present, absent = belief.corridors >= SURE, belief.corridors <= 1.0 - SURE
    right = int(((present & exists) | (absent & ~exists)).sum())
    known = int((present | absent).sum())
    return FinalBelief(
        at_s=at_s,
        visit=belief.visit,
        true_map=probability or 0.0,
        sampled=probability is not None,
        note=NOT_SAMPLED if probability is None else "",
        entropy=belief.entropy,
        right=right,
        wrong=known - right,
        open=len(exists) - known,
    )
