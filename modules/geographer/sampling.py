"""A weighted set of maps that stands for the belief, with every possible junction type ahead."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import Maps
from modules.geographer.connected_maps import ConnectedMaps, MapBelief
from modules.geographer.record import Record, nothing

POSSIBLE = 1e-9
"""Junction types less probable than this get no maps of their own."""


@dataclass(frozen=True, eq=False)
class WeightedMaps:
    """Maps with weights that sum to one, and each map's exact log posterior probability.

    The maps of one junction type stand together; any first few of them are an exact sample
    given that type.
    """

    maps: Maps
    weights: NDArray[np.float64]
    log_probability: NDArray[np.float64]
    updates: int
    """How many posteriors it took."""


def weighted_maps(
    all_maps: ConnectedMaps,
    record: Record,
    belief: MapBelief,
    place: int,
    per_type: int,
    corridor_odds: float,
    rng: np.random.Generator,
) -> WeightedMaps:
    """Sample ``per_type`` maps for each type that the junction at ``place`` may have.

    Stratified by that type, because the decision to be made is contingent on it: sampled
    together, an improbable type would have no map at all. The weights make up for it.
    """
    x, y = record.grid.place(place)
    types = belief.junctions[y, x]
    possible = np.flatnonzero(types > POSSIBLE)
    drawn: list[Maps] = []
    for junction_type in possible:
        if len(possible) == 1:
            drawn.append(belief.sample(per_type, rng))
            break
        only = record.junctions.copy()
        only[y, x, np.arange(types.size) != junction_type] = 0.0
        given = all_maps.posterior(only, corridor_odds, record.corridors)
        drawn.append(given.sample(per_type, rng))
    maps = np.concatenate(drawn)
    weights = np.repeat(types[possible] / types[possible].sum() / per_type, per_type)
    updates = len(possible) if len(possible) > 1 else 0
    return WeightedMaps(maps, weights, belief.log_probability(maps), updates)


def rehearse(all_maps: ConnectedMaps) -> None:
    """Use everything once, so that it is compiled before anybody waits for it."""
    record = nothing(all_maps.grid)
    belief = all_maps.posterior(record.junctions, 1.0, record.corridors)
    weighted_maps(all_maps, record, belief, 0, 1, 1.0, np.random.default_rng(0))
