"""What the robot could do next: P_K and the candidates for P_U."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import DIRECTIONS
from modules.decider.roads import IMPROBABLE, OPEN, PLANNED, SEEN_ABSENT, Roads
from modules.decider.route_kernels import way_to_goal, ways_to
from modules.decider.situation import Situation


@dataclass(frozen=True)
class Options:
    """Ways to begin, one a row; row 0 is P_K, all others are candidates for P_U.

    P_K starts with an empty way: it goes on with the errand at once.
    """

    beliefs: NDArray[np.uint8]
    """(options, corridors): the map in use as levels, see roads.py."""
    ways: NDArray[np.int64]
    """(options, intersections): direction numbers, ended by -1."""
    known: bool
    """Whether the map in use leads to all goals, so that P_K is there to be chosen."""
    known_direction: int
    """Direction bit of P_K's first step; 0 where it stays or is not there."""

    def direction(self, option: int) -> int:
        """Direction bit of an option's first step."""
        return DIRECTIONS[self.ways[option, 0]] if option else self.known_direction


def levels_at(situation: Situation, junction_type: int) -> NDArray[np.uint8]:
    """What is known once the type at v is: one level a corridor, see roads.py.

    Its PLANNED corridors are M*, the minimal assignment consistent with what is known.
    """
    p = situation.corridor_probability
    levels = np.full(len(p), OPEN, dtype=np.uint8)
    levels[p >= situation.known_at] = PLANNED
    levels[p <= 1.0 - situation.known_at] = IMPROBABLE
    at = situation.grid.place(situation.place)
    for direction in DIRECTIONS:
        corridor = situation.grid.corridor(*at, direction)
        if corridor >= 0:
            levels[corridor] = PLANNED if junction_type & direction else SEEN_ABSENT
    return levels


def options_at(
    situation: Situation,
    roads: Roads,
    levels: NDArray[np.uint8],
    unsettled: NDArray[np.bool_],
) -> Options:
    """P_K and every candidate for P_U, given what is known and where H is undecided.

    The candidates are, in this order:

    - each unsettled intersection that the map in use reaches, alone or with at most one
      corridor more that may exist. Where there is none, any number of unknown corridors may be
      used, and only then improbable ones. The errand goes on from there with the map in use
      and what was learnt.
    - the shortest way to the first goal that is consistent with what is known, where that is
      shorter than the known one. It senses at the first unsettled intersection it meets, and
      as the paper's P_U "tries the shortest path consistent with what is known", its errand
      goes on with all that may exist assumed to be there, not with M*.
    """
    places = len(unsettled)
    beliefs, ways = [levels], [np.full((1, places), -1, dtype=np.int64)]
    candidates = np.flatnonzero(unsettled)
    looks = _nearby(roads, levels, situation.place, candidates)
    ways.append(looks)
    beliefs += [levels] * len(looks)
    known_s, known_direction = _known_way(roads, levels, situation)
    if situation.goals:
        hopeful = _hopeful(levels)
        way, seconds, _ = way_to_goal(
            roads, hopeful, situation.place, situation.goals[0], unsettled
        )
        if seconds < known_s:
            ways.append(way[np.newaxis])
            beliefs.append(hopeful)
    return Options(np.array(beliefs), np.concatenate(ways), known_s < np.inf, known_direction)


def first_step(roads: Roads, levels: NDArray[np.uint8], place: int, goal: int) -> int:
    """Direction bit of the shortest consistent path's first step to ``goal``; 0 for none.

    It serves where no hypothesis can say what to expect.
    """
    settled = np.zeros(len(roads.corridor), dtype=np.bool_)
    way, _, level = way_to_goal(roads, _hopeful(levels), place, goal, settled)
    return DIRECTIONS[way[0]] if level else 0


def some_step(situation: Situation, junction_type: int) -> int:
    """A direction bit to leave by where no plan is left: back, or else the first there is."""
    if junction_type & situation.came_from:
        return situation.came_from
    at = situation.grid.place(situation.place)
    fits = [d for d in DIRECTIONS if junction_type & d and situation.grid.corridor(*at, d) >= 0]
    return fits[0] if fits else 0


def most_options(intersections: int) -> int:
    """The most rows that :func:`options_at` can have: P_K, every other place, the hopeful way."""
    return intersections + 1


def _hopeful(levels: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The maximal assignment consistent with what is known."""
    return np.where(levels == OPEN, PLANNED, levels).astype(np.uint8)


def _nearby(
    roads: Roads, levels: NDArray[np.uint8], place: int, candidates: NDArray[np.int64]
) -> NDArray[np.int64]:
    ways = np.empty((0, len(roads.corridor)), dtype=np.int64)
    if not len(candidates):
        return ways
    for level in (PLANNED, OPEN, IMPROBABLE):
        ways = ways_to(roads, levels, level, place, candidates)
        ways = ways[ways[:, 0] >= 0]
        if len(ways):
            break
    return ways


def _known_way(roads: Roads, levels: NDArray[np.uint8], situation: Situation) -> tuple[float, int]:
    """Seconds to the current goal by the map in use, and the first step's direction bit.

    Infinite where it does not lead to all the goals; 0 seconds and no step in spare time.
    """
    settled = np.zeros(len(roads.corridor), dtype=np.bool_)
    place, legs = situation.place, []
    for goal in situation.goals:
        legs.append(way_to_goal(roads, levels, place, goal, settled))
        place = goal
    if not legs:
        return 0.0, 0
    if any(level != PLANNED for _, _, level in legs):
        return np.inf, 0
    way, seconds, _ = legs[0]
    return seconds, DIRECTIONS[way[0]]
