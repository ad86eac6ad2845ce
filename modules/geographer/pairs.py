"""Evidence about two neighbouring junctions at once: the multiply connected case.

A feature may depend on the types of two junctions, say one seen from a corridor's middle. Given
the shared corridor, its likelihood as a function of the first junction's type is one of
a few *classes*: rows that are proportional to each other say the same about the second junction.
Evidence of one class for each state of the corridor factors, and costs nothing; else the sweep
remembers the class from the first junction to the second.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bus.grid import DIRECTIONS, JUNCTION_TYPES, OPPOSITE, STEP, Grid
from modules.geographer.checks import checked
from modules.geographer.errors import EvidenceError
from modules.geographer.sweep import Sweep

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

ROUNDING = 1e-14
"""Rows that differ by no more than this, relatively and in every entry, are proportional."""


@dataclass(frozen=True, eq=False)
class PairLikelihood:
    """P(readings | types of two neighbouring junctions).

    `first` and `second` are (x, y); `likelihood` (16, 16) is indexed [type of first, type of
    second]. Entries whose types disagree about the corridor between them, or lead off the grid,
    are ignored.
    """

    first: tuple[int, int]
    second: tuple[int, int]
    likelihood: ArrayLike


@dataclass(frozen=True, eq=False)
class Link:
    """A checked :class:`PairLikelihood` on the sweep's steps, `start` before `end`.

    The likelihood of types (a, b) in the sweep's numbering is `scales[a] * rows[classes[a], b]`.
    """

    start: int
    end: int
    scales: Floats
    classes: Indices
    rows: Floats

    @property
    def entangled(self) -> bool:
        """Whether the sweep has to remember the class of the first junction."""
        return len(self.rows) > 1


def linked(grid: Grid, sweep: Sweep, name: str, pair: PairLikelihood) -> tuple[Link, float]:
    """The pair on the sweep, scaled to at most 1, and the log of what was divided out.

    Raises EvidenceError for a wrong table or junctions that are not neighbours.
    """
    table = checked(f"{name}.likelihood", pair.likelihood, (JUNCTION_TYPES, JUNCTION_TYPES))
    direction = _direction(grid, name, pair)
    first, second, towards = pair.first, pair.second, direction
    if sweep.step_of(grid.intersection(*first)) > sweep.step_of(grid.intersection(*second)):
        first, second, towards, table = second, first, OPPOSITE[direction], table.T
    types = np.arange(JUNCTION_TYPES)
    sharing = [types & towards > 0, types & OPPOSITE[towards] > 0]
    fitting = [grid.possible_types(*first), grid.possible_types(*second)]
    table = np.where(fitting[0][:, None] & fitting[1], table, 0.0)
    table[sharing[0][:, None] != sharing[1]] = 0.0
    scales = table.max(axis=1)
    classes, rows = _classes(table, scales, sharing)
    top = float(scales.max()) or 1.0
    made = Link(
        sweep.step_of(grid.intersection(*first)),
        sweep.step_of(grid.intersection(*second)),
        (scales / top)[sweep.types],
        classes[sweep.types],
        rows[:, sweep.types],
    )
    return made, float(np.log(top))


def _direction(grid: Grid, name: str, pair: PairLikelihood) -> int:
    for direction in DIRECTIONS:
        dx, dy = STEP[direction]
        x, y = pair.first
        inside = 0 <= x < grid.columns and 0 <= y < grid.rows
        if inside and (x + dx, y + dy) == pair.second and grid.corridor(x, y, direction) >= 0:
            return direction
    raise EvidenceError(
        f"{name}: found junctions {list(pair.first)} and {list(pair.second)}, expected two "
        f"neighbours on a grid of {grid.columns} by {grid.rows} lines"
    )


def _classes(
    table: Floats, scales: Floats, sharing: list[NDArray[np.bool_]]
) -> tuple[Indices, Floats]:
    """The class of each type of the first junction, and a row for each class.

    The corridor's two states share the classes: half a row each.
    """
    classes = np.zeros(JUNCTION_TYPES, np.int64)
    rows: list[Floats] = [np.ones(JUNCTION_TYPES)]
    for present in (False, True):
        there = sharing[1] == present
        seen = 0
        for a in np.flatnonzero((sharing[0] == present) & (scales > 0.0)):
            row = table[a] / scales[a]
            alike = [c for c in range(seen) if _proportional(rows[c][there], row[there])]
            classes[a] = alike[0] if alike else seen
            if alike:
                continue
            if seen == len(rows):
                rows.append(np.ones(JUNCTION_TYPES))
            rows[seen][there] = row[there]
            seen += 1
    return classes, np.array(rows)


def _proportional(row: Floats, other: Floats) -> bool:
    """Whether two rows scaled to a maximum of 1 are the same, to rounding."""
    return bool((np.abs(row - other) <= ROUNDING * row).all())
