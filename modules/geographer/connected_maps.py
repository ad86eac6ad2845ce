"""The exact posterior over all connected maps of a grid.

All locally distinctive places are connected (paper, section 3), so a map is a non-empty set of
corridors in one component. What is observed is local to junctions and corridors, hence sums
over all maps can be taken by a frontier method (transfer matrix): sweep the intersections, keep
for each state of the frontier the total weight of all partial maps in that state. The cost is
linear in the grid's longer side and exponential in the shorter one.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bus.grid import Grid, Maps
from modules.geographer import counting, evidence, log_kernels, walk_kernels
from modules.geographer.errors import (
    ContradictoryEvidenceError,
    EvidenceError,
    GridTooWideError,
)
from modules.geographer.evidence import Evidence
from modules.geographer.frontier import Frontier, state_count
from modules.geographer.solution import Solution, solve
from modules.geographer.sweep import Sweep

Floats = NDArray[np.float64]

WIDEST = 10
"""The most lines the shorter side may have; each line more needs five times the memory."""


class ConnectedMaps:
    """All connected maps of a grid of `columns` by `rows` lines, and beliefs about them.

    Raises ValueError for fewer than one line or a single intersection, GridTooWideError
    where the shorter side has more than 10 lines.
    """

    def __init__(self, columns: int, rows: int) -> None:
        self.grid = Grid(columns, rows)
        _check_width(self.grid)
        self._sweep = Sweep.of(self.grid)
        self._frontier = Frontier.of(self._sweep.width)
        self._prior_key = b""
        self._prior_log_mass = 0.0

    @cached_property
    def count(self) -> int:
        """How many connected maps there are."""
        return counting.count(self._frontier, self._sweep.steps, self.grid.corridors)

    def count_by_corridors(self) -> list[int]:
        """How many connected maps have 0, 1, 2, ... corridors."""
        return counting.count_by_corridors(self._frontier, self._sweep.steps, self.grid.corridors)

    @property
    def states(self) -> int:
        """How many states the frontier has between two intersections."""
        return self._frontier.states

    @property
    def update_cells(self) -> int:
        """Table entries touched by one :meth:`posterior`.

        Each of the two passes meets at each intersection every state once and every pair of
        a state and one of the 16 junction types that it allows once.
        """
        frontier = self._frontier
        pairs = 4 * frontier.idle + 12 * frontier.joined
        return 2 * self._sweep.steps * (frontier.states + pairs)

    def posterior(
        self,
        junction_likelihood: ArrayLike,
        corridor_odds: ArrayLike = 1.0,
        corridor_likelihood: ArrayLike | None = None,
    ) -> MapBelief:
        """The belief over all connected maps given local evidence.

        `junction_likelihood` (rows, columns, 16) is P(readings | junction type), indexed
        [y, x, type]; entries for types that lead off the grid are ignored. `corridor_odds` is
        the prior odds that a corridor exists, one number or one a corridor in the map's order;
        the prior is restricted to connected maps. `corridor_likelihood` (corridors, 2) is
        P(observations | absent), P(observations | present). Likelihoods matter up to a factor
        for the belief; `log_evidence` takes them as they are.

        Raises EvidenceError for wrong shapes, negative or non-finite entries, or odds that
        allow no map; ContradictoryEvidenceError where every map has probability zero.
        """
        before = evidence.prior(self.grid, corridor_odds)
        known = evidence.observed(self.grid, before, junction_likelihood, corridor_likelihood)
        prior_log_mass = self._log_mass(before)
        solution = solve(self._frontier, self._sweep, known)
        if solution.log_mass == -np.inf:
            raise _contradiction(self.grid, known, corridor_likelihood is not None)
        log_evidence = solution.log_mass + known.log_scale - prior_log_mass - before.log_scale
        return MapBelief(self.grid, log_evidence, self._frontier, self._sweep, known, solution)

    def _log_mass(self, before: Evidence) -> float:
        """The prior's normaliser, computed again only when the odds change."""
        key = before.corridors.tobytes()
        if key != self._prior_key:
            log_mass = solve(self._frontier, self._sweep, before).log_mass
            if log_mass == -np.inf:
                raise EvidenceError("corridor_odds: all are 0, so that no map is possible")
            self._prior_key, self._prior_log_mass = key, log_mass
        return self._prior_log_mass


@dataclass(frozen=True, eq=False)
class MapBelief:
    """The posterior over all connected maps of a grid; made by :meth:`ConnectedMaps.posterior`.

    `log_evidence` is the log probability of the evidence under the normalised prior.
    """

    grid: Grid
    log_evidence: float
    _frontier: Frontier
    _sweep: Sweep
    _evidence: Evidence
    _solution: Solution

    @cached_property
    def junctions(self) -> Floats:
        """P(junction type | evidence), (rows, columns, 16), indexed [y, x, type]."""
        types = self._sweep.to_grid(self._solution.types)
        return types.reshape(self.grid.rows, self.grid.columns, -1)

    @cached_property
    def corridors(self) -> Floats:
        """P(corridor exists | evidence), (corridors,), in the order of a map."""
        return self._sweep.corridor_probabilities(self._solution.types)

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
    def entropy(self) -> float:
        """Entropy of the belief in nats: the log total less the expected log weight of a map."""
        types, logs = self._solution.types, self._log_weights
        possible = types > 0.0
        return max(0.0, self._solution.log_mass - float((types[possible] * logs[possible]).sum()))

    def most_probable(self) -> Maps:
        """The most probable map, (corridors,) of 0 and 1; the same one always where some tie."""
        after = np.empty_like(self._solution.after)
        leaves = np.zeros((1, self._sweep.steps), np.uint8)
        log_kernels.log_backward(self._log_weights, *self._tables, after, True)
        walk_kernels.follow_best(self._log_weights, *self._tables, after, leaves)
        best: Maps = self._sweep.to_maps(leaves)[0]
        return best

    def sample(self, n: int, rng: np.random.Generator) -> Maps:
        """`n` independent draws from the posterior, (n, corridors) of 0 and 1."""
        solution = self._solution
        leaves = np.zeros((n, self._sweep.steps), np.uint8)
        uniforms = rng.random(leaves.shape)
        walk_kernels.draw(
            solution.weights,
            *self._tables,
            solution.after,
            solution.logarithmic,
            uniforms,
            leaves,
        )
        return self._sweep.to_maps(leaves)

    def log_probability(self, maps: Maps) -> Floats:
        """Log posterior probability (n,) of maps (n, corridors); -inf for impossible ones.

        Raises EvidenceError if the shape is wrong or an entry is not 0 or 1.
        """
        maps = np.asarray(maps, dtype=np.uint8)
        if maps.ndim != 2 or maps.shape[1] != self.grid.corridors:
            shape = f"(n, {self.grid.corridors})"
            raise EvidenceError(f"maps: found shape {maps.shape}, expected {shape}")
        if maps.max(initial=0) > 1:
            raise EvidenceError(f"maps: found an entry {maps.max()}, expected 0 or 1")
        leaves = self._sweep.to_leaves(maps)
        logs: Floats = walk_kernels.weigh(self._log_weights, *self._tables, leaves)
        return logs - self._solution.log_mass

    @cached_property
    def _log_weights(self) -> Floats:
        return self._evidence.log_weights(self._sweep)

    @property
    def _tables(self) -> tuple[NDArray[np.int32], NDArray[np.int32], int]:
        return self._frontier.enter, self._frontier.close, self._frontier.idle


def _check_width(grid: Grid) -> None:
    width = min(grid.columns, grid.rows)
    if width > WIDEST:
        states = state_count(width)
        gib = states * grid.intersections * 8 / 2**30
        raise GridTooWideError(
            f"a grid of {grid.columns} by {grid.rows} lines has {states} frontier states "
            f"for each of {grid.intersections} intersections, {gib:.1f} GiB a belief; "
            f"the shorter side may have at most {WIDEST} lines"
        )


def _contradiction(grid: Grid, known: Evidence, corridors_too: bool) -> ContradictoryEvidenceError:
    junctions = ", ".join(f"[{x},{y}]" for x, y in evidence.where_informative(grid, known))
    return ContradictoryEvidenceError(
        f"no connected map has positive probability: junctions [x,y] with evidence are "
        f"{junctions or 'none'}" + ("; corridors have evidence too" if corridors_too else "")
    )
