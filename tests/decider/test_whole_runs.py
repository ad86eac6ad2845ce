"""From an unknown 3 x 3 building to errands done: classification is perfect, driving is simple."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from bus.grid import OPPOSITE, STEP, Grid, Maps
from modules.decider import Situation, cost, decide
from tests.decider.path_reference import all_maps

GRID = Grid(3, 3)
MAPS = all_maps(GRID)
TYPES = GRID.junction_types(MAPS)


@dataclass
class Building:
    """One true map, its expected tasks (between any two LDPs), and what the robot has seen."""

    truth: NDArray[np.uint8]
    corridor_s: NDArray[np.float64]
    expected_each: float

    def __post_init__(self) -> None:
        self.types = GRID.junction_types(self.truth[np.newaxis])[0]
        self.places = np.flatnonzero(self.types).tolist()
        pairs = [(a, b) for a in self.places for b in self.places if a < b]
        self.tasks = np.array(pairs, dtype=np.int64)
        self.seen: list[int] = []

    def possible(self) -> Maps:
        """The maps that agree with all that was seen."""
        rows = np.flatnonzero((TYPES[:, self.seen] == self.types[self.seen]).all(axis=1))
        return MAPS[rows]

    def situation(self, place: int, came_from: int, waypoints: list[int], maps: Maps) -> Situation:
        n = len(maps)
        return Situation(
            grid=GRID,
            place=place,
            came_from=came_from,
            waypoints=tuple(waypoints),
            tasks=self.tasks,
            expected=np.full(len(self.tasks), self.expected_each),
            maps=maps,
            weights=np.full(n, 1 / n),
            log_probability=np.zeros(n),
            corridor_probability=self.possible().mean(axis=0),
            corridor_s=self.corridor_s,
            sensing_s=60.0,
        )

    def wasted_s(self) -> float:
        """What the tasks would take beyond their shortest paths with the map it now believes."""
        maps = [m for m in self.possible() if self._joins_all(m)]
        return sum(
            cost(GRID, self.corridor_s, (a, b), maps[0], self.truth)
            - cost(GRID, self.corridor_s, (a, b), self.truth, self.truth)
            for a, b in self.tasks.tolist()
        )

    def _joins_all(self, corridors: NDArray[np.uint8]) -> bool:
        return bool(GRID.junction_types(corridors[np.newaxis])[0][self.places].all())


def drive(
    building: Building, rng: np.random.Generator, samples: int | None, errands: int = 4
) -> int:
    """Errands, then spare time until the robot stays: how many corridors it drove.

    With ``samples``, H is drawn afresh for every decision; else it is every possible map.
    """
    place, came_from = int(rng.choice(building.places)), 0
    waypoints = rng.choice(building.places, errands).tolist()
    building.seen.append(place)
    for step in range(100):
        while waypoints and waypoints[0] == place:
            waypoints.pop(0)
        maps = building.possible()
        if samples is not None:
            maps = maps[rng.choice(len(maps), samples)]
        decision = decide(building.situation(place, came_from, waypoints, maps))
        direction = int(decision.direction[building.types[place]])
        if not direction:
            assert not waypoints
            return step
        assert direction & building.types[place]
        x, y = GRID.place(place)
        dx, dy = STEP[direction]
        place, came_from = GRID.intersection(x + dx, y + dy), OPPOSITE[direction]
        building.seen.append(place)
    raise AssertionError("it drives for ever")


def building_of(rng: np.random.Generator, expected_each: float) -> Building:
    corridor_s = rng.choice([np.full(GRID.corridors, 240.0), rng.uniform(100, 400, GRID.corridors)])
    return Building(MAPS[rng.integers(len(MAPS))], corridor_s, expected_each)


@pytest.mark.parametrize("seed", range(25))
def test_errands_end_and_expected_tasks_make_it_learn_the_map(seed: int) -> None:
    rng = np.random.default_rng(seed)
    building = building_of(rng, expected_each=50.0)
    steps = drive(building, rng, samples=None)
    # four errands and nine places: a robot that goes back and forth would take far more
    assert steps <= 40
    # what it did not learn makes no task longer
    assert building.wasted_s() == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("seed", range(25))
def test_errands_end_though_h_is_drawn_afresh_each_time(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    drive(building_of(rng, expected_each=5.0), rng, samples=24)


@pytest.mark.parametrize("seed", range(10))
def test_without_expected_tasks_spare_time_is_not_spent(seed: int) -> None:
    rng = np.random.default_rng(seed)
    building = building_of(rng, expected_each=0.0)
    assert drive(building, rng, samples=None, errands=0) == 0


def test_expecting_more_it_explores_more() -> None:
    def places_seen(expected_each: float) -> int:
        total = 0
        for seed in range(12):
            rng = np.random.default_rng(seed)
            building = building_of(rng, expected_each)
            drive(building, rng, samples=None, errands=2)
            total += len(set(building.seen))
        return total

    assert places_seen(0.0) < places_seen(0.3) < places_seen(50.0)


def test_a_step_that_teaches_nothing_lowers_the_expected_cost_by_its_corridor() -> None:
    # Why no choice repeats for ever: along seen intersections, with the same H, the value of the
    # best option falls by what was driven, or by more.
    checked = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        building = building_of(rng, expected_each=5.0)
        building.seen = rng.choice(building.places, min(4, len(building.places))).tolist()
        goal, maps = int(rng.choice(building.places)), building.possible()
        for place in building.seen:
            if place == goal:
                continue
            decision = decide(building.situation(place, 0, [goal], maps))
            here = building.types[place]
            x, y = GRID.place(place)
            direction = int(decision.direction[here])
            dx, dy = STEP[direction]
            there = GRID.intersection(x + dx, y + dy)
            if there not in building.seen or there == goal:
                continue
            after = decide(building.situation(there, OPPOSITE[direction], [goal], maps))
            driven = building.corridor_s[GRID.corridor(x, y, direction)]
            value = min(decision.known_s[here], decision.unknown_s[here])
            left = building.types[there]
            assert min(after.known_s[left], after.unknown_s[left]) <= value - driven + 1e-6
            checked += 1
    assert checked > 20
