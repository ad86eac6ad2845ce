"""A world small enough for the whole decision problem: map, tests, ways and one encounter at once.

The robot has goals to visit in turn. Arriving shows an intersection's corridors, but for the
intersections that have detectors: there it may run each of these once, for its time, and hears a
yes or a no that may be wrong. Driving into a corridor that is not there costs ``wall_s`` and shows
that. In a corridor it may meet somebody, once in all, half-way: it stands aside, which takes as
long as that person makes it take, or drives back.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bus.grid import Grid, Maps
from modules.decider.roads import Roads, roads_of

ABSENT, UNKNOWN, PRESENT = 0, 1, 2
UNREAD, NO, YES = -1, 0, 1


@dataclass(frozen=True)
class Detector:
    """A test for one corridor of an intersection."""

    place: int
    direction: int
    """Direction number 0..3 = N, E, S, W."""
    seconds: float
    right: float = 0.9
    """P(yes | corridor) and P(no | no corridor)."""


@dataclass(frozen=True)
class Encounter:
    """Somebody met half-way, with a probability in each corridor driven until it happens."""

    probability: float = 0.0
    aside_s: tuple[float, ...] = (0.0,)
    """What standing aside takes, for each kind of person, equally likely and known when met."""


class Info(NamedTuple):
    """All that the robot knows, apart from where it is."""

    leg: int
    met: bool
    levels: tuple[int, ...]
    readings: tuple[int, ...]


@dataclass(frozen=True, eq=False)
class TinyWorld:
    """One problem: its maps with their prior, goals, detectors and times in seconds."""

    grid: Grid
    corridor_s: NDArray[np.float64]
    start: int
    goals: tuple[int, ...]
    detectors: tuple[Detector, ...] = ()
    wall_s: float = 60.0
    encounter: Encounter = field(default_factory=Encounter)

    @cached_property
    def maps(self) -> Maps:
        """Every connected map that joins the start and all goals, (maps, corridors)."""
        count = self.grid.corridors
        rows = np.array(np.unravel_index(np.arange(2**count), (2,) * count), dtype=np.uint8).T
        ends = [self.start, *self.goals]
        types = self.grid.junction_types(rows)
        fits = [
            self.grid.connected(row) and bool(t[ends].all())
            for row, t in zip(rows, types, strict=True)
        ]
        return rows[fits]

    @cached_property
    def roads(self) -> Roads:
        """The grid as a graph."""
        return roads_of(self.grid, self.corridor_s)

    @cached_property
    def noisy(self) -> frozenset[int]:
        """Intersections that do not show their corridors by themselves."""
        return frozenset(d.place for d in self.detectors)

    @property
    def nothing(self) -> Info:
        """What is known at the start."""
        return Info(0, False, (UNKNOWN,) * self.grid.corridors, (UNREAD,) * len(self.detectors))

    def corridor_of(self, detector: Detector) -> int:
        """The corridor that a detector tests."""
        return int(self.roads.corridor[detector.place, detector.direction])

    def weights(self, info: Info) -> NDArray[np.float64]:
        """P(map | what is known), (maps,); the prior is uniform."""
        key = (info.levels, info.readings)
        if key not in self._weights:
            self._weights[key] = self._posterior(info)
        return self._weights[key]

    @cached_property
    def _weights(self) -> dict[tuple[tuple[int, ...], tuple[int, ...]], NDArray[np.float64]]:
        return {}

    def _posterior(self, info: Info) -> NDArray[np.float64]:
        joint = np.ones(len(self.maps))
        for corridor, level in enumerate(info.levels):
            if level != UNKNOWN:
                joint *= self.maps[:, corridor] == (level == PRESENT)
        for detector, reading in zip(self.detectors, info.readings, strict=True):
            if reading != UNREAD:
                agrees = self.maps[:, self.corridor_of(detector)] == reading
                joint *= np.where(agrees, detector.right, 1.0 - detector.right)
        found: NDArray[np.float64] = joint / joint.sum()
        return found

    def unseen(self, info: Info, place: int) -> list[int]:
        """Corridors at ``place`` that are not known."""
        return [c for c, _ in self.moves(place) if info.levels[c] == UNKNOWN]

    def moves(self, place: int) -> list[tuple[int, int]]:
        """(corridor, far end) of every direction on the grid, in the order N, E, S, W."""
        return self._moves[place]

    @cached_property
    def _moves(self) -> list[list[tuple[int, int]]]:
        corridor, neighbour = self.roads.corridor.tolist(), self.roads.neighbour.tolist()
        return [
            [(corridor[p][d], neighbour[p][d]) for d in range(4) if corridor[p][d] >= 0]
            for p in range(self.grid.intersections)
        ]

    def reachable(self, info: Info, place: int) -> tuple[int, ...]:
        """Intersections joined to ``place`` by known corridors, itself included, in order."""
        found = {place}
        waiting = [place]
        while waiting:
            for corridor, other in self.moves(waiting.pop()):
                if info.levels[corridor] == PRESENT and other not in found:
                    found.add(other)
                    waiting.append(other)
        return tuple(sorted(found))


def learnt(info: Info, corridors: list[int], row: NDArray[np.uint8]) -> Info:
    """What is known once some corridors are seen as one map has them."""
    levels = list(info.levels)
    for corridor in corridors:
        levels[corridor] = PRESENT if row[corridor] else ABSENT
    return info._replace(levels=tuple(levels))
