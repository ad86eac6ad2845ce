"""The paper's equations in plain Python: slow, by enumeration, sharing nothing with the decider."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from bus.grid import DIRECTIONS, STEP, Grid, Maps
from modules.decider import Situation

Path = tuple[int, ...]
"""Direction numbers, 0..3 = N, E, S, W."""


def all_maps(grid: Grid) -> Maps:
    """Every connected map of a small grid."""
    every = np.array(list(product((0, 1), repeat=grid.corridors)), dtype=np.uint8)
    return every[[grid.connected(m) for m in every]]


def corridor_of(grid: Grid, place: int, number: int) -> int:
    return grid.corridor(*grid.place(place), DIRECTIONS[number])


def beyond(grid: Grid, place: int, number: int) -> int:
    (x, y), (dx, dy) = grid.place(place), STEP[DIRECTIONS[number]]
    return grid.intersection(x + dx, y + dy)


def junction(grid: Grid, corridors: NDArray[np.uint8], place: int) -> int:
    present = [n for n in range(4) if (c := corridor_of(grid, place, n)) >= 0 and corridors[c]]
    return sum(DIRECTIONS[n] for n in present)


def simple_paths(
    grid: Grid, usable: set[int], place: int, goal: int, been: Path = ()
) -> Iterator[Path]:
    """All paths that visit no place twice, in the order of their direction numbers."""
    if place == goal:
        yield ()
        return
    for number in range(4):
        if corridor_of(grid, place, number) in usable:
            there = beyond(grid, place, number)
            if there not in been:
                for rest in simple_paths(grid, usable, there, goal, (*been, place)):
                    yield (number, *rest)


def corridors_on(grid: Grid, place: int, path: Path) -> list[int]:
    found = []
    for number in path:
        found.append(corridor_of(grid, place, number))
        place = beyond(grid, place, number)
    return found


def shortest(
    grid: Grid, seconds: Sequence[float], usable: set[int], place: int, goal: int
) -> Path | None:
    """The shortest path; of several the first in the order of direction numbers."""
    paths = simple_paths(grid, usable, place, goal)
    return min(
        paths,
        key=lambda p: (sum(seconds[c] for c in corridors_on(grid, place, p)), p),
        default=None,
    )


class Walk:
    """A robot with a map that may be wrong: it drives, sees, and plans again."""

    def __init__(
        self,
        grid: Grid,
        seconds: Sequence[float],
        ranks: Sequence[set[int]],
        truth: NDArray[np.uint8],
        place: int,
    ) -> None:
        self.grid, self.seconds, self.truth, self.place = grid, seconds, truth, place
        self.ranks = ranks  # plans are tried on the first set of corridors, then the second, ...
        self.present: set[int] = set()
        self.absent: set[int] = set()
        self.spent = 0.0

    def see(self) -> None:
        for number in range(4):
            c = corridor_of(self.grid, self.place, number)
            if c >= 0:
                (self.present if self.truth[c] else self.absent).add(c)

    def drive(self, path: Path) -> bool:
        """False where a corridor of the path is missing."""
        for number in path:
            self.see()
            c = corridor_of(self.grid, self.place, number)
            if not self.truth[c]:
                return False
            self.spent += self.seconds[c]
            self.place = beyond(self.grid, self.place, number)
        return True

    def go(self, goal: int) -> bool:
        """False where no plan is left."""
        while self.place != goal:
            plans = (
                shortest(
                    self.grid,
                    self.seconds,
                    (rank | self.present) - self.absent,
                    self.place,
                    goal,
                )
                for rank in self.ranks
            )
            path = next((p for p in plans if p is not None), None)
            if path is None:
                return False
            self.drive(path)
        return True


def reference_cost(
    grid: Grid,
    seconds: Sequence[float],
    task: tuple[int, int],
    plan: NDArray[np.uint8],
    truth: NDArray[np.uint8],
) -> float:
    planned = set(np.flatnonzero(plan).tolist())
    walk = Walk(grid, seconds, [planned, set(range(grid.corridors))], truth, task[0])
    return walk.spent if walk.go(task[1]) else 2.0 * sum(seconds)


class Expectations:
    """E[P_K] and E[P_U] of each candidate, given one junction type at v.

    Needs corridor times of which no two sums are equal, so that shortest paths are unique.
    """

    def __init__(self, s: Situation, junction_type: int) -> None:
        self.s, self.grid, self.seconds = s, s.grid, s.corridor_s.tolist()
        rows = self._conditioned(junction_type)
        self.maps = [s.maps[j] for j in rows]
        total = sum(s.weights[j] for j in rows)
        self.weights = [float(s.weights[j] / total) for j in rows]
        self.log_probability = [float(s.log_probability[j]) for j in rows]
        here = [corridor_of(self.grid, s.place, n) for n in range(4)]
        seen = {c for n, c in enumerate(here) if junction_type & DIRECTIONS[n]}
        p = s.corridor_probability
        elsewhere = [c for c in range(self.grid.corridors) if c not in here]
        self.minimal = seen | {c for c in elsewhere if p[c] >= s.known_at}
        self.maximal = self.minimal | {c for c in elsewhere if p[c] > 1 - s.known_at}
        self.any = self.maximal | set(elsewhere)
        self.unsettled = [
            u
            for u in range(self.grid.intersections)
            if len({junction(self.grid, m, u) for m in self.maps}) > 1
        ]
        self._costs: dict[tuple[int, int], float] = {}

    def _conditioned(self, junction_type: int) -> list[int]:
        s = self.s
        have = [
            j for j in range(len(s.maps)) if junction(s.grid, s.maps[j], s.place) == junction_type
        ]
        for places in ([*s.goals, *s.tasks.ravel().tolist()], list(s.goals), []):
            rows = [j for j in have if all(self._joined(s.maps[j], v) for v in places)]
            if rows:
                return rows
        return have

    def _joined(self, corridors: NDArray[np.uint8], place: int) -> bool:
        usable = set(np.flatnonzero(corridors).tolist())
        return (
            shortest(self.grid, self.s.corridor_s.tolist(), usable, self.s.place, place) is not None
        )

    def futures(self, plan: int, truth: int) -> float:
        if (plan, truth) not in self._costs:
            self._costs[plan, truth] = sum(
                float(e)
                * reference_cost(self.grid, self.seconds, (a, b), self.maps[plan], self.maps[truth])
                for (a, b), e in zip(self.s.tasks.tolist(), self.s.expected, strict=True)
            )
        return self._costs[plan, truth]

    def known(self) -> float:
        place = self.s.place
        for goal in self.s.goals:
            if shortest(self.grid, self.seconds, self.minimal, place, goal) is None:
                return np.inf
            place = goal
        return self._value((), self.minimal)

    def unknown(self) -> list[tuple[float, int]]:
        """(expected cost, first direction bit) of every candidate."""
        routes = [(path, self.minimal) for path in self._looks()]
        hopeful = self._hopeful()
        if hopeful is not None:
            routes.append((hopeful, self.maximal))
        return [(self._value(path, plan), DIRECTIONS[path[0]]) for path, plan in routes]

    def _looks(self) -> list[Path]:
        for usable, allowed in ((self.maximal, 1), (self.maximal, 99), (self.any, 99)):
            found = []
            for u in self.unsettled:
                paths = [
                    p
                    for p in simple_paths(self.grid, usable, self.s.place, u)
                    if len(set(corridors_on(self.grid, self.s.place, p)) - self.minimal) <= allowed
                ]
                if paths:
                    found.append(min(paths, key=self._length))
            if found:
                return found
        return []

    def _hopeful(self) -> Path | None:
        """The shortest consistent path, cut at the first unsettled place, if it is a shortcut."""
        if not self.s.goals:
            return None
        goal, best = self.s.goals[0], None
        for usable in (self.maximal, self.any):
            best = shortest(self.grid, self.seconds, usable, self.s.place, goal)
            if best is not None:
                break
        known = shortest(self.grid, self.seconds, self.minimal, self.s.place, goal)
        if best is None or (self.known() < np.inf and known is not None and best == known):
            return None
        place = self.s.place
        for step, number in enumerate(best):
            place = beyond(self.grid, place, number)
            if place in self.unsettled:
                return best[: step + 1]
        return best

    def _length(self, path: Path) -> float:
        seconds: list[float] = [
            self.seconds[c] for c in corridors_on(self.grid, self.s.place, path)
        ]
        return sum(seconds)

    def _value(self, path: Path, plan: set[int]) -> float:
        immediate, later = 0.0, 0.0
        observed: dict[tuple[int, int], list[int]] = {}
        for j, truth in enumerate(self.maps):
            walk = Walk(
                self.grid, self.seconds, [plan, self.maximal, self.any], truth, self.s.place
            )
            walk.drive(path)
            walk.see()
            at = walk.place
            observed.setdefault((at, junction(self.grid, truth, at)), []).append(j)
            look = walk.spent + (self.s.sensing_s if at in self.unsettled else 0.0)
            walk.spent = 0.0
            done = True
            for goal in self.s.goals:
                done = done and walk.go(goal)
                walk.see()
            immediate += self.weights[j] * (
                look + (walk.spent if done else 2.0 * sum(self.seconds))
            )
        for members in observed.values():
            probability = sum(self.weights[j] for j in members)
            plan_map = max(members, key=lambda j: (self.log_probability[j], -j))
            later += probability * sum(
                self.weights[j] / probability * self.futures(plan_map, j) for j in members
            )
        return immediate + later
