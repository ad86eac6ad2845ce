"""Which path, by least expected cost over the current errand and those to come.

Beside the paper's P_K and P_U (decision.py): every known way to somewhere with anything to learn
is a candidate, any number of exploratory steps may follow, and what an errand teaches serves all
later ones. Plans minimise expected cost, so information never hurts (Howard, *Information value
theory*, 1966). The planner is that of the Canadian Traveller's Problem (traveller/).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import DIRECTIONS, JUNCTION_TYPES, Grid, Maps
from modules.decider.hypotheses import Hypotheses, by_junction_type
from modules.decider.options import first_step, levels_at, some_step
from modules.decider.roads import OPEN, PLANNED, Roads, roads_of
from modules.decider.situation import Decision, Situation
from modules.decider.traveller import (
    BLOCKED,
    FREE,
    UNKNOWN,
    Errands,
    Moves,
    least_cells,
    look_ahead_over,
)
from modules.decider.traveller.way_kernels import cheapest_step, is_news, shortest
from modules.decider.traveller.world_kernels import clairvoyant

WORLDS = (1, 2, 4, 8, 16, 32, 64)
"""The sizes of problem to choose from: maps for each junction type at v."""

DEPTH = 2
"""Cells for looking ahead, in what comparing all next moves takes at most."""


@dataclass(frozen=True, eq=False)
class Outlook:
    """A decision, and what each way out costs where each type is true."""

    decision: Decision
    leaving_s: NDArray[np.float64]
    """(16, 4): expected cost of leaving v by each of DIRECTIONS and going on at best, or at most
    that: there, back and the best of all; nan where no map has the type, infinite where the type
    has no such way."""


def decide_by_outlook(situation: Situation, worlds_per_type: int) -> Outlook:
    """Choose the next corridor for each junction type at v by the least expected cost found.

    For each type that a map has, the maps of :func:`by_junction_type`, at most
    ``worlds_per_type``, are the worlds of :func:`look_ahead_over`. A corridor counts as known by
    the situation's ``known_at``; maps that differ there count as if they did not, and those that
    then lead nowhere are left out. The errands are those of :func:`errands_of`.

    ``known_s`` is the expected cost of going to the goal by known corridors first, ``unknown_s``
    the least of all other moves; each is infinite where there is none, or where every one would
    take longer than the best plan even if it then saw the whole map. A type without maps gets
    the first step of the shortest way that may exist.

    Raises ValueError where nothing is left to do, or for no worlds.
    """
    if worlds_per_type < 1:
        raise ValueError(f"worlds_per_type is {worlds_per_type}, expected at least 1")
    errands = errands_of(situation)
    if not len(errands.goals):
        raise ValueError("a situation without waypoints, expected at least one elsewhere")
    roads = roads_of(situation.grid, situation.corridor_s)
    found = by_junction_type(situation, roads, worlds_per_type)
    branches = [_branch(situation, roads, errands, t, found.get(t)) for t in range(JUNCTION_TYPES)]
    decision = Decision(
        np.array([b.direction for b in branches], dtype=np.uint8),
        np.array([b.known_s for b in branches]),
        np.array([b.unknown_s for b in branches]),
        np.array([b.unknown_s < b.known_s for b in branches]),
        sum(b.cells for b in branches),
        sum(b.worlds for b in branches),
    )
    return Outlook(decision, np.array([b.leaving_s for b in branches]))


def errands_of(situation: Situation) -> Errands:
    """The current waypoints, then every task that may come, with how much each counts.

    The order of later tasks is not known: they are taken in the order given, twice. The first
    time each counts up to one, with what it teaches; the second time what is expected beyond,
    all of it with what was learnt by then. No goals where no waypoint is left.
    """
    if not situation.goals:
        return Errands(np.empty(0, np.int64), np.empty(0), situation.sensing_s)
    legs = [(goal, 1.0) for goal in situation.goals]
    expected = situation.expected.tolist()
    for counts in ([min(1.0, e) for e in expected], [max(0.0, e - 1.0) for e in expected]):
        for (start, goal), count in zip(situation.tasks.tolist(), counts, strict=True):
            if count > 0.0:
                legs += [(start, count), (goal, count)]
    goals = np.array([goal for goal, _ in legs], np.int64)
    return Errands(goals, np.array([count for _, count in legs]), situation.sensing_s)


def outlook_cells(grid: Grid, worlds_per_type: int, types: int, legs: int) -> int:
    """The most cells that :func:`decide_by_outlook` can take: a leg of a drive is one.

    ``types`` is how many junction types at v are possible, ``legs`` how many goals there are.
    """
    return types * legs * DEPTH * least_cells(grid.intersections, worlds_per_type)


def most_worlds(grid: Grid, types: int, legs: int, cells: int) -> int | None:
    """The most maps a type, of :data:`WORLDS`, that so many cells allow; None for none."""
    return max((w for w in WORLDS if outlook_cells(grid, w, types, legs) <= cells), default=None)


@dataclass(frozen=True)
class _Branch:
    """The decision for one junction type."""

    direction: int
    known_s: float = np.inf
    unknown_s: float = np.inf
    leaving_s: tuple[float, ...] = (np.nan,) * len(DIRECTIONS)
    cells: int = 0
    worlds: int = 0


def _branch(
    situation: Situation, roads: Roads, errands: Errands, junction_type: int, h: Hypotheses | None
) -> _Branch:
    known = _known(situation, junction_type)
    worlds, odds = _worlds(roads, errands, situation.place, known, h)
    if not len(worlds):
        return _Branch(_hope(situation, roads, junction_type))
    cells = DEPTH * least_cells(situation.grid.intersections, len(worlds))
    moves = look_ahead_over(roads, known, situation.place, errands, worlds, odds, cells)
    if not len(moves.to):
        return _Branch(_hope(situation, roads, junction_type))
    goal = situation.goals[0]
    first = moves.to == goal
    steps = [_step_to(roads, known, situation.place, goal, to) for to in moves.to.tolist()]
    return _Branch(
        steps[moves.best],
        _least(moves, first),
        _least(moves, ~first),
        _leaving_s(roads, known, situation.place, moves, np.array(steps)),
        moves.cells * len(errands.goals),
        len(worlds),
    )


def _known(situation: Situation, junction_type: int) -> NDArray[np.uint8]:
    """What is known once the type at v is, (corridors,), in the traveller's words."""
    levels = levels_at(situation, junction_type)
    known = np.where(levels == PLANNED, FREE, BLOCKED).astype(np.uint8)
    known[levels == OPEN] = UNKNOWN
    return known


def _worlds(
    roads: Roads, errands: Errands, place: int, known: NDArray[np.uint8], h: Hypotheses | None
) -> tuple[Maps, NDArray[np.float64]]:
    """The maps that lead to all goals, with what is known as known, and their weights."""
    if h is None:
        return np.empty((0, len(known)), np.uint8), np.empty(0)
    worlds = np.where(known == UNKNOWN, h.maps, known == FREE).astype(np.uint8)
    leads = np.ones(len(worlds), np.bool_)
    for goal in dict.fromkeys(errands.goals.tolist()):
        leads &= np.isfinite(clairvoyant(roads, worlds, goal)[:, place])
    number: dict[bytes, int] = {}
    worlds, odds = worlds[leads], h.weights[leads]
    which = [number.setdefault(world.tobytes(), len(number)) for world in worlds]
    first = np.unique(which, return_index=True)[1]
    merged = np.bincount(which, weights=odds, minlength=len(number))
    return worlds[first], np.asarray(merged, np.float64)


def _least(moves: Moves, which: NDArray[np.bool_]) -> float:
    """The least expected cost of some moves; infinite for none."""
    return float(np.min(moves.expected, where=which, initial=np.inf))


def _leaving_s(
    roads: Roads,
    known: NDArray[np.uint8],
    place: int,
    moves: Moves,
    steps: NDArray[np.int64],
) -> tuple[float, ...]:
    """What each way out of ``place`` costs: (4,). ``steps`` are the direction bits of the moves."""
    best = _least(moves, np.ones(len(steps), np.bool_))
    found = []
    for number, direction in enumerate(DIRECTIONS):
        corridor = roads.corridor[place, number]
        open_ = corridor >= 0 and known[corridor] == FREE
        back_s = best + 2.0 * float(roads.seconds[corridor]) if open_ else np.inf
        found.append(min(_least(moves, steps == direction), back_s))
    return tuple(found)


def _hope(situation: Situation, roads: Roads, junction_type: int) -> int:
    """Direction bit of the shortest way that may exist, where no map says what to expect."""
    levels = levels_at(situation, junction_type)
    direction = first_step(roads, levels, situation.place, situation.goals[0])
    return direction or some_step(situation, junction_type)


def _step_to(roads: Roads, known: NDArray[np.uint8], place: int, goal: int, to: int) -> int:
    """Direction bit of the first step of a move: no news and no goal on its way."""
    price = np.where(known == FREE, roads.seconds, np.inf)
    for vertex in range(len(roads.corridor)):
        if vertex not in (place, to) and (vertex == goal or is_news(roads, known, vertex)):
            edges = roads.corridor[vertex]
            price[edges[edges >= 0]] = np.inf
    field = np.empty(len(roads.corridor))
    shortest(roads, price, to, -1, field, np.empty(len(roads.corridor), np.int64))
    slot, _ = cheapest_step(roads, price, field, place)
    return DIRECTIONS[slot]
