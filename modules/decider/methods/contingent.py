"""A method's next corridor for every junction type that may be found at v."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bus.grid import DIRECTIONS, JUNCTION_TYPES, Maps
from modules.decider.hypotheses import by_junction_type
from modules.decider.methods.journey import random_step
from modules.decider.methods.ways import Method, best_way, corridor_weights
from modules.decider.options import levels_at, some_step
from modules.decider.roads import PLANNED, Roads, roads_of
from modules.decider.situation import Decision, Situation

Hypotheses = tuple[Maps, NDArray[np.float64]]


def decide_by_method(situation: Situation, method: Method, rng: np.random.Generator) -> Decision:
    """The first step of the method's best way to the current goal, for each junction type at v.

    The hypotheses of a type are those of the paper's model (:func:`by_junction_type`), none for
    a type that no map has. In spare time the robot stays. ``explores`` says whether the way has
    an unknown corridor. ``known_s`` is the length of the shortest known way, ``unknown_s`` that
    of the way chosen if it is not known, as if it were there: no expectations, which these
    methods do without. A cell for each map's corridors, and two a corridor for each type's way.
    """
    roads = roads_of(situation.grid, situation.corridor_s)
    direction = np.zeros(JUNCTION_TYPES, dtype=np.uint8)
    known_s = np.full(JUNCTION_TYPES, np.inf)
    unknown_s = np.full(JUNCTION_TYPES, np.inf)
    found = by_junction_type(situation, roads, None) if situation.goals else {}
    if situation.goals:
        for t in range(JUNCTION_TYPES):
            hypotheses = (found[t].maps, found[t].weights) if t in found else _none(situation)
            step = _step(situation, roads, t, hypotheses, method, rng)
            direction[t], known_s[t], unknown_s[t] = step
    maps = sum(len(h.maps) for h in found.values())
    cells = (maps + 2 * JUNCTION_TYPES) * situation.grid.corridors
    return Decision(direction, known_s, unknown_s, unknown_s < np.inf, cells, maps)


def hypotheses_at(situation: Situation, roads: Roads, junction_type: int) -> Hypotheses:
    """The maps, and their probabilities, that remain if v has a junction type."""
    found = by_junction_type(situation, roads, None)
    if junction_type not in found:
        return _none(situation)
    return found[junction_type].maps, found[junction_type].weights


def _none(situation: Situation) -> Hypotheses:
    return np.empty((0, situation.grid.corridors), np.uint8), np.empty(0)


def _step(
    situation: Situation,
    roads: Roads,
    junction_type: int,
    hypotheses: Hypotheses,
    method: Method,
    rng: np.random.Generator,
) -> tuple[int, float, float]:
    """Direction bit, seconds of the known way, and of the way chosen if that is not known."""
    levels = levels_at(situation, junction_type)
    place, goal = situation.place, situation.goals[0]
    planned = (levels == PLANNED).astype(float)
    known_s = best_way(roads, "shortest", levels, planned, place, goal).seconds
    if method == "random":
        back = DIRECTIONS.index(situation.came_from) if situation.came_from else -1
        steps, taken_s = [random_step(roads, levels, place, back, rng)], np.inf
    else:
        way = best_way(roads, method, levels, corridor_weights(levels, *hypotheses), place, goal)
        steps, taken_s = [*way.steps, -1], np.inf if way.known else way.seconds
    bit = DIRECTIONS[steps[0]] if steps[0] >= 0 else some_step(situation, junction_type)
    return bit, known_s, taken_s
