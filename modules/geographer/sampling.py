"""A weighted set of maps that stands for the belief, with every possible junction type ahead."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import Maps
from modules.geographer.connected_maps import ConnectedMaps
from modules.geographer.map_belief import MapBelief
from modules.geographer.record import nothing

DRAWS_PER_MAP = 16
"""Maps drawn for each one kept of a type, so that all but the improbable types get their share."""


@dataclass(frozen=True, eq=False)
class WeightedMaps:
    """Maps with weights that sum to one, and each map's exact log posterior probability.

    The maps of one junction type stand together; any first few of them are an exact sample
    given that type. ``cells`` is the table entries touched: a corridor of every map drawn.
    """

    maps: Maps
    weights: NDArray[np.float64]
    log_probability: NDArray[np.float64]
    cells: int


def weighted_maps(
    belief: MapBelief, place: int, per_type: int, rng: np.random.Generator
) -> WeightedMaps:
    """Up to ``per_type`` maps for each type that the junction at ``place`` may have.

    Drawn together from the exact posterior, then sorted by that type, because the decision to
    be made is contingent on it; each type keeps its first few and its exact probability. A type
    so improbable that no draw has it has no maps: whoever meets it does without.
    """
    grid = belief.grid
    x, y = grid.place(place)
    drawn = belief.sample(DRAWS_PER_MAP * per_type, rng)
    types = grid.junction_types(drawn)[:, place]
    kept = [np.flatnonzero(types == t)[:per_type] for t in np.unique(types)]
    maps = drawn[np.concatenate(kept)]
    shares = [belief.junctions[y, x, types[of[0]]] / len(of) for of in kept]
    weights = np.repeat(shares, [len(of) for of in kept])
    return WeightedMaps(maps, weights / weights.sum(), belief.log_probability(maps), drawn.size)


def rehearse(all_maps: ConnectedMaps) -> None:
    """Use everything once, so that it is compiled before anybody waits for it."""
    record = nothing(all_maps.grid)
    belief = all_maps.posterior(record.junctions, 1.0, record.corridors)
    weighted_maps(belief, 0, 1, np.random.default_rng(0))
