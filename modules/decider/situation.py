"""What the decider is told, and what it answers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bus.grid import DIRECTIONS, Grid, Maps


class SituationError(ValueError):
    """A situation that does not fit together: which part, what was found, what was expected."""


@dataclass(frozen=True)
class Situation:
    """All that a path decision rests on (paper, section 3). Probabilities are given E.

    Equal maps may occur several times in ``maps`` and must then have equal
    ``log_probability``. The maps of each junction type should come in an order in which
    any first few are as good a sample as the rest. Raises :class:`SituationError` for parts of
    the wrong shape or outside their range.
    """

    grid: Grid
    place: int
    """The intersection v where the decision takes effect (``grid.intersection(x, y)``)."""
    came_from: int
    """Direction bit of the corridor behind the robot at v, known to exist; 0 if none."""
    waypoints: tuple[int, ...]
    """Goals still to visit, the current one first; none in spare time."""
    tasks: NDArray[np.int64]
    """(r, 2): start and goal of each expected future task T_j."""
    expected: NDArray[np.float64]
    """(r,): E|T_j|, how many of each are expected."""
    maps: Maps
    """(n, corridors): the hypotheses H."""
    weights: NDArray[np.float64]
    """(n,): Pr(M_j given E) as sampled; they sum to 1."""
    log_probability: NDArray[np.float64]
    """(n,): the exact log posterior of each map, up to a constant: it names M*_I."""
    corridor_probability: NDArray[np.float64]
    """(corridors,): marginal probability that each corridor exists."""
    corridor_s: NDArray[np.float64]
    """(corridors,): seconds to traverse each."""
    sensing_s: float
    """Seconds to classify a junction that is not yet settled."""
    known_at: float = 0.99
    """A corridor at least this probable counts as known; at most 1 - this, as known absent."""

    def __post_init__(self) -> None:
        self._check_shapes()
        self._check_places()
        self._check_numbers()

    @property
    def goals(self) -> tuple[int, ...]:
        """The waypoints without those at the front where the robot will be anyway."""
        first = 0
        while first < len(self.waypoints) and self.waypoints[first] == self.place:
            first += 1
        return self.waypoints[first:]

    def _check_shapes(self) -> None:
        n, r, corridors = len(self.maps), len(self.tasks), self.grid.corridors
        for name, found, expected in (
            ("tasks", self.tasks, (r, 2)),
            ("expected", self.expected, (r,)),
            ("maps", self.maps, (n, corridors)),
            ("weights", self.weights, (n,)),
            ("log_probability", self.log_probability, (n,)),
            ("corridor_probability", self.corridor_probability, (corridors,)),
            ("corridor_s", self.corridor_s, (corridors,)),
        ):
            if found.shape != expected:
                raise SituationError(f"{name} has shape {found.shape}, expected {expected}")

    def _check_places(self) -> None:
        count = self.grid.intersections
        for name, places in (
            ("place", (self.place,)),
            ("waypoints", self.waypoints),
            ("tasks", tuple(self.tasks.ravel().tolist())),
        ):
            off = [v for v in places if not 0 <= v < count]
            if off:
                raise SituationError(f"{name}: {off} expected to lie in 0..{count - 1}")
        at = self.grid.place(self.place)
        if self.came_from and (
            self.came_from not in DIRECTIONS or self.grid.corridor(*at, self.came_from) < 0
        ):
            raise SituationError(
                f"came_from is {self.came_from}, expected 0 or the bit of a corridor "
                f"that stays on the grid at {at}"
            )

    def _check_numbers(self) -> None:
        _require("corridor_s", self.corridor_s, "above 0 and finite", self.corridor_s > 0)
        _require("expected", self.expected, "at least 0 and finite", self.expected >= 0)
        _require("weights", self.weights, "at least 0 and finite", self.weights >= 0)
        total = float(np.sum(self.weights))
        if len(self.weights) and abs(total - 1.0) > 1e-6:
            raise SituationError(f"weights sum to {total}, expected 1")
        if not 0.0 <= self.sensing_s < np.inf:
            raise SituationError(f"sensing_s is {self.sensing_s}, expected at least 0 and finite")
        if not 0.5 < self.known_at <= 1.0:
            raise SituationError(f"known_at is {self.known_at}, expected in (0.5, 1]")


def _require(name: str, values: NDArray[Any], rule: str, holds: NDArray[np.bool_]) -> None:
    bad = ~(holds & np.isfinite(values))
    if bad.any():
        raise SituationError(f"{name} has {values[bad][0]}, expected {rule}")


@dataclass(frozen=True)
class Decision:
    """What to do for each junction type that may be found at v; every array has length 16."""

    direction: NDArray[np.uint8]
    """Direction bit of the corridor to take; 0 is stay: no waypoint is left, or no corridor."""
    known_s: NDArray[np.float64]
    """E[P_K]; infinite where no known path leads to the goals, or where no map has the type."""
    unknown_s: NDArray[np.float64]
    """The least E[P_U]; infinite where there is nothing to explore, or no map has the type."""
    explores: NDArray[np.bool_]
    """Whether P_U was chosen."""
    cells: int
    """Costs reckoned: one for each task or leg of an errand, plan and true map."""
    hypotheses: int
    """Distinct maps used, over all junction types."""
