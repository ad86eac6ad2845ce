"""From a scenario and its seed to the world of one run, and to what the robot knows of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from bus.facts import Facts
from bus.grid import DIRECTIONS, OPPOSITE, Grid
from scenarios.scenario import Scenario, ScenarioError
from simworld.building import Building, BuildingError, build
from simworld.encounters import Coming
from simworld.errands import Errand
from simworld.floor_plan import FloorPlanError, read_floor_plan
from simworld.registration import register
from simworld.settings import (
    PersonSettings,
    WorldSettings,
    check_place,
    corridor_between,
    corridors_of,
)
from simworld.sonar import Surroundings
from simworld.world import DIRECTION, Plan


@dataclass(frozen=True, eq=False)
class Drawn:
    """One run's world and the facts that its robot begins with."""

    plan: Plan
    facts: Facts


def draw(scenario: Scenario, name: str) -> Drawn:
    """Draw the world of a scenario with its seed. Raises ScenarioError beginning with ``name``."""
    try:
        return _draw(scenario)
    except (BuildingError, ScenarioError) as error:
        raise ScenarioError(f"{name}: {error}") from None


def _draw(scenario: Scenario) -> Drawn:
    settings = scenario.world
    rng = np.random.default_rng([scenario.seed, 0])
    building = _building(settings, rng)
    start, heading = _start(scenario, building, rng)
    plan = Plan(
        settings=settings,
        building=building,
        surroundings=_surroundings(scenario, building),
        start=start,
        heading=heading,
        errands=_errands(scenario, building, rng),
        people=tuple(_coming(person, building, k) for k, person in enumerate(settings.person)),
    )
    facts = Facts(building.grid.columns, building.grid.rows, start, heading, settings.speed_m_s)
    return Drawn(plan, facts)


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
        return build(settings.columns_m, settings.rows_m, corridors, settings.corridor_width_m)
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


def _surroundings(scenario: Scenario, building: Building) -> Surroundings:
    """What echoes: the building's own walls, or those of a floor plan laid on its grid lines."""
    settings = scenario.world
    if settings.floor_plan is None:
        return building
    try:
        plan = read_floor_plan(Path(settings.floor_plan))
        return register(plan, settings.columns_m, settings.rows_m).plan
    except FloorPlanError as error:
        raise ScenarioError(f"world.floor_plan: {error}") from None


def _junctions(building: Building) -> NDArray[np.int64]:
    types = building.grid.junction_types(building.corridors[None, :])[0]
    return np.flatnonzero(types)


def _start(scenario: Scenario, building: Building, rng: np.random.Generator) -> tuple[int, int]:
    """The first LDP and the heading it is entered by."""
    settings = scenario.world.start
    grid = building.grid
    if settings == "anywhere":
        place = int(rng.choice(_junctions(building)))
        x, y = grid.place(place)
        behind = [d for d in DIRECTIONS if building.truth_type(x, y) & d]
        return place, OPPOSITE[int(rng.choice(behind))]
    check_place(grid, settings.junction, "world.start.junction")
    heading = DIRECTION[settings.heading]
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


def _errands(
    scenario: Scenario, building: Building, rng: np.random.Generator
) -> tuple[Errand, ...]:
    grid, junctions = building.grid, _junctions(building)
    if scenario.random_errands is not None:
        wanted = scenario.random_errands
        pairs = [rng.choice(junctions, 2, replace=False) for _ in range(wanted.count)]
        return tuple(Errand(int(a), int(b), wanted.expected_again) for a, b in pairs)
    errands = []
    for k, errand in enumerate(scenario.errand):
        for key, place in (("from", errand.start), ("to", errand.goal)):
            check_place(grid, place, f"errand[{k}].{key}")
            if grid.intersection(*place) not in junctions:
                raise ScenarioError(
                    f"errand[{k}].{key}: found {list(place)}, where no corridor leads, "
                    f"expected a junction of the building"
                )
        a, b = grid.intersection(*errand.start), grid.intersection(*errand.goal)
        errands.append(Errand(a, b, errand.expected_again))
    return tuple(errands)


def _coming(person: PersonSettings, building: Building, number: int) -> Coming:
    named = person.enters.corridor
    if named is None:
        return Coming(person, None)
    key = f"world.person[{number}].enters.corridor"
    try:
        (ax, ay), (bx, by) = (tuple(map(int, end.split(","))) for end in named.split("-"))
    except ValueError:
        raise ScenarioError(f'{key}: found {named!r}, expected a pair as "0,0-1,0"') from None
    corridor = corridor_between(building.grid, (ax, ay), (bx, by), key)
    if not building.corridors[corridor]:
        raise ScenarioError(f"{key}: found {named!r}, expected a corridor of the building")
    return Coming(person, corridor)
