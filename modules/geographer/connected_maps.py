"""The exact posterior over all connected maps of a grid.

All locally distinctive places are connected (paper, section 3), so a map is a non-empty set of
corridors in one component. What is observed is local to junctions and corridors, hence sums
over all maps can be taken by a frontier method (transfer matrix): sweep the intersections, keep
for each state of the frontier the total weight of all partial maps in that state. The cost is
linear in the grid's longer side and exponential in the shorter one.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from bus.grid import Grid
from modules.geographer import counting, evidence
from modules.geographer.errors import EvidenceError, GridTooWideError
from modules.geographer.evidence import Evidence
from modules.geographer.frontier import Frontier, state_count, update_cells
from modules.geographer.map_belief import MapBelief
from modules.geographer.pairs import PairLikelihood
from modules.geographer.solution import Problem
from modules.geographer.solving import log_mass
from modules.geographer.sweep import Sweep
from modules.geographer.table_store import Progress, tables

WIDEST = 10
"""The most lines the shorter side may have; each line more needs five times the memory."""


class ConnectedMaps:
    """All connected maps of a grid of `columns` by `rows` lines, and beliefs about them.

    The tables of grids 8 lines wide and more are kept in a cache folder
    (:mod:`modules.geographer.table_store`); `progress` is called with what is done and what there
    is to do while they are built.

    Raises ValueError for fewer than one line or a single intersection, GridTooWideError
    where the shorter side has more than 10 lines.
    """

    def __init__(self, columns: int, rows: int, progress: Progress | None = None) -> None:
        self.grid = Grid(columns, rows)
        _check_width(self.grid)
        self._sweep = Sweep.of(self.grid)
        self._frontier: Frontier = tables(self._sweep.width, progress)
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
        return update_cells(self._sweep.width, self._sweep.steps)

    def posterior(
        self,
        junction_likelihood: ArrayLike,
        corridor_odds: ArrayLike = 1.0,
        corridor_likelihood: ArrayLike | None = None,
        corridor_count_weights: ArrayLike | None = None,
        pairs: Iterable[PairLikelihood] = (),
    ) -> MapBelief:
        """The belief over all connected maps given evidence about them.

        `junction_likelihood` (rows, columns, 16) is P(readings | junction type), indexed
        [y, x, type]; entries for types that lead off the grid are ignored. `corridor_odds` is
        the prior odds that a corridor exists, one number or one a corridor in the map's order;
        the prior is restricted to connected maps. `corridor_likelihood` (corridors, 2) is
        P(observations | absent), P(observations | present). Likelihoods matter up to a factor
        for the belief; `log_evidence` takes them as they are.

        `corridor_count_weights` (corridors + 1,) multiplies the prior of every map by a weight
        for its number of corridors (:mod:`modules.geographer.density` makes some): exactly, at
        the cost of an update times about half the corridors, in time and memory. `pairs` are
        readings that depend on the types of two neighbours. One that factors given their corridor
        costs nothing; any other up to 8 times as much for the steps between the two, that is one
        step for neighbours along the shorter side, a line for those along the longer one; pairs
        that overlap in these steps multiply.

        Raises EvidenceError for wrong shapes, negative or non-finite entries, or a prior that
        allows no map; ContradictoryEvidenceError where every map has probability zero;
        ProblemTooLargeError where counts or pairs need more than 4 GiB.
        """
        before = evidence.prior(self.grid, corridor_odds, corridor_count_weights)
        known = evidence.observed(
            self.grid, self._sweep, before, junction_likelihood, corridor_likelihood, pairs
        )
        log_prior = self._log_mass(before) + before.log_scale
        problem = Problem(self._frontier, self._sweep, known)
        return MapBelief.solved(self.grid, problem, before, log_prior)

    def _log_mass(self, before: Evidence) -> float:
        """The prior's normaliser, computed again only when the prior changes."""
        key = before.corridors.tobytes() + (
            b"" if before.counts is None else before.counts.tobytes()
        )
        if key != self._prior_key:
            mass = log_mass(Problem(self._frontier, self._sweep, before))
            if mass == -np.inf:
                raise EvidenceError(
                    "corridor_odds: no connected map is possible under these odds"
                    + (" and corridor_count_weights" if before.counts is not None else "")
                )
            self._prior_key, self._prior_log_mass = key, mass
        return self._prior_log_mass


def _check_width(grid: Grid) -> None:
    width = min(grid.columns, grid.rows)
    if width > WIDEST:
        states = state_count(width)
        gib = states * grid.intersections * 8 / 2**30
        cells = update_cells(width, grid.intersections)
        raise GridTooWideError(
            f"a grid of {grid.columns} by {grid.rows} lines has {states} frontier states "
            f"for each of {grid.intersections} intersections: {cells} cells an update, "
            f"{gib:.1f} GiB a belief; the shorter side may have at most {WIDEST} lines"
        )
