"""What the sweep knows on both sides of each step, worked out only as far as it is asked for.

New evidence at one junction changes what follows every earlier step and what comes before every
later one; the rest stays and is shared with the belief before. So the log evidence and the
junction's own posterior need no pass at all, another junction's as many steps as the sweep makes
between the two, and all junctions' two thirds of a fresh update.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from modules.geographer import sweep_kernels
from modules.geographer.frontier import START, Frontier
from modules.geographer.solution import LocalSolution, Problem

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Message:
    """Weights (states,) by state of the frontier, and the bound on what they lost."""

    weights: Floats
    lost: float


@dataclass(frozen=True, eq=False)
class Messages:
    """Messages of local evidence in linear numbers, filled in as they are needed.

    By step: `weights` (4, 4); `before` what leads to each state before it, `after` what may follow
    each state after it, both scaled; `types` (4, 4) the posterior with a bound on its error.
    """

    frontier: Frontier
    weights: list[Floats]
    before: list[Message | None]
    after: list[Message | None]
    types: dict[int, tuple[Floats, float]]

    @cached_property
    def scratch(self) -> Floats:
        """Memory for one step."""
        return np.empty(self.frontier.states)

    @classmethod
    def of(cls, solution: LocalSolution) -> Messages:
        """The messages of a solved problem, which must not be in logarithms."""
        start = np.zeros(solution.problem.frontier.states)
        start[START] = 1.0
        steps = len(solution.weights)
        after = [Message(*row) for row in zip(solution.after, solution.lost, strict=True)]
        return cls(
            solution.problem.frontier,
            list(solution.weights),
            [Message(start, 0.0), *[None] * (steps - 1)],
            list(after),
            {step: (solution.types[step], 0.0) for step in range(steps)},
        )

    def changed(self, step: int, weights: Floats, types: Floats) -> Messages:
        """The messages with other weights at one step, whose posterior is known already."""
        steps = len(self.weights)
        return Messages(
            self.frontier,
            [*self.weights[:step], weights, *self.weights[step + 1 :]],
            [*self.before[: step + 1], *[None] * (steps - step - 1)],
            [*[None] * step, *self.after[step:]],
            {step: (types, self.types[step][1])},
        )

    def posterior(self, step: int) -> tuple[Floats, float]:
        """The posterior (4, 4) of a step's junction type, and a bound on its error."""
        if step not in self.types:
            before, after = self._before(step), self._after(step)
            types = np.empty((4, 4))
            error = sweep_kernels.types_step(
                self.weights[step],
                self.frontier.close[step % self.frontier.width],
                self.frontier.idle,
                before.weights,
                before.lost,
                after.weights,
                after.lost,
                types,
            )
            self.types[step] = types, error
        return self.types[step]

    def solution(self, problem: Problem, log_mass: float) -> tuple[LocalSolution, float]:
        """All of it, and a bound on its error."""
        steps = range(len(self.weights))
        self._after(0)
        self._before(steps[-1])
        posteriors = [self.posterior(step) for step in steps]
        after = [self._after(step) for step in steps]
        found = LocalSolution(
            problem,
            log_mass,
            np.array([types for types, _ in posteriors]),
            np.array(self.weights),
            [message.weights for message in after],
            [message.lost for message in after],
            logarithmic=False,
        )
        return found, max(error for _, error in posteriors)

    def _after(self, step: int) -> Message:
        first = step
        while (message := self.after[first]) is None:
            first += 1
        # One block for all: memory taken row by row costs more than to fill it.
        rows = np.empty((first - step, len(message.weights)))
        for later in range(first, step, -1):
            row = rows[later - 1 - step]
            message = self.after[later - 1] = Message(row, self._pull(later, message, row))
        return message

    def _before(self, step: int) -> Message:
        last = step
        while (message := self.before[last]) is None:
            last -= 1
        rows = np.empty((step - last, len(message.weights)))
        for earlier in range(last, step):
            row = rows[earlier - last]
            message = self.before[earlier + 1] = Message(row, self._push(earlier, message, row))
        return message

    def _pull(self, step: int, after: Message, earlier: Floats) -> float:
        """Fill the message after the step before; return the bound on what it lost."""
        frontier, column = self.frontier, step % self.frontier.width
        _top, lost = sweep_kernels.pull_step(
            self.weights[step],
            frontier.enter[column],
            frontier.close[column],
            frontier.idle,
            after.weights,
            after.lost,
            self.scratch,
            earlier,
        )
        return float(lost)

    def _push(self, step: int, before: Message, later: Floats) -> float:
        """Fill the message before the step after; return the bound on what it lost."""
        frontier, width = self.frontier, self.frontier.width
        lost: float = sweep_kernels.push_step(
            self.weights[step],
            frontier.enter[(step + 1) % width],
            frontier.close[step % width],
            frontier.idle,
            before.weights,
            before.lost,
            self.scratch,
            later,
        )
        return lost
