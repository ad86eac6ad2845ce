"""What is known about an errand before a method is chosen for it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import Maps
from modules.decider.methods.ways import best_way, corridor_weights
from modules.decider.roads import OPEN, PLANNED, Roads

FEATURES = (
    "one",
    "distance",
    "surest length",
    "surest doubt",
    "known way",
    "known detour",
    "unknown corridors",
    "density",
    "entropy",
    "distance x doubt",
    "distance x entropy",
    "unknown x known way",
)
"""Names of the numbers that :func:`features` gives, in their order.

Lengths are in mean corridors of the grid, entropy in nats, doubt is minus the log of section 4's
best product.
"""


@dataclass(frozen=True)
class Outlook:
    """What is known when an errand begins."""

    levels: NDArray[np.uint8]
    """(corridors,), see roads.py."""
    maps: Maps
    """(n, corridors): hypotheses that fit it."""
    probability: NDArray[np.float64]
    """(n,): theirs; they sum to 1."""
    place: int
    goal: int


def features(roads: Roads, outlook: Outlook) -> NDArray[np.float64]:
    """The numbers that the cost of a method is estimated by, (len(FEATURES),).

    All are known at the time of the decision; none needs the truth.
    """
    levels, ends = outlook.levels, (outlook.place, outlook.goal)
    weights = corridor_weights(levels, outlook.maps, outlook.probability)
    mean_s = float(roads.seconds.mean())
    hope = best_way(roads, "shortest", levels, weights, *ends)
    surest = best_way(roads, "section 4", levels, weights, *ends)
    known = best_way(roads, "shortest", levels, (levels == PLANNED).astype(float), *ends)
    there = float(known.seconds < np.inf)
    detour = (known.seconds - hope.seconds) / mean_s if there else 0.0
    unknown = levels == OPEN
    p = weights[unknown]
    count = float(unknown.sum())
    density = float(p.mean()) if count else 0.0
    entropy = float(_entropy(p).sum())
    distance = hope.seconds / mean_s
    return np.array(
        [
            1.0,
            distance,
            surest.seconds / mean_s,
            surest.first,
            there,
            detour,
            count,
            density,
            entropy,
            distance * surest.first,
            distance * entropy,
            count * there,
        ]
    )


def _entropy(p: NDArray[np.float64]) -> NDArray[np.float64]:
    inside = np.clip(p, 1e-12, 1.0 - 1e-12)
    nats: NDArray[np.float64] = -inside * np.log(inside) - (1.0 - inside) * np.log1p(-inside)
    return nats
