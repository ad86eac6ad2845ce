"""From a scenario and its seed to the world of one run, and to what the robot knows of it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bus.facts import Facts
from bus.grid import LETTER
from scenarios.ground import Ground, draw_ground, generator, junctions_of
from scenarios.scenario import Scenario, ScenarioError
from simworld.building import Building, BuildingError
from simworld.carmen import CarmenError
from simworld.encounters import Coming
from simworld.errands import Errand
from simworld.floor_plan import FloorPlanError, read_floor_plan
from simworld.recording import Recording, record
from simworld.registration import register
from simworld.settings import (
    DoorSettings,
    PersonSettings,
    WorldSettings,
    check_place,
    corridor_between,
)
from simworld.sonar import Surroundings
from simworld.world import Plan


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
    rng = generator(scenario)
    ground = draw_ground(scenario, rng)
    building = ground.building
    plan = Plan(
        settings=settings,
        building=building,
        surroundings=_surroundings(scenario, building),
        start=ground.start,
        heading=ground.heading,
        errands=_errands(scenario, building, rng),
        people=_coming(settings, building),
        recording=_recording(settings, ground),
        lost=ground.recall is not None,
    )
    return Drawn(plan, ground.facts)


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


def _recording(settings: WorldSettings, ground: Ground) -> Recording | None:
    """A real robot's log on the building's grid lines, if one is to be played back."""
    if settings.carmen is None:
        return None
    try:
        recording = record(settings.carmen, ground.building)
    except CarmenError as error:
        raise ScenarioError(f"world.carmen: {error}") from None
    grid, first = ground.building.grid, recording.stops[1:2]
    for stop in first:
        if (stop.place, stop.heading) != (ground.start, ground.heading):
            raise ScenarioError(
                f"world.start: found junction {list(grid.place(ground.start))}, heading "
                f"{LETTER[ground.heading]}, expected {list(grid.place(stop.place))}, heading "
                f"{LETTER[stop.heading]}, to which the robot of {settings.carmen} comes first"
            )
    return recording


def _errands(
    scenario: Scenario, building: Building, rng: np.random.Generator
) -> tuple[Errand, ...]:
    grid, junctions = building.grid, junctions_of(building)
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
        errands.append(Errand(a, b, errand.expected_again, errand.due_s, errand.late_price))
    return tuple(errands)


def _coming(settings: WorldSettings, building: Building) -> tuple[Coming, ...]:
    """Everybody who comes, and every door that opens."""
    who: list[tuple[str, PersonSettings | DoorSettings]] = []
    who += [(f"world.person[{k}]", person) for k, person in enumerate(settings.person)]
    who += [(f"world.door[{k}]", door) for k, door in enumerate(settings.door)]
    return tuple(
        Coming(one, _corridor(one.enters.corridor, building, f"{key}.enters.corridor"))
        for key, one in who
    )


def _corridor(named: str | None, building: Building, key: str) -> int | None:
    """The corridor that "0,0-1,0" names."""
    if named is None:
        return None
    try:
        (ax, ay), (bx, by) = (tuple(map(int, end.split(","))) for end in named.split("-"))
    except ValueError:
        raise ScenarioError(f'{key}: found {named!r}, expected a pair as "0,0-1,0"') from None
    corridor = corridor_between(building.grid, (ax, ay), (bx, by), key)
    if not building.corridors[corridor]:
        raise ScenarioError(f"{key}: found {named!r}, expected a corridor of the building")
    return corridor
