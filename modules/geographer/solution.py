"""Solve a map problem with the frontier passes, and keep what later questions need."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from modules.geographer import log_kernels, sweep_kernels
from modules.geographer.evidence import Evidence
from modules.geographer.frontier import Frontier
from modules.geographer.sweep import Sweep

Floats = NDArray[np.float64]

TOLERANCE = 1e-15
"""The most that underflow may change a posterior probability; else logarithms are used.

Evidence that strong and that contradictory is rare; logarithms cost some ten times more.
"""


@dataclass(frozen=True)
class Solution:
    """The posterior of one problem on the sweep's steps.

    `log_mass` is the log of the total scaled weight of all connected maps, -inf if there is
    none; `types` (steps, 4, 4) the posterior by enter and leave code. `weights` and `after` (the
    weight of what may follow each state) are logs if `logarithmic`.
    """

    log_mass: float
    types: Floats
    weights: Floats
    after: Floats
    logarithmic: bool


def solve(frontier: Frontier, sweep: Sweep, evidence: Evidence) -> Solution:
    """Exact posterior by a backward and a forward pass."""
    tables = frontier.enter, frontier.close, frontier.idle
    weights = evidence.weights(sweep)
    after = np.empty((sweep.steps, frontier.states))
    lost = np.empty(sweep.steps)
    types = np.empty_like(weights)
    log_mass = sweep_kernels.backward(weights, *tables, after, lost)
    if log_mass > -np.inf:
        error = sweep_kernels.forward(weights, *tables, after, lost, types)
        if error <= TOLERANCE:
            return Solution(log_mass, types, weights, after, logarithmic=False)
    weights = evidence.log_weights(sweep)
    log_mass = log_kernels.log_backward(weights, *tables, after, False)
    if log_mass > -np.inf:
        log_kernels.log_forward(weights, *tables, after, types)
    return Solution(log_mass, types, weights, after, logarithmic=True)
