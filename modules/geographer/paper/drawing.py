"""Which maps become hypotheses: connected, and drawn at random (paper, section 3)."""

from __future__ import annotations

import numpy as np

from bus.grid import Maps
from modules.geographer.map_belief import MapBelief
from modules.geographer.paper.errors import HypothesesError
from modules.geographer.paper.hypotheses import HypothesisSet

DRAWS_PER_STATE = 32
"""Draws allowed for each state of H. Of N equally likely maps one is missed with probability
N exp(-32) by so many draws: 1e-10 for 10,000."""

REMAINDER = 1e-9
"""The probability that maps outside an exhaustive set may have together."""


def draw_hypotheses(belief: MapBelief, states: int, rng: np.random.Generator) -> HypothesisSet:
    """A set of up to `states` states, NOTA among them, as consistent as possible with the evidence.

    `belief` is the exact belief given all the evidence there is, or given none for the first set;
    with `corridor_count_weights` it prefers medium density. Different maps are drawn from it, so
    all are connected and none is contradicted. Where all possible maps fit into the set (their
    exact probabilities sum to 1) it takes them all and is exhaustive. It is smaller than asked
    for where the belief is so concentrated that no more maps turn up in 32 draws a state.

    Raises HypothesesError for fewer than two states.
    """
    if states < 2:
        raise HypothesesError(f"states: found {states}, expected at least 2, NOTA and a map")
    wanted, draws = states - 1, DRAWS_PER_STATE * states
    met: dict[bytes, None] = {}
    while draws > 0 and len(met) < wanted:
        batch = belief.sample(min(draws, 2 * wanted), rng)
        draws -= len(batch)
        met |= dict.fromkeys(corridors.tobytes() for corridors in batch)
    maps = _maps(belief, list(met))[:wanted]
    exhaustive = len(met) <= wanted and _whole(belief, maps)
    return HypothesisSet(belief.grid, maps, exhaustive)


def _whole(belief: MapBelief, maps: Maps) -> bool:
    return float(np.exp(belief.log_probability(maps)).sum()) >= 1.0 - REMAINDER


def _maps(belief: MapBelief, keys: list[bytes]) -> Maps:
    return np.frombuffer(b"".join(keys), dtype=np.uint8).reshape(-1, belief.grid.corridors)
