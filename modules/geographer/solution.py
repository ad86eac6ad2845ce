"""Solve a map problem of local evidence, and keep what later questions need."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from modules.geographer import log_kernels, sweep_kernels, walk_kernels
from modules.geographer.evidence import Evidence
from modules.geographer.frontier import Frontier, Table
from modules.geographer.sweep import Sweep

Floats = NDArray[np.float64]
Leaves: TypeAlias = NDArray[np.uint8]

TOLERANCE = 1e-15
"""The most that underflow may change a posterior probability; else logarithms are used.

Evidence that strong and that contradictory is rare; logarithms cost some ten times more.
"""


@dataclass(frozen=True, eq=False)
class Problem:
    """What is to be solved: evidence about a grid's maps, and how to sweep the grid."""

    frontier: Frontier
    sweep: Sweep
    evidence: Evidence

    @property
    def tables(self) -> tuple[Table, Table, int]:
        """The tables that every kernel takes."""
        return self.frontier.enter, self.frontier.close, self.frontier.idle


@dataclass(frozen=True, eq=False)
class LocalSolution:
    """The posterior on the sweep's steps, if all evidence is local.

    `log_mass` is the log of the total scaled weight of all connected maps, -inf if there is
    none; `types` (steps, 4, 4) the posterior by enter and leave code. `weights` and `after` (the
    weight of what may follow each state, an array or a list by step) are logs if `logarithmic`;
    `lost` (steps,) bounds what `after` lost by underflow.
    """

    problem: Problem
    log_mass: float
    types: Floats
    weights: Floats
    after: Floats | list[Floats]
    lost: Sequence[float]
    logarithmic: bool

    def expected_log_weight(self) -> float:
        """The posterior mean of a map's log scaled weight."""
        logs = self.problem.evidence.log_weights(self.problem.sweep)
        possible = self.types > 0.0
        return float((self.types[possible] * logs[possible]).sum())

    def draw(self, uniforms: Floats) -> Leaves:
        """A map for each row of fractions (maps, steps): leave codes (maps, steps)."""
        leaves = np.zeros(uniforms.shape, np.uint8)
        after = np.asarray(self.after)
        walk_kernels.draw(
            self.weights, *self.problem.tables, after, self.logarithmic, uniforms, leaves
        )
        return leaves

    def best(self) -> Leaves:
        """The most probable map's leave codes (1, steps)."""
        after = np.empty((len(self.weights), self.problem.frontier.states))
        leaves = np.zeros((1, len(after)), np.uint8)
        logs = self.problem.evidence.log_weights(self.problem.sweep)
        log_kernels.log_backward(logs, *self.problem.tables, after, True)
        walk_kernels.follow_best(logs, *self.problem.tables, after, leaves)
        return leaves


def solve(problem: Problem) -> LocalSolution:
    """Exact posterior by a backward and a forward pass."""
    weights = problem.evidence.weights(problem.sweep)
    steps = problem.sweep.steps
    after = np.empty((steps, problem.frontier.states))
    lost = np.empty(steps)
    types = np.empty_like(weights)
    log_mass = sweep_kernels.backward(weights, *problem.tables, after, lost)
    if log_mass > -np.inf:
        error = sweep_kernels.forward(weights, *problem.tables, after, lost, types)
        if error <= TOLERANCE:
            return LocalSolution(
                problem, log_mass, types, weights, after, lost.tolist(), logarithmic=False
            )
    weights = problem.evidence.log_weights(problem.sweep)
    log_mass = log_kernels.log_backward(weights, *problem.tables, after, False)
    if log_mass > -np.inf:
        log_kernels.log_forward(weights, *problem.tables, after, types)
    return LocalSolution(problem, log_mass, types, weights, after, lost.tolist(), logarithmic=True)
