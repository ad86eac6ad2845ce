"""The state space of H: some maps, and "none of the above" (paper, section 3)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bus.grid import JUNCTION_TYPES, Grid, Maps
from modules.geographer.paper.errors import HypothesesError

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class HypothesisSet:
    """The maps that H may be, and NOTA as its last state.

    `maps` (n, corridors) of 0 and 1, no two equal, each connected. The paper's |H| counts NOTA:
    all its averages over ten runs in Table 1 are whole numbers only if |H| is the number of
    states. `exhaustive` says that no other map is possible; NOTA is then ruled out beforehand.
    Raises HypothesesError.
    """

    grid: Grid
    maps: Maps
    exhaustive: bool = False

    def __post_init__(self) -> None:
        if self.maps.ndim != 2 or self.maps.shape[1] != self.grid.corridors:
            expected = f"(n, {self.grid.corridors})"
            raise HypothesesError(f"maps: found shape {self.maps.shape}, expected {expected}")
        if not len(self.maps):
            raise HypothesesError("maps: found none, expected at least one besides NOTA")
        if self.maps.max() > 1:
            raise HypothesesError(f"maps: found an entry {self.maps.max()}, expected 0 or 1")
        _check_distinct(self.maps)
        _check_connected(self.grid, self.maps)

    @property
    def states(self) -> int:
        """How many states H has: the maps and NOTA."""
        return len(self.maps) + 1

    @property
    def nota(self) -> int:
        """The number of the state NOTA: the last."""
        return len(self.maps)

    @cached_property
    def prior(self) -> Floats:
        """Pr(H), (states,): uniform, with NOTA at zero where the set is exhaustive."""
        weights = np.ones(self.states)
        weights[self.nota] = 0.0 if self.exhaustive else 1.0
        prior: Floats = weights / weights.sum()
        return prior

    @cached_property
    def types(self) -> NDArray[np.uint8]:
        """The junction type of each intersection in each map: (n, intersections)."""
        return self.grid.junction_types(self.maps)

    @cached_property
    def fitting(self) -> NDArray[np.bool_]:
        """Which types a junction can have on the grid: (intersections, 16)."""
        places = [self.grid.place(v) for v in range(self.grid.intersections)]
        return np.array([self.grid.possible_types(x, y) for x, y in places])

    def types_at(self, intersection: int) -> NDArray[np.int64]:
        """The types that fit at an intersection, in order: the states of its J."""
        return np.flatnonzero(self.fitting[intersection])

    def junction_given_state(self, intersection: int) -> Floats:
        """Pr(J|H), (states, 16): certain for a map, uniform over what fits for NOTA."""
        table = np.zeros((self.states, JUNCTION_TYPES))
        table[np.arange(len(self.maps)), self.types[:, intersection]] = 1.0
        fitting = self.fitting[intersection]
        table[self.nota] = fitting / fitting.sum()
        return table

    def contains(self, corridors: NDArray[np.uint8]) -> bool:
        """Whether a map (corridors,) is among the hypotheses."""
        return bool((self.maps == corridors).all(axis=1).any())


def _check_distinct(maps: Maps) -> None:
    first: dict[bytes, int] = {}
    for number, corridors in enumerate(maps):
        before = first.setdefault(corridors.tobytes(), number)
        if before != number:
            raise HypothesesError(f"maps {before} and {number} are the same map")


def _check_connected(grid: Grid, maps: Maps) -> None:
    """Grow one component in all maps at once; what it does not reach is another one."""
    ends = np.array([grid.ends(c) for c in range(grid.corridors)])
    present = maps.astype(bool)
    joined = np.zeros((len(maps), grid.intersections), dtype=bool)
    start = ends[np.argmax(present, axis=1), 0]
    joined[np.arange(len(maps)), start] = present.any(axis=1)
    for _ in range(grid.intersections):
        for corridor, (a, b) in enumerate(ends):
            met = present[:, corridor] & (joined[:, a] | joined[:, b])
            joined[:, a] |= met
            joined[:, b] |= met
    whole = ~(present & ~joined[:, ends[:, 0]]).any(axis=1) & present.any(axis=1)
    if not whole.all():
        raise HypothesesError(
            f"map {int(np.argmin(whole))}: found several components or no corridor, "
            "expected one component"
        )
