"""What is known about the map, checked and scaled: prior odds and likelihoods."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bus.grid import JUNCTION_TYPES, Grid
from modules.geographer.errors import EvidenceError
from modules.geographer.sweep import Sweep

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Evidence:
    """One factor a junction type and one a corridor, each scaled to a maximum of 1.

    `junctions` (intersections, 16); `corridors` (corridors, 2), absent and present, the prior
    odds among them; `log_scale` the log of all that was divided out.
    """

    junctions: Floats
    corridors: Floats
    log_scale: float

    def weights(self, sweep: Sweep) -> Floats:
        """The product of a step's factors: (steps, 4, 4) by enter and leave code."""
        junction, north, east = _by_step(self.junctions, self.corridors, sweep, (1.0, 0.0))
        return np.ascontiguousarray(junction * north * east)

    def log_weights(self, sweep: Sweep) -> Floats:
        """Logs of :meth:`weights`, right also where those underflow."""
        with np.errstate(divide="ignore"):
            logs = np.log(self.junctions), np.log(self.corridors)
        junction, north, east = _by_step(*logs, sweep, (0.0, -np.inf))
        return np.ascontiguousarray(junction + north + east)


def _by_step(
    junctions: Floats, corridors: Floats, sweep: Sweep, off_grid: tuple[float, float]
) -> tuple[Floats, Floats, Floats]:
    """Factors of the type, the north and the east corridor: broadcast to (steps, 4, 4)."""
    options = np.concatenate([corridors, [off_grid]])
    north = options[sweep.north][:, None, [0, 1, 0, 1]]
    east = options[sweep.east][:, None, [0, 0, 1, 1]]
    return sweep.to_steps(junctions), north, east


def prior(grid: Grid, corridor_odds: ArrayLike) -> Evidence:
    """The prior alone: `corridor_odds` a number or (corridors,). Raises EvidenceError."""
    odds = _checked("corridor_odds", corridor_odds, (grid.corridors,), may_be_scalar=True)
    high = np.maximum(odds, 1.0)
    corridors = np.stack([1.0 / high, odds / high], axis=1)
    junctions = np.ones((grid.intersections, JUNCTION_TYPES))
    return Evidence(junctions, corridors, float(np.log(high).sum()))


def observed(
    grid: Grid,
    before: Evidence,
    junction_likelihood: ArrayLike,
    corridor_likelihood: ArrayLike | None,
) -> Evidence:
    """The prior `before` and the likelihoods together. Raises EvidenceError."""
    by_type = (grid.rows, grid.columns, JUNCTION_TYPES)
    given = _checked("junction_likelihood", junction_likelihood, by_type)
    junctions, log_scale = _scaled(given.reshape(-1, JUNCTION_TYPES))
    corridors = before.corridors
    log_scale += before.log_scale
    if corridor_likelihood is not None:
        options = (grid.corridors, 2)
        likelihood, scale = _scaled(_checked("corridor_likelihood", corridor_likelihood, options))
        corridors = corridors * likelihood
        log_scale += scale
    return Evidence(junctions, corridors, log_scale)


def where_informative(grid: Grid, evidence: Evidence) -> list[tuple[int, int]]:
    """The junctions (x, y) where the likelihood is not the same for all types that fit."""
    found = []
    for number, likelihood in enumerate(evidence.junctions):
        x, y = grid.place(number)
        fitting = likelihood[grid.possible_types(x, y)]
        if fitting.min() < fitting.max() or fitting.max() == 0.0:
            found.append((x, y))
    return found


def _scaled(factors: Floats) -> tuple[Floats, float]:
    """Rows divided by their largest entries, and the sum of the logs of those."""
    top = factors.max(axis=1, keepdims=True)
    top = np.where(top > 0.0, top, 1.0)
    return factors / top, float(np.log(top).sum())


def _checked(
    name: str, values: ArrayLike, shape: tuple[int, ...], may_be_scalar: bool = False
) -> Floats:
    """The values as floats of this shape, finite and not negative. Raises EvidenceError."""
    array = np.asarray(values, dtype=np.float64)
    if may_be_scalar and array.ndim == 0:
        array = np.full(shape, array)
    if array.shape != shape:
        raise EvidenceError(f"{name}: found shape {array.shape}, expected {shape}")
    bad = ~(np.isfinite(array) & (array >= 0.0))
    if bad.any():
        place = tuple(int(i) for i in np.argwhere(bad)[0])
        raise EvidenceError(
            f"{name}{list(place)}: found {array[place]}, expected a finite number not below 0"
        )
    return array
