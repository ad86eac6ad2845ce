"""What is known about the map, checked and scaled: prior odds and likelihoods."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bus.grid import JUNCTION_TYPES, Grid
from modules.geographer.checks import checked
from modules.geographer.pairs import Link, PairLikelihood, linked
from modules.geographer.sweep import Sweep

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Evidence:
    """One factor a junction type and one a corridor, each scaled to a maximum of 1, and more.

    `junctions` (intersections, 16); `corridors` (corridors, 2), absent and present, the prior
    odds among them; `counts` (corridors + 1,) the prior weight by number of corridors, or none;
    `links` the evidence about pairs; `log_scale` the log of all that was divided out.
    """

    junctions: Floats
    corridors: Floats
    log_scale: float
    counts: Floats | None = None
    links: tuple[Link, ...] = ()

    @property
    def entangled(self) -> list[Link]:
        """The links that do not factor into likelihoods of their junctions."""
        return [link for link in self.links if link.entangled]

    @property
    def local(self) -> bool:
        """Whether junction and corridor factors are all there is."""
        return self.counts is None and not self.entangled

    def weights(self, sweep: Sweep) -> Floats:
        """The product of a step's local factors: (steps, 4, 4) by enter and leave code."""
        junction, north, east = _by_step(self.junctions, self.corridors, sweep, (1.0, 0.0))
        weights = np.ascontiguousarray(junction * north * east)
        for step, factors in self._link_factors():
            weights[step] *= factors
        return weights

    def log_weights(self, sweep: Sweep) -> Floats:
        """Logs of :meth:`weights`, right also where those underflow."""
        with np.errstate(divide="ignore"):
            logs = np.log(self.junctions), np.log(self.corridors)
            junction, north, east = _by_step(*logs, sweep, (0.0, -np.inf))
            weights = np.ascontiguousarray(junction + north + east)
            for step, factors in self._link_factors():
                weights[step] += np.log(factors)
        return weights

    def _link_factors(self) -> Iterator[tuple[int, Floats]]:
        """Steps and factors (4, 4) of all links that are not remembered by class."""
        for link in self.links:
            yield link.start, link.scales.reshape(4, 4)
            if not link.entangled:
                yield link.end, link.rows[0].reshape(4, 4)

    def log_beyond(self, sweep: Sweep, leaves: NDArray[np.uint8]) -> Floats:
        """Log weight (maps,) that maps, as leave codes, have from what is not local."""
        result = np.zeros(len(leaves))
        with np.errstate(divide="ignore"):
            if self.counts is not None:
                result += np.log(self.counts)[sweep.to_maps(leaves).sum(axis=1, dtype=np.int64)]
            for link in self.entangled:
                types = sweep.to_types(leaves)
                of_first = link.classes[types[:, link.start]]
                result += np.log(link.rows[of_first, types[:, link.end]])
        return result

    def with_junction(self, intersection: int, likelihood: Floats) -> Evidence:
        """One more likelihood (16,) of a junction's type."""
        factors, log_scale = _scaled((self.junctions[intersection] * likelihood)[None])
        junctions = self.junctions.copy()
        junctions[intersection] = factors
        return replace(self, junctions=junctions, log_scale=self.log_scale + log_scale)


def _by_step(
    junctions: Floats, corridors: Floats, sweep: Sweep, off_grid: tuple[float, float]
) -> tuple[Floats, Floats, Floats]:
    """Factors of the type, the north and the east corridor: broadcast to (steps, 4, 4)."""
    options = np.concatenate([corridors, [off_grid]])
    north = options[sweep.north][:, None, [0, 1, 0, 1]]
    east = options[sweep.east][:, None, [0, 0, 1, 1]]
    return sweep.to_steps(junctions), north, east


def prior(
    grid: Grid, corridor_odds: ArrayLike, corridor_count_weights: ArrayLike | None = None
) -> Evidence:
    """The prior alone: `corridor_odds` a number or (corridors,), weights (corridors + 1,).

    Raises EvidenceError.
    """
    odds = checked("corridor_odds", corridor_odds, (grid.corridors,), may_be_scalar=True)
    high = np.maximum(odds, 1.0)
    corridors = np.stack([1.0 / high, odds / high], axis=1)
    junctions = np.ones((grid.intersections, JUNCTION_TYPES))
    log_scale = float(np.log(high).sum())
    if corridor_count_weights is None:
        return Evidence(junctions, corridors, log_scale)
    given = checked("corridor_count_weights", corridor_count_weights, (grid.corridors + 1,))
    counts, scale = _scaled(given[None])
    return Evidence(junctions, corridors, log_scale + scale, counts[0])


def observed(
    grid: Grid,
    sweep: Sweep,
    before: Evidence,
    junction_likelihood: ArrayLike,
    corridor_likelihood: ArrayLike | None,
    pairs: Iterable[PairLikelihood],
) -> Evidence:
    """The prior `before` and the likelihoods together. Raises EvidenceError."""
    by_type = (grid.rows, grid.columns, JUNCTION_TYPES)
    given = checked("junction_likelihood", junction_likelihood, by_type)
    junctions, log_scale = _scaled(given.reshape(-1, JUNCTION_TYPES))
    corridors = before.corridors
    log_scale += before.log_scale
    if corridor_likelihood is not None:
        options = (grid.corridors, 2)
        likelihood, scale = _scaled(checked("corridor_likelihood", corridor_likelihood, options))
        corridors = corridors * likelihood
        log_scale += scale
    found = [linked(grid, sweep, f"pairs[{i}]", pair) for i, pair in enumerate(pairs)]
    log_scale += sum(scale for _, scale in found)
    links = tuple(link for link, _ in found)
    return Evidence(junctions, corridors, log_scale, before.counts, links)


def _scaled(factors: Floats) -> tuple[Floats, float]:
    """Rows divided by their largest entries, and the sum of the logs of those."""
    top = factors.max(axis=1, keepdims=True)
    top = np.where(top > 0.0, top, 1.0)
    return factors / top, float(np.log(top).sum())
