"""Worlds where edges are free independently, the Canadian Traveller's own case."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from modules.decider.roads import Roads
from modules.decider.traveller.world_kernels import draw_worlds

TRIES = 200
"""Samples drawn at most for each one wanted."""


def independent_worlds(
    roads: Roads,
    probability: NDArray[np.float64],
    known: NDArray[np.uint8],
    place: int,
    goal: int,
    count: int,
    rng: np.random.Generator,
) -> NDArray[np.uint8]:
    """Up to ``count`` exact samples (n, edges) given what is ``known`` and that a way exists.

    ``probability`` (edges,) says how likely each edge is free. By rejection: where hardly any
    weather leaves a way there are fewer, at worst none.
    """
    worlds = np.empty((count, len(known)), dtype=np.uint8)
    found = draw_worlds(roads, probability, known, place, goal, rng, TRIES * count, worlds)
    return worlds[:found]
