"""The posterior over all connected maps, and the questions that it answers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bus.grid import JUNCTION_TYPES, Grid, Maps
from modules.geographer import solution, walk_kernels
from modules.geographer.checks import checked
from modules.geographer.conflict import contradiction
from modules.geographer.errors import EvidenceError
from modules.geographer.evidence import Evidence
from modules.geographer.messages import Messages
from modules.geographer.register_solution import RegisterSolution
from modules.geographer.solution import LocalSolution, Problem
from modules.geographer.solving import solve

Floats = NDArray[np.float64]

UNLIKELY = 1e-6
"""Evidence less probable than this is not read off old marginals, whose digits it would cost."""

FEW = 1000
"""With fewer states of the frontier one pass in compiled code beats steps called one by one."""


@dataclass(frozen=True)
class Estimate:
    """An expected value by `n` samples, and the standard error of it."""

    mean: float
    standard_error: float
    n: int


@dataclass(frozen=True, eq=False)
class MapBelief:
    """The posterior over all connected maps of a grid; made by ConnectedMaps.posterior.

    `log_evidence` is the log probability of the evidence under the normalised prior.
    """

    grid: Grid
    log_evidence: float
    _problem: Problem
    _prior: Evidence
    _log_prior: float
    _known: LocalSolution | RegisterSolution | Messages

    @classmethod
    def solved(cls, grid: Grid, problem: Problem, before: Evidence, log_prior: float) -> MapBelief:
        """The belief from scratch; `log_prior` is the log of the prior's normaliser.

        Raises ContradictoryEvidenceError, ProblemTooLargeError.
        """
        found = solve(problem)
        if found.log_mass == -np.inf:
            raise contradiction(grid, problem, before)
        log_evidence = found.log_mass + problem.evidence.log_scale - log_prior
        return cls(grid, log_evidence, problem, before, log_prior, found)

    def update(self, x: int, y: int, likelihood: ArrayLike) -> MapBelief:
        """The belief after one more likelihood (16,) of the type of the junction at (x, y).

        The same as a posterior of all evidence together. The log evidence and that junction's
        marginals come at once; others are worked out when asked for, :meth:`junction` at a cost
        that grows with its distance along the longer side, everything at about two thirds of a
        fresh belief, where that is an update itself: the first one must work out what leads to
        its junction. Small grids, counted corridors, entangled pairs and what is in logarithms
        are solved afresh.

        Raises EvidenceError off the grid or for a likelihood that is none, and
        ContradictoryEvidenceError where every map has probability zero.
        """
        step = self._step(x, y)
        given = checked("likelihood", likelihood, (JUNCTION_TYPES,))
        evidence = self._problem.evidence.with_junction(self.grid.intersection(x, y), given)
        problem = replace(self._problem, evidence=evidence)
        messages = self._messages
        product = self._types(step) * given[self._problem.sweep.types].reshape(4, 4)
        total = float(product.sum())
        if messages is None or total <= UNLIKELY * float(given.max()):
            return MapBelief.solved(self.grid, problem, self._prior, self._log_prior)
        weights = evidence.weights(problem.sweep)[step]
        return replace(
            self,
            log_evidence=self.log_evidence + float(np.log(total)),
            _problem=problem,
            _known=messages.changed(step, weights, product / total),
        )

    def junction(self, x: int, y: int) -> Floats:
        """P(junction type | evidence) at (x, y), (16,). Raises EvidenceError off the grid."""
        result = np.empty(JUNCTION_TYPES)
        result[self._problem.sweep.types] = self._types(self._step(x, y)).ravel()
        return result

    @cached_property
    def junctions(self) -> Floats:
        """P(junction type | evidence), (rows, columns, 16), indexed [y, x, type]."""
        types = self._problem.sweep.to_grid(self._solution.types)
        return types.reshape(self.grid.rows, self.grid.columns, -1)

    @cached_property
    def corridors(self) -> Floats:
        """P(corridor exists | evidence), (corridors,), in the order of a map."""
        return self._problem.sweep.corridor_probabilities(self._solution.types)

    @property
    def corridors_east(self) -> Floats:
        """P(corridor from [y, x] east), (rows, columns - 1)."""
        east = self.corridors[: self.grid.east_corridors]
        return east.reshape(self.grid.rows, self.grid.columns - 1)

    @property
    def corridors_north(self) -> Floats:
        """P(corridor from [y, x] north), (rows - 1, columns)."""
        north = self.corridors[self.grid.east_corridors :]
        return north.reshape(self.grid.rows - 1, self.grid.columns)

    @cached_property
    def corridor_counts(self) -> Floats:
        """P(the map has 0, 1, 2, ... corridors | evidence), (corridors + 1,).

        At the cost of a belief with a prior on their number. Raises ProblemTooLargeError.
        """
        found, size = self._solution, self.grid.corridors + 1
        evidence = self._problem.evidence
        if evidence.counts is None:
            counted = replace(evidence, counts=np.ones(size))
            found = solve(replace(self._problem, evidence=counted))
        assert isinstance(found, RegisterSolution)
        return np.pad(found.counts, (0, size - len(found.counts)))

    @cached_property
    def entropy(self) -> float:
        """Entropy of the belief in nats: the log total less the expected log weight of a map."""
        return max(0.0, self._solution.log_mass - self._solution.expected_log_weight())

    def most_probable(self) -> Maps:
        """The most probable map, (corridors,) of 0 and 1; the same one always where some tie."""
        best: Maps = self._problem.sweep.to_maps(self._solution.best())[0]
        return best

    def sample(self, n: int, rng: np.random.Generator) -> Maps:
        """`n` independent draws from the posterior, (n, corridors) of 0 and 1."""
        sweep = self._problem.sweep
        return sweep.to_maps(self._solution.draw(rng.random((n, sweep.steps))))

    def expect(
        self, function: Callable[[Maps], ArrayLike], n: int, rng: np.random.Generator
    ) -> Estimate:
        """The expected value of a function of the map, from `n` independent draws.

        `function` takes maps (n, corridors) and returns their values (n,). Raises ValueError for
        fewer than two draws or values of another shape.
        """
        if n < 2:
            raise ValueError(f"n: found {n}, expected at least 2 draws for a standard error")
        values = np.asarray(function(self.sample(n, rng)), dtype=np.float64)
        if values.shape != (n,):
            raise ValueError(f"function: found values of shape {values.shape}, expected ({n},)")
        error = float(values.std(ddof=1) / np.sqrt(n))
        return Estimate(float(values.mean()), error, n)

    def log_probability(self, maps: Maps) -> Floats:
        """Log posterior probability (n,) of maps (n, corridors); -inf for impossible ones.

        Raises EvidenceError if the shape is wrong or an entry is not 0 or 1.
        """
        maps = np.asarray(maps)
        if maps.ndim != 2 or maps.shape[1] != self.grid.corridors:
            shape = f"(n, {self.grid.corridors})"
            raise EvidenceError(f"maps: found shape {maps.shape}, expected {shape}")
        wrong = maps[~np.isin(maps, (0, 1))]
        if wrong.size:
            raise EvidenceError(f"maps: found an entry {wrong[0]}, expected 0 or 1")
        sweep, evidence = self._problem.sweep, self._problem.evidence
        leaves = sweep.to_leaves(maps.astype(np.uint8))
        logs: Floats = walk_kernels.weigh(self._log_weights, *self._problem.tables, leaves)
        return logs + evidence.log_beyond(sweep, leaves) - self._solution.log_mass

    @cached_property
    def _log_weights(self) -> Floats:
        return self._problem.evidence.log_weights(self._problem.sweep)

    @cached_property
    def _solution(self) -> LocalSolution | RegisterSolution:
        if not isinstance(self._known, Messages):
            return self._known
        if self._problem.frontier.states < FEW:
            return solve(self._problem)
        log_mass = self.log_evidence - self._problem.evidence.log_scale + self._log_prior
        found, error = self._known.solution(self._problem, log_mass)
        return found if error <= solution.TOLERANCE else solve(self._problem)

    @cached_property
    def _messages(self) -> Messages | None:
        """Messages to update, if there are any: local evidence in linear numbers has them."""
        if isinstance(self._known, LocalSolution) and not self._known.logarithmic:
            return Messages.of(self._known)
        return self._known if isinstance(self._known, Messages) else None

    def _types(self, step: int) -> Floats:
        """The posterior (4, 4) of one step, by enter and leave code."""
        if isinstance(self._known, Messages):
            types, error = self._known.posterior(step)
            if error <= solution.TOLERANCE:
                return types
        from_all: Floats = self._solution.types[step]
        return from_all

    def _step(self, x: int, y: int) -> int:
        if not (0 <= x < self.grid.columns and 0 <= y < self.grid.rows):
            raise EvidenceError(
                f"junction: found [{x},{y}], expected one on the grid of {self.grid.columns} by "
                f"{self.grid.rows} lines"
            )
        return self._problem.sweep.step_of(self.grid.intersection(x, y))
