"""Cost(T, M_plan, M_true): what a task takes with a map that may be wrong."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bus.grid import Grid
from modules.decider.roads import roads_of
from modules.decider.value_kernels import Tasks, table_entry


def cost(
    grid: Grid,
    corridor_s: NDArray[np.float64],
    task: tuple[int, int],
    plan_map: NDArray[np.uint8],
    true_map: NDArray[np.uint8],
) -> float:
    """Seconds to go from start to goal with ``plan_map`` when ``true_map`` is the case.

    The robot follows the shortest path in the plan and learns the true corridors of every
    intersection it passes. Where its next corridor is missing it plans again: with the plan map
    corrected by what it learnt or, where that has no path, with every corridor that it did
    not see to be absent. Equally short paths go to the first of N, E, S, W. If the plan is a
    subgraph of the truth, this is the length of the plan's shortest path (paper, section 3).
    A goal that cannot be reached costs :attr:`Roads.penalty_s`, every corridor of the grid
    driven both ways. Maps have shape (corridors,), as has ``corridor_s``.
    """
    roads = roads_of(grid, corridor_s)
    places = grid.intersections
    tasks = Tasks(np.array([task[0]]), np.array([task[1]]), np.ones(1))
    return float(
        table_entry(
            roads,
            tasks,
            np.array(plan_map, dtype=np.uint8),
            np.array(true_map, dtype=np.uint8),
            np.empty((places, places)),
            np.zeros(places, dtype=np.bool_),
            np.empty(grid.corridors, dtype=np.uint8),
            np.empty(places),
        )
    )
