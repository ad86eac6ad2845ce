"""A toy decision, so that everything is compiled before anybody waits for a real one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bus.grid import JUNCTION_TYPES, Grid
from modules.decider.decision import decide
from modules.decider.methods import MethodInUse
from modules.decider.outlook import decide_by_outlook
from modules.decider.situation import Situation
from modules.decider.whereabouts import Whereabouts, decide_whereabouts


def toy(grid: Grid) -> Situation:
    """An errand across a grid with two maps: all corridors, and all but the last."""
    maps = np.ones((2, grid.corridors), np.uint8)
    maps[1, -1] = 0
    return Situation(
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


def rehearse_lost(grid: Grid) -> None:
    """Decide where to go by either of two registrations."""
    sure = toy(grid)
    unsure = replace(sure, corridor_probability=0.5 * sure.corridor_probability)
    ahead = np.full((2, JUNCTION_TYPES), 1.0 / JUNCTION_TYPES)
    decide_whereabouts(Whereabouts((sure, unsure), np.array([0.5, 0.5]), ahead), len(sure.maps))


def rehearse(grid: Grid) -> None:
    """Decide between two maps by expected value, with both models, and by a method."""
    situation = toy(grid)
    decide(situation)
    decide_by_outlook(situation, len(situation.maps))
    MethodInUse("by estimate", np.random.default_rng(0)).decide(situation)
