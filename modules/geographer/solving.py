"""Choose how to solve a map problem: local evidence needs no registers."""

from __future__ import annotations

import numpy as np

from modules.geographer import register_solution, solution, sweep_kernels
from modules.geographer.register_solution import RegisterSolution
from modules.geographer.solution import LocalSolution, Problem


def solve(problem: Problem) -> LocalSolution | RegisterSolution:
    """The exact posterior. Raises ProblemTooLargeError."""
    if problem.evidence.local:
        return solution.solve(problem)
    return register_solution.solve(problem)


def log_mass(problem: Problem) -> float:
    """The log of the total weight alone. Raises ProblemTooLargeError."""
    if problem.evidence.local:
        return solution.solve(problem).log_mass
    return register_solution.log_mass(problem)


def possible(problem: Problem) -> bool:
    """Whether any map has positive weight, if all factors are 0 or 1."""
    if not problem.evidence.local:
        return register_solution.log_mass(problem) > -np.inf
    after = np.empty((problem.sweep.steps, problem.frontier.states))
    weights = problem.evidence.weights(problem.sweep)
    lost = np.empty(problem.sweep.steps)
    return sweep_kernels.backward(weights, *problem.tables, after, lost) > -np.inf
