"""Bel(H) and Bel(J) of the singly connected network, directly.

Given H all junctions are independent, so what is observed there multiplies:
Bel(h) ~ Pr(h) prod_v sum_j Pr(J_v=j|h) lambda_v(j). For a map the sum is one entry of lambda,
for NOTA the mean over the types that fit. It is what a junction tree computes, in one pass.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bus.grid import JUNCTION_TYPES, Grid
from modules.geographer.checks import checked
from modules.geographer.paper.errors import ContradictedHypothesesError
from modules.geographer.paper.hypotheses import HypothesisSet

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class HypothesisBelief:
    """Bel(H) and Bel(J) given the evidence.

    `states` (n + 1,), NOTA last; `junctions` (rows, columns, 16), indexed [y, x, type];
    `log_evidence` is the log probability of the evidence.
    """

    states: Floats
    junctions: Floats
    log_evidence: float

    @property
    def nota(self) -> float:
        """Bel(NOTA)."""
        return float(self.states[-1])

    @property
    def nota_exceeds(self) -> bool:
        """Whether NOTA is more probable than every map: the sign to draw a new set."""
        return bool(self.states[-1] > self.states[:-1].max())


def direct_belief(hypotheses: HypothesisSet, junction_likelihood: ArrayLike) -> HypothesisBelief:
    """The belief of the singly connected network given lambda(J) at every junction.

    `junction_likelihood` (rows, columns, 16) is P(readings | type), all ones where nothing was
    read. Touches :func:`direct_cells` table entries. Raises EvidenceError for a wrong shape or
    entry, ContradictedHypothesesError where every state has probability zero.
    """
    grid = hypotheses.grid
    scaled, log_scale = scaled_likelihood(grid, junction_likelihood)
    fitting = scaled * hypotheses.fitting
    places = np.arange(grid.intersections)
    means = fitting.sum(axis=1) / hypotheses.fitting.sum(axis=1)
    with np.errstate(divide="ignore"):
        of_maps = np.log(scaled)[places, hypotheses.types].sum(axis=1)
        logs = np.log(hypotheses.prior) + np.append(of_maps, np.log(means).sum())
    top = logs.max()
    if top == -np.inf:
        raise contradiction(grid, scaled)
    weights = np.exp(logs - top)
    states = weights / weights.sum()
    junctions = np.zeros((grid.intersections, JUNCTION_TYPES))
    for v in places:
        junctions[v] = np.bincount(hypotheses.types[:, v], states[:-1], JUNCTION_TYPES)
        if states[-1] > 0.0:
            junctions[v] += states[-1] * fitting[v] / fitting[v].sum()
    log_evidence = float(top + np.log(weights.sum()) + log_scale)
    return HypothesisBelief(
        states, junctions.reshape(grid.rows, grid.columns, JUNCTION_TYPES), log_evidence
    )


def direct_cells(hypotheses: HypothesisSet) -> int:
    """Table entries touched by :func:`direct_belief`: each map at each junction, and NOTA's rows.

    Once for Bel(H) and once for Bel(J).
    """
    return 2 * int(hypotheses.types.size + hypotheses.fitting.sum())


def scaled_likelihood(grid: Grid, junction_likelihood: ArrayLike) -> tuple[Floats, float]:
    """Rows (intersections, 16) with largest entries of 1, and the log of what was divided out.

    Types that lead off the grid get 0. Raises EvidenceError.
    """
    shape = (grid.rows, grid.columns, JUNCTION_TYPES)
    given = checked("junction_likelihood", junction_likelihood, shape)
    rows = given.reshape(-1, JUNCTION_TYPES).copy()
    for v in range(grid.intersections):
        rows[v, ~grid.possible_types(*grid.place(v))] = 0.0
    top = rows.max(axis=1, keepdims=True)
    top[top == 0.0] = 1.0
    return rows / top, float(np.log(top).sum())


def contradiction(grid: Grid, likelihood: Floats) -> ContradictedHypothesesError:
    """The error for evidence (intersections, 16) that every state of H contradicts."""
    ruled_out = []
    for number, row in enumerate(likelihood):
        x, y = grid.place(number)
        if (row[grid.possible_types(x, y)] == 0.0).any():
            ruled_out.append((x, y))
    return ContradictedHypothesesError(ruled_out)
