"""Fixed-time procedures: the cells of a decision, known before it starts (paper, section 5)."""

from __future__ import annotations

from bus.grid import Grid
from modules.decider.options import most_options

LADDER = (1, 2, 4, 8, 16, 32, 64)
"""The sizes of problem to choose from: hypotheses for each junction type at v."""


def cells_bound(
    grid: Grid, hypotheses_per_type: int, tasks: int, types: int, waypoints: int = 1
) -> int:
    """The most cells that ``decide`` can take.

    Every option needs the errand's cost under every map, a cell for each leg. Every option
    asks for one entry of the future table under every map, and no entry is reckoned twice: a
    cell for each task. ``types`` is how many junction types at v are possible. It holds when
    ``decide`` is given at most that many maps a type.
    """
    options = most_options(grid.intersections)
    immediate = hypotheses_per_type * options * max(1, waypoints)
    entries = hypotheses_per_type * min(hypotheses_per_type, options)
    return types * (immediate + entries * tasks)


def largest_that_fits(
    grid: Grid, tasks: int, types: int, cells: int, waypoints: int = 1
) -> int | None:
    """The most hypotheses per type, of :data:`LADDER`, whose bound is at most ``cells``.

    None when even the fewest do not fit.
    """
    fitting = [h for h in LADDER if cells_bound(grid, h, tasks, types, waypoints) <= cells]
    return max(fitting, default=None)
