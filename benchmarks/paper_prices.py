"""A geographer whose updates cost what the paper's network would have cost: for whole runs.

Its belief is the exact one; only the time it takes is that of the multiply connected network with
|H| hypotheses (Table 1), given the junctions explored before the run and, where that ``grows``,
during it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from benchmarks.table1 import READINGS
from bus.facts import Facts
from bus.grid import STEP, Grid
from bus.messages import Departure
from bus.topics import GEOGRAPHER
from bus.turns import Handler, Module, Turn
from modules.geographer import ConnectedMaps
from modules.geographer.density import medium_density
from modules.geographer.paper import PaperNetwork, corridor_features, first_set
from modules.geographer.paper.triangulation import largest_clique
from scenarios.modules import build_module

Sizes = Callable[[Sequence[int], Turn], int]
"""|H| for an update, by the junctions explored, when its turn has come."""


class Networks:
    """The paper's network on a grid, by |H|, and the cells of its largest clique."""

    def __init__(self, grid: Grid) -> None:
        self._maps = ConnectedMaps(grid.columns, grid.rows)
        self._features = tuple(corridor_features(grid, READINGS))
        self._networks: dict[int, PaperNetwork] = {}
        self._cells: dict[tuple[int, frozenset[int]], int] = {}

    def cells(self, states: int, explored: Sequence[int]) -> int:
        """Cells of the largest clique with these junctions instantiated, known beforehand."""
        key = states, frozenset(explored)
        if key not in self._cells:
            if states not in self._networks:
                # Which maps are in H makes no difference to the cliques, only how many.
                prior = medium_density(self._maps.grid.corridors)
                chosen = first_set(self._maps, states, np.random.default_rng(states), prior)
                self._networks[states] = PaperNetwork(chosen, self._features)
            self._cells[key] = largest_clique(self._networks[states], explored)
        return self._cells[key]


@dataclass(frozen=True)
class Update:
    """One update as it was priced."""

    visit: int
    length: int
    states: int
    cells: int
    seconds: float


@dataclass
class Repriced:
    """A module in place of the geographer; ``updates`` says what was charged."""

    inner: Module
    facts: Facts
    networks: Networks
    sizes: Sizes
    before: tuple[int, ...]
    grows: bool
    updates: list[Update] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._place, self._explored, self._visit = self.facts.start, dict.fromkeys(self.before), 0

    @property
    def handlers(self) -> Mapping[str, Handler]:
        """The inner module's, with other prices."""
        return {
            topic: partial(self._handle, handler) for topic, handler in self.inner.handlers.items()
        }

    def _handle(self, handler: Handler, said: Any, turn: Turn) -> None:
        if isinstance(said, Departure):
            self._leave(said)
        handler(said, turn)
        for kind, cells in tuple(turn.works):
            if kind == "belief":
                self._reprice(turn, cells)

    def _leave(self, said: Departure) -> None:
        self._visit = said.visit
        if said.visit > 0:
            if self.grows:
                self._explored[self._place] = None
            (x, y), (dx, dy) = self.facts.grid.place(self._place), STEP[said.heading]
            self._place = self.facts.grid.intersection(x + dx, y + dy)

    def _reprice(self, turn: Turn, charged: int) -> None:
        explored, costs = list(self._explored), turn.costs
        states = self.sizes(explored, turn)
        cells = self.networks.cells(states, explored)
        cost_ns = costs.cost_ns("belief", cells)
        turn.cells += cells - charged
        turn.cost_ns += cost_ns - costs.cost_ns("belief", charged)
        self.updates.append(Update(self._visit, len(explored), states, cells, cost_ns / 1e9))


def forced(states: int) -> Sizes:
    """Always so many hypotheses."""
    return lambda _explored, _turn: states


def largest_in(networks: Networks, sizes: Sequence[int], within_s: float) -> Sizes:
    """A fixed-time procedure: the most hypotheses whose update takes at most so long.

    The fewest of ``sizes`` where none does.
    """

    def choose(explored: Sequence[int], turn: Turn) -> int:
        cells = turn.costs.cells_within("belief", round(within_s * 1e9))
        return max((n for n in sizes if networks.cells(n, explored) <= cells), default=min(sizes))

    return choose


def building_with(
    priced: list[Repriced],
    networks: Networks,
    sizes: Sizes,
    before: tuple[int, ...],
    *,
    grows: bool,
) -> Callable[..., Any]:
    """Builds a run's modules, the geographer at the paper's prices; it is appended to a list."""

    def build(name: str, facts: Facts, settings: Mapping[str, Any], seed: int) -> Module:
        module = build_module(name, facts, settings, seed)
        if name != GEOGRAPHER:
            return module
        priced.append(Repriced(module, facts, networks, sizes, before, grows))
        return priced[-1]

    return build
