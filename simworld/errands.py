"""The errands of a run: where to go next, and how long it took against how long it must."""

from __future__ import annotations

import heapq
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import DIRECTIONS, STEP
from simworld.building import Building


@dataclass(frozen=True)
class Errand:
    """Carry something from one intersection to another; so many more of it are expected.

    Each second after ``due_s``, counted from the beginning of the run, costs ``late_price`` more.
    """

    start: int
    goal: int
    expected_again: float
    due_s: float | None = None
    late_price: float = 0.0


def shortest_s(building: Building, speed_m_s: float, start: int, goal: int) -> float:
    """Time of the shortest way between two intersections of the true building, in seconds.

    Driving only: no sensing, no turns. Raises ValueError if there is no way.
    """
    grid = building.grid
    queue: list[tuple[float, int]] = [(0.0, start)]
    settled: dict[int, float] = {}
    while queue:
        at_s, place = heapq.heappop(queue)
        if place == goal:
            return at_s
        if place in settled:
            continue
        settled[place] = at_s
        x, y = grid.place(place)
        for direction in DIRECTIONS:
            corridor = grid.corridor(x, y, direction)
            if corridor >= 0 and building.corridors[corridor]:
                dx, dy = STEP[direction]
                ahead = grid.intersection(x + dx, y + dy)
                drive_s = building.length_m(corridor) / speed_m_s
                heapq.heappush(queue, (at_s + drive_s, ahead))
    raise ValueError(f"no way from {grid.place(start)} to {grid.place(goal)} in this building")


@dataclass(frozen=True)
class DoneErrand:
    """An errand that was done: its number, where from and to, when it began."""

    number: int
    start: int
    goal: int
    began_ns: int
    began_at: int


class ErrandQueue:
    """The errands still to be done, in order."""

    def __init__(self, errands: tuple[Errand, ...], began_at: int) -> None:
        self._errands = errands
        self._number = 0
        self._fetched = False
        self._began_ns = 0
        self._began_at = began_at

    @property
    def left(self) -> int:
        """How many are not done."""
        return len(self._errands) - self._number

    @property
    def done(self) -> int:
        """How many are done."""
        return self._number

    @property
    def waypoint(self) -> int | None:
        """The intersection to be reached next; None where nothing is left."""
        if not self.left:
            return None
        errand = self._errands[self._number]
        return errand.goal if self._fetched else errand.start

    @property
    def due(self) -> tuple[int, float] | None:
        """When the next waypoint is due in ns, and the price of lateness.

        None where it is not the goal of an errand that has a time.
        """
        errand = self._errands[self._number] if self.left else None
        if errand is None or errand.due_s is None or self.waypoint != errand.goal:
            return None
        return round(errand.due_s * 1e9), errand.late_price

    def waypoints(self) -> NDArray[np.int64]:
        """All intersections still to be reached, the next one first."""
        goals: list[int] = []
        for k, errand in enumerate(self._errands[self._number :]):
            if k > 0 or not self._fetched:
                goals.append(errand.start)
            goals.append(errand.goal)
        merged = [g for k, g in enumerate(goals) if k == 0 or g != goals[k - 1]]
        return np.array(merged, dtype=np.int64)

    def expected(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """The errands that may come: (start, goal) rows and how many of each are expected.

        Those still in the queue count once more than their number to come.
        """
        rows = [(e.start, e.goal) for e in self._errands]
        waiting = [float(k > self._number) for k in range(len(self._errands))]
        again = [e.expected_again for e in self._errands]
        tasks = np.array(rows, dtype=np.int64).reshape(-1, 2)
        return tasks, np.add(waiting, again, dtype=np.float64)

    def reached(self, place: int, now_ns: int) -> list[DoneErrand]:
        """Take note that the robot is at an intersection; returns the errands done by that."""
        finished: list[DoneErrand] = []
        while self.left:
            errand = self._errands[self._number]
            if not self._fetched:
                if place != errand.start:
                    break
                self._fetched = True
            if place != errand.goal:
                break
            finished.append(
                DoneErrand(self._number, errand.start, errand.goal, self._began_ns, self._began_at)
            )
            self._number += 1
            self._fetched = False
            self._began_ns, self._began_at = now_ns, place
        return finished
