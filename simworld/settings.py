"""What a scenario says of the world: the [world] table and the errands, typed."""

from __future__ import annotations

from typing import Annotated, Literal, TypeAlias

import msgspec
import numpy as np
from numpy.typing import NDArray

from bus.grid import Grid
from simworld.building import BuildingError, random_connected

Positive: TypeAlias = Annotated[float, msgspec.Meta(gt=0, le=1e9)]
NotNegative: TypeAlias = Annotated[float, msgspec.Meta(ge=0, le=1e9)]
Share: TypeAlias = Annotated[float, msgspec.Meta(ge=0, le=1)]
Place: TypeAlias = tuple[int, int]
Letter: TypeAlias = Literal["N", "E", "S", "W"]


class _Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A table of a scenario: unknown keys are errors."""


class RandomCorridors(_Settings, frozen=True):
    """A random connected map, drawn with the run's seed."""

    random: Literal[True]
    density: Annotated[float, msgspec.Meta(gt=0, le=1)] = 0.6


class Start(_Settings, frozen=True):
    """Where the robot begins: in the corridor to a junction, so far before its port."""

    junction: Place
    heading: Letter
    ahead_m: Positive = 5.0


class Enters(_Settings, frozen=True):
    """When somebody steps into the robot's corridor, and how far ahead of it.

    At the first moment from ``at_s`` on at which the robot drives a corridor (``corridor``, as
    "0,0-1,0", if given) that still has so much way ahead.
    """

    at_s: NotNegative
    ahead_m: Positive = 8.0
    corridor: str | None = None


class PersonSettings(_Settings, frozen=True):
    """Somebody who walks towards the robot, or a thing put down (``walks_m_s = 0``)."""

    enters: Enters
    walks_m_s: NotNegative = 1.3
    offset_m: float = 0.0
    yields: bool = True
    appears: Literal["ahead", "left door", "right door"] = "ahead"


class SonarSettings(_Settings, frozen=True):
    """The ring, as far as a scenario may change it."""

    dropout: Share = 0.02
    cross_talk: Share = 0.01


class ErrandSettings(_Settings, frozen=True, rename={"start": "from", "goal": "to"}):
    """One errand of the queue."""

    start: Place
    goal: Place
    expected_again: NotNegative = 0.0


class RandomErrands(_Settings, frozen=True):
    """So many errands between junctions of the building, drawn with the run's seed."""

    count: Annotated[int, msgspec.Meta(ge=1, le=10_000)]
    expected_again: NotNegative = 0.0


class WorldSettings(_Settings, frozen=True):
    """The [world] table."""

    columns_m: tuple[float, ...]
    rows_m: tuple[float, ...]
    corridors: Literal["all"] | tuple[tuple[Place, Place], ...] | RandomCorridors = "all"
    corridor_width_m: Positive = 2.0
    floor_plan: str | None = None
    speed_m_s: Annotated[float, msgspec.Meta(ge=1e-3, le=10)] = 0.085
    start: Start | Literal["anywhere"] = "anywhere"
    ping_period_s: Annotated[float, msgspec.Meta(ge=0.01, le=3600)] = 2.0
    patience_s: Positive = 600.0
    until_s: Positive = 86_400.0
    person: tuple[PersonSettings, ...] = ()
    sonar: SonarSettings = SonarSettings()


def corridors_of(settings: WorldSettings, rng: np.random.Generator) -> NDArray[np.uint8]:
    """The true map: (corridors,) of 0 and 1. Raises BuildingError for a pair off the grid."""
    grid = Grid(len(settings.columns_m), len(settings.rows_m))
    if settings.corridors == "all":
        return np.ones(grid.corridors, dtype=np.uint8)
    if isinstance(settings.corridors, RandomCorridors):
        return random_connected(grid, settings.corridors.density, rng)
    present = np.zeros(grid.corridors, dtype=np.uint8)
    for k, (a, b) in enumerate(settings.corridors):
        present[corridor_between(grid, a, b, f"world.corridors[{k}]")] = 1
    return present


def corridor_between(grid: Grid, a: Place, b: Place, key: str) -> int:
    """The corridor that joins two neighbouring intersections. Raises BuildingError naming key."""
    check_place(grid, a, key)
    check_place(grid, b, key)
    ends = tuple(sorted((grid.intersection(*a), grid.intersection(*b))))
    for corridor in range(grid.corridors):
        if grid.ends(corridor) == ends:
            return corridor
    raise BuildingError(
        f"{key}: found {list(a)} to {list(b)}, expected two neighbouring intersections"
    )


def check_place(grid: Grid, place: Place, key: str) -> None:
    """Raise BuildingError if a place is not on the grid."""
    if not (0 <= place[0] < grid.columns and 0 <= place[1] < grid.rows):
        raise BuildingError(
            f"{key}: found intersection {list(place)}, expected x from 0 to {grid.columns - 1} "
            f"and y from 0 to {grid.rows - 1}"
        )
