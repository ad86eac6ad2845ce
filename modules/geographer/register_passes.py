"""The frontier passes with registers, step by step: see :mod:`modules.geographer.registers`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from modules.geographer import register_kernels, sweep_kernels
from modules.geographer.errors import ProblemTooLargeError
from modules.geographer.frontier import START, Frontier, Table
from modules.geographer.registers import Labels, Registers, register_values
from modules.geographer.solution import Problem
from modules.geographer.sweep_kernels import LEAST

Floats = NDArray[np.float64]

MOST_GIB = 4.0
"""The most memory that a belief may take."""


def log_of(values: Floats) -> Floats:
    """Logs, of 0 too."""
    with np.errstate(divide="ignore"):
        logs: Floats = np.log(values)
    return logs


@dataclass(frozen=True, eq=False)
class Passes:
    """The passes over one problem. Arrays of a step are by state, label and count.

    `values` is how many values the registers have before each step and at the end.
    """

    problem: Problem
    registers: Registers
    values: list[int]

    @classmethod
    def of(cls, problem: Problem) -> Passes:
        """The passes that the evidence needs. Raises ProblemTooLargeError."""
        values = register_values(problem.sweep, problem.evidence)
        entries = problem.frontier.states * sum(values[1:])
        if entries * 8 / 2**30 > MOST_GIB:
            raise ProblemTooLargeError(
                f"a prior on the number of corridors or evidence about pairs of junctions needs "
                f"{entries} table entries on this grid, {entries * 8 / 2**30:.1f} GiB; at most "
                f"{MOST_GIB:.0f} GiB are allowed"
            )
        return cls(problem, Registers.of(problem.sweep, problem.evidence), values)

    def weights(self) -> list[Floats]:
        """The weights (labels, 4, 4) of each step."""
        local = self.problem.evidence.weights(self.problem.sweep)
        return [w * factors for w, factors in zip(local, self.registers.factors, strict=True)]

    def log_weights(self) -> list[Floats]:
        """Logs of :meth:`weights`, right also where those underflow."""
        local = self.problem.evidence.log_weights(self.problem.sweep)
        factors = self.registers.factors
        return [w + log_of(factor) for w, factor in zip(local, factors, strict=True)]

    def moves_at(self, step: int) -> tuple[Labels, Table, int, bool]:
        """What every kernel takes of a step, after its weights."""
        frontier = self._frontier
        close = frontier.close[step % frontier.width]
        return self.registers.moves[step], close, frontier.idle, self.registers.counting

    def arriving(self, step: int) -> Table:
        """From states after a step to those before the next."""
        row: Table = self._frontier.enter[(step + 1) % self._frontier.width]
        return row

    def backward(self) -> tuple[float, list[Floats], list[float]]:
        """The log total, what follows each state after each step, and bounds on its losses.

        The first bound is that on the relative loss of the total; the others belong to the steps.
        """
        after = [self._end(self.registers.final, 0.0)]
        lost = [0.0]
        log_mass = 0.0
        weights = self.weights()
        scratch = self._scratch()
        for step in reversed(range(len(weights))):
            here = self._view(step, scratch)
            self._pull(step, weights[step], after[-1], here)
            if step == 0:
                here = here[START]
            top = float(here.max())
            if top == 0.0:
                return -np.inf, [], [np.inf]
            log_mass += float(np.log(top))
            lost.append((_gain(weights[step]) * lost[-1] + 4 * LEAST) / top + LEAST)
            if step > 0:
                after.append(np.empty_like(here))
                register_kernels.gather(self.arriving(step - 1), here, top, after[-1])
        return log_mass, after[::-1], lost[::-1]

    def forward(self, after: list[Floats], lost: list[float]) -> tuple[list[Floats], Floats, float]:
        """Posteriors by label, that of the count, and a bound on their error by underflow."""
        before = self._start()
        missing = error = 0.0
        by_label = []
        reached = before
        scratch, other = self._scratch(), self._scratch()
        for step, weights in enumerate(self.weights()):
            types, reached = np.empty_like(weights), self._view(step + 1, scratch)
            self._push(step, weights, before, after[step], reached, types)
            total, mass = float(types.sum()), float(reached.sum())
            if total == 0.0 or mass == 0.0:
                return [], np.zeros(0), np.inf
            gain = _gain(weights)
            error = max(error, gain * (missing + lost[step + 1] + before.size * LEAST) / total)
            missing = (gain * missing + 4 * before.size * LEAST) / mass + reached.size * LEAST
            by_label.append(types / total)
            before = self._view(step + 1, other)
            register_kernels.scatter(self.arriving(step), reached, mass, before)
        counts = reached[-2, 0] * self.registers.final
        return by_label, counts / counts.sum(), error

    def log_backward(self, best: bool) -> tuple[float, list[Floats]]:
        """The log total, or that of the best map, and logs of what follows each state."""
        after = [self._end(log_of(self.registers.final), -np.inf)]
        weights = self.log_weights()
        scratch = self._scratch()
        for step in reversed(range(len(weights))):
            here = self._view(step, scratch)
            register_kernels.log_pull(weights[step], *self.moves_at(step), after[-1], here, best)
            if step > 0:
                after.append(here[self.arriving(step - 1)])
        return float(scratch[START]), after[::-1]

    def log_forward(self, after: list[Floats]) -> tuple[list[Floats], Floats]:
        """Posteriors by label, and that of the count, from logs of what follows.

        What is carried forward is the posterior probability of each state.
        """
        before = self._start()
        by_label = []
        reached = before
        first, second, third = (self._scratch() for _ in range(3))
        for step, weights in enumerate(self.log_weights()):
            types = np.empty_like(weights)
            here, reached = self._view(step, first), self._view(step + 1, second)
            moves = self.moves_at(step)
            register_kernels.log_pull(weights, *moves, after[step], here, False)
            register_kernels.log_push(weights, *moves, before, here, after[step], reached, types)
            by_label.append(types / types.sum())
            before = self._view(step + 1, third)
            register_kernels.scatter(self.arriving(step), reached, float(types.sum()), before)
        counts = reached[-2, 0]
        return by_label, counts / counts.sum()

    def _idle(self, step: int) -> bool:
        """Whether the registers have one value before and after a step."""
        return max(self.values[step : step + 2]) == 1 and not self.registers.counting

    def _pull(self, step: int, weights: Floats, after: Floats, here: Floats) -> None:
        """Fill `here` with what follows each state before a step."""
        moves, close, idle, counting = self.moves_at(step)
        if self._idle(step):
            sweep_kernels.pull(weights[0], close, idle, after.ravel(), here.ravel())
        else:
            register_kernels.pull(weights, moves, close, idle, counting, after, here)

    def _push(
        self,
        step: int,
        weights: Floats,
        before: Floats,
        after: Floats,
        reached: Floats,
        types: Floats,
    ) -> None:
        """Fill `types` with the step's weight by label and type, `reached` with what comes out."""
        moves, close, idle, counting = self.moves_at(step)
        if self._idle(step):
            sweep_kernels.push(weights[0], close, idle, before.ravel(), reached.ravel())
            sweep_kernels.types_of(weights[0], close, idle, before.ravel(), after.ravel(), types[0])
        else:
            register_kernels.push(
                weights, moves, close, idle, counting, before, after, reached, types
            )

    @property
    def _frontier(self) -> Frontier:
        return self.problem.frontier

    def _scratch(self) -> Floats:
        """Memory for any one step: to take it anew at each costs more than to fill it."""
        return np.empty(self._frontier.states * max(self.values))

    def _view(self, step: int, scratch: Floats) -> Floats:
        """As much of it as the registers need before a step."""
        labels, counts = self.registers.labels[step], self.registers.counts[step]
        shape = self._frontier.states, labels, counts
        return scratch[: int(np.prod(shape))].reshape(shape)

    def _start(self) -> Floats:
        before = np.zeros((self._frontier.states, 1, 1))
        before[START] = 1.0
        return before

    def _end(self, final: Floats, elsewhere: float) -> Floats:
        after = np.full((self._frontier.states, 1, len(final)), elsewhere)
        after[-2, 0] = final
        return after


def _gain(weights: Floats) -> float:
    """The most that one step can multiply a loss by."""
    return float(weights.sum(axis=2).max())
