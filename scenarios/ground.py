"""The building of a run, and where its robot begins: what follows from scenario and seed alone."""

from __future__ import annotations

from dataclasses import dataclass

import msgspec
import numpy as np
from numpy.typing import NDArray

from bus.facts import Facts, Recall, Ring
from bus.grid import DIRECTIONS, LETTER, OPPOSITE, Grid
from scenarios.recall import RecallError, likeliest, recall_of
from scenarios.scenario import Scenario, ScenarioError
from simworld.building import Building, BuildingError, build
from simworld.fittings import fitted
from simworld.settings import (
    SonarSettings,
    WorldSettings,
    check_place,
    corridors_of,
    fittings_of,
    ring_of,
)
from simworld.sonar import SonarError

_DIRECTION = {letter: direction for direction, letter in LETTER.items()}


@dataclass(frozen=True, eq=False)
class Ground:
    """A building, the first LDP and the heading it is entered by."""

    building: Building
    start: int
    heading: int
    speed_m_s: float
    ring: Ring
    wedges: int
    recall: Recall | None = None

    @property
    def facts(self) -> Facts:
        """What the robot knows of it from the beginning: where it is, or what it recalls."""
        grid = self.building.grid
        return Facts(
            grid.columns,
            grid.rows,
            self.start if self.recall is None else likeliest(self.recall),
            self.heading,
            self.speed_m_s,
            corridor_width_m=self.building.corridor_width_m,
            ring=self.ring,
            wedges=self.wedges,
            recall=msgspec.UNSET if self.recall is None else self.recall,
        )


def generator(scenario: Scenario) -> np.random.Generator:
    """What a run's world is drawn with, the ground first."""
    return np.random.default_rng([scenario.seed, 0])


def draw_ground(scenario: Scenario, rng: np.random.Generator) -> Ground:
    """Draw it. Raises ScenarioError, BuildingError."""
    building = _building(scenario.world, rng)
    start, heading = _start(scenario, building, rng)
    ring, wedges = _ring(scenario.world.sonar), scenario.sensing.wedges
    _check_false_echoes(scenario.world, ring)
    recall = _recall(scenario, building.grid, start, heading)
    return Ground(building, start, heading, scenario.world.speed_m_s, ring, wedges, recall)


def _recall(scenario: Scenario, grid: Grid, start: int, heading: int) -> Recall | None:
    if scenario.recall is None:
        return None
    try:
        return recall_of(scenario.recall, grid, start, heading)
    except RecallError as error:
        raise ScenarioError(str(error)) from None


def _ring(settings: SonarSettings) -> Ring:
    try:
        ring = ring_of(settings)
    except SonarError as error:
        raise ScenarioError(f"world.sonar: {error}") from None
    return Ring(ring.transducers, ring.half_angle_rad, ring.nearest_m, ring.farthest_m)


def _check_false_echoes(settings: WorldSettings, ring: Ring) -> None:
    for k, false_echo in enumerate(settings.false_echo):
        if max(false_echo.transducers, default=0) >= ring.transducers:
            raise ScenarioError(
                f"world.false_echo[{k}].transducers: found {max(false_echo.transducers)}, "
                f"expected 0 to {ring.transducers - 1}, one of the ring's {ring.transducers}"
            )


def _building(settings: WorldSettings, rng: np.random.Generator) -> Building:
    columns, rows = len(settings.columns_m), len(settings.rows_m)
    if not columns or not rows or columns * rows < 2:
        raise ScenarioError(
            f"world.columns_m and world.rows_m: found {columns} and {rows} lines, expected at "
            f"least one each and two intersections"
        )
    corridors = corridors_of(settings, rng)
    _check_connected(Grid(columns, rows), corridors)
    try:
        bare = build(settings.columns_m, settings.rows_m, corridors, settings.corridor_width_m)
        return fitted(bare, *fittings_of(settings, bare))
    except BuildingError as error:
        raise ScenarioError(f"world.{error}") from None


def _check_connected(grid: Grid, corridors: NDArray[np.uint8]) -> None:
    """All LDPs are connected (paper, section 3); says which corridors are not."""
    present = np.flatnonzero(corridors)
    if not present.size:
        raise ScenarioError("world.corridors: found none, expected at least one")
    reached, grew = {grid.ends(int(present[0]))[0]}, True
    while grew:
        ends = [grid.ends(int(c)) for c in present]
        more = {place for pair in ends if reached & set(pair) for place in pair} - reached
        reached, grew = reached | more, bool(more)
    apart = [a_b for a_b in ends if not reached & set(a_b)]
    if apart:
        pairs = ", ".join(f"{list(grid.place(a))}-{list(grid.place(b))}" for a, b in apart)
        raise ScenarioError(
            f"world.corridors: found {pairs} apart from {list(grid.place(min(reached)))} and what "
            f"it leads to, expected one connected building"
        )


def junctions_of(building: Building) -> NDArray[np.int64]:
    """The intersections that a corridor leads to."""
    types = building.grid.junction_types(building.corridors[None, :])[0]
    return np.flatnonzero(types)


def _start(scenario: Scenario, building: Building, rng: np.random.Generator) -> tuple[int, int]:
    """The first LDP and the heading it is entered by."""
    settings = scenario.world.start
    grid = building.grid
    if settings == "anywhere":
        place = int(rng.choice(junctions_of(building)))
        x, y = grid.place(place)
        behind = [d for d in DIRECTIONS if building.truth_type(x, y) & d]
        return place, OPPOSITE[int(rng.choice(behind))]
    check_place(grid, settings.junction, "world.start.junction")
    heading = _DIRECTION[settings.heading]
    corridor = grid.corridor(*settings.junction, OPPOSITE[heading])
    if corridor < 0 or not building.corridors[corridor]:
        raise ScenarioError(
            f"world.start: found heading {settings.heading} into {list(settings.junction)}, "
            f"expected one by which a corridor of the building leads there"
        )
    room_m = building.length_m(corridor) - building.corridor_width_m
    if settings.ahead_m > room_m:
        raise ScenarioError(
            f"world.start.ahead_m: found {settings.ahead_m:g}, expected at most the corridor's "
            f"{room_m:g} m"
        )
    return grid.intersection(*settings.junction), heading
