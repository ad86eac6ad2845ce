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
from simworld.settings import PersonSettings, check_place, corridor_between, corridors_of
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
    except (BuildingError, FloorPlanError, ScenarioError) as error:
        raise ScenarioError(f"{name}: {error}") from None


def _draw(scenario: Scenario) -> Drawn:
    settings = scenario.world
    rng = np.random.default_rng([scenario.seed, 0])
    corridors = corridors_of(settings, rng)
    building = build(settings.columns_m, settings.rows_m, corridors, settings.corridor_width_m)
    start, heading = _start(scenario, building, rng)
    plan = Plan(
        settings=settings,
        building=building,
        surroundings=_surroundings(scenario, building),
        start=start,
        heading=heading,
        errands=_errands(scenario, building, rng),
        people=tuple(_coming(person, building.grid, k) for k, person in enumerate(settings.person)),
    )
    facts = Facts(building.grid.columns, building.grid.rows, start, heading, settings.speed_m_s)
    return Drawn(plan, facts)


def _surroundings(scenario: Scenario, building: Building) -> Surroundings:
    """What echoes: the building's own walls, or those of a floor plan laid on its grid lines."""
    settings = scenario.world
    if settings.floor_plan is None:
        return building
    plan = read_floor_plan(Path(settings.floor_plan))
    return register(plan, settings.columns_m, settings.rows_m).plan


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


def _coming(person: PersonSettings, grid: Grid, number: int) -> Coming:
    named = person.enters.corridor
    if named is None:
        return Coming(person, None)
    key = f"world.person[{number}].enters.corridor"
    try:
        (ax, ay), (bx, by) = (tuple(map(int, end.split(","))) for end in named.split("-"))
    except ValueError:
        raise ScenarioError(f'{key}: found {named!r}, expected a pair as "0,0-1,0"') from None
    return Coming(person, corridor_between(grid, (ax, ay), (bx, by), key))
