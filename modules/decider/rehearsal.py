"""A toy decision, so that everything is compiled before anybody waits for a real one."""

from __future__ import annotations

import numpy as np

from bus.grid import Grid
from modules.decider.decision import decide
from modules.decider.situation import Situation


def rehearse(grid: Grid) -> None:
    """Decide between two maps of a grid: all corridors, and all but the last."""
    maps = np.ones((2, grid.corridors), np.uint8)
    maps[1, -1] = 0
    decide(
        Situation(
            grid=grid,
            place=0,
            came_from=0,
            waypoints=(grid.intersections - 1,),
            tasks=np.array([[0, grid.intersections - 1]], np.int64),
            expected=np.ones(1),
            maps=maps,
            weights=np.full(2, 0.5),
            log_probability=np.zeros(2),
            corridor_probability=maps.mean(axis=0),
            corridor_s=np.ones(grid.corridors),
            sensing_s=1.0,
        )
    )
