"""Solve a map problem with a prior on the number of corridors or entangled pairs of junctions.

The sweep's state is the frontier's and the value of the registers, so all that holds for local
evidence holds here: sums are of positive terms only, exact to rounding. Costs are those of local
evidence times the number of values that the registers have, step by step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from modules.geographer import register_kernels, solution
from modules.geographer.frontier import START
from modules.geographer.register_passes import Passes, log_of
from modules.geographer.solution import Leaves, Problem

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class RegisterSolution:
    """The posterior on the sweep's steps, like LocalSolution; `after` is a list by step.

    `by_label` is the posterior of each step, (labels, 4, 4); `counts` that of the number of
    corridors, up to the largest with a positive prior, or (1,) where none is counted.
    """

    passes: Passes
    log_mass: float
    by_label: list[Floats]
    counts: Floats
    after: list[Floats]
    logarithmic: bool

    @property
    def types(self) -> Floats:
        """The posterior by enter and leave code, (steps, 4, 4)."""
        return np.array([types.sum(axis=0) for types in self.by_label])

    def expected_log_weight(self) -> float:
        """The posterior mean of a map's log scaled weight."""
        expected = 0.0
        pairs = zip(self.by_label, self.passes.log_weights(), strict=True)
        for probability, log in [*pairs, (self.counts, log_of(self.passes.registers.final))]:
            possible = probability > 0.0
            expected += float((probability[possible] * log[possible]).sum())
        return expected

    def draw(self, uniforms: Floats) -> Leaves:
        """A map for each row of fractions (maps, steps): leave codes (maps, steps)."""
        return self._walk(self.after, self.logarithmic, uniforms)

    def best(self) -> Leaves:
        """The most probable map's leave codes (1, steps)."""
        after = self.passes.log_backward(best=True)[1]
        return self._walk(after, True, np.full((1, len(after)), -1.0))

    def _walk(self, after: list[Floats], logarithmic: bool, uniforms: Floats) -> Leaves:
        passes = self.passes
        leaves = np.zeros(uniforms.shape, np.uint8)
        places = np.zeros((len(leaves), 3), np.int64)
        places[:, 0] = START
        for step, weights in enumerate(passes.log_weights()):
            taken = np.zeros(len(leaves), np.uint8)
            register_kernels.walk(
                weights,
                *passes.moves_at(step),
                passes.arriving(step),
                after[step],
                logarithmic,
                np.ascontiguousarray(uniforms[:, step]),
                places,
                taken,
            )
            leaves[:, step] = taken
        return leaves


def solve(problem: Problem) -> RegisterSolution:
    """Exact posterior by a backward and a forward pass. Raises ProblemTooLargeError."""
    passes = Passes.of(problem)
    log_mass, after, lost = passes.backward()
    if log_mass > -np.inf:
        by_label, counts, error = passes.forward(after, lost)
        if error <= solution.TOLERANCE:
            return RegisterSolution(passes, log_mass, by_label, counts, after, False)
    log_mass, after = passes.log_backward(best=False)
    if log_mass == -np.inf:
        return RegisterSolution(passes, log_mass, [], np.zeros(0), after, True)
    return RegisterSolution(passes, log_mass, *passes.log_forward(after), after, True)


def log_mass(problem: Problem) -> float:
    """The log total alone, from a backward pass. Raises ProblemTooLargeError."""
    passes = Passes.of(problem)
    found, _after, lost = passes.backward()
    if lost[0] <= solution.TOLERANCE:
        return found
    return passes.log_backward(best=False)[0]
