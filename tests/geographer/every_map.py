"""All connected maps of a small grid, one by one: what the frontier method must agree with."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import logsumexp

from bus.grid import JUNCTION_TYPES, Grid, Maps
from modules.geographer import PairLikelihood

Floats = NDArray[np.float64]


@lru_cache
def all_maps(columns: int, rows: int) -> Maps:
    grid = Grid(columns, rows)
    candidates = np.array(list(product((0, 1), repeat=grid.corridors)), dtype=np.uint8)
    return candidates[[grid.connected(c) for c in candidates]]


@dataclass(frozen=True)
class Enumerated:
    """The posterior as a list: the probability of each map."""

    grid: Grid
    maps: Maps
    log_evidence: float
    probability: Floats

    @property
    def junctions(self) -> Floats:
        types = self.grid.junction_types(self.maps)
        result = np.zeros((self.grid.intersections, JUNCTION_TYPES))
        for v in range(self.grid.intersections):
            result[v] = np.bincount(types[:, v], self.probability, JUNCTION_TYPES)
        return result.reshape(self.grid.rows, self.grid.columns, JUNCTION_TYPES)

    @property
    def corridors(self) -> Floats:
        return self.probability @ self.maps

    @property
    def corridor_counts(self) -> Floats:
        counts = self.maps.sum(axis=1, dtype=int)
        result = np.zeros(self.grid.corridors + 1)
        result[:] = np.bincount(counts, self.probability, len(result))
        return result

    @property
    def entropy(self) -> float:
        p = self.probability[self.probability > 0]
        return -float((p * np.log(p)).sum())


def enumerate_posterior(
    columns: int,
    rows: int,
    junction_likelihood: Floats,
    corridor_odds: ArrayLike = 1.0,
    corridor_likelihood: Floats | None = None,
    corridor_count_weights: Floats | None = None,
    pairs: Iterable[PairLikelihood] = (),
) -> Enumerated:
    grid = Grid(columns, rows)
    maps = all_maps(columns, rows)
    odds = np.broadcast_to(np.asarray(corridor_odds, float), (grid.corridors,))
    types = grid.junction_types(maps)
    with np.errstate(divide="ignore"):
        log_prior = np.where(maps == 1, np.log(odds), 0.0).sum(axis=1)
        if corridor_count_weights is not None:
            log_prior += np.log(corridor_count_weights)[maps.sum(axis=1, dtype=int)]
        by_type = np.log(junction_likelihood).reshape(-1, JUNCTION_TYPES)
        log_likelihood = by_type[np.arange(grid.intersections), types].sum(axis=1)
        if corridor_likelihood is not None:
            by_corridor = np.log(corridor_likelihood)
            log_likelihood += by_corridor[np.arange(grid.corridors), maps].sum(axis=1)
        for pair in pairs:
            first, second = (types[:, grid.intersection(*p)] for p in (pair.first, pair.second))
            log_likelihood += np.log(np.asarray(pair.likelihood))[first, second]
    log_joint = log_prior - logsumexp(log_prior) + log_likelihood
    log_evidence = float(logsumexp(log_joint))
    return Enumerated(grid, maps, log_evidence, np.exp(log_joint - log_evidence))
