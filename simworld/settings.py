"""What a scenario says of the world: the [world] table and the errands, typed."""

from __future__ import annotations

import math
from typing import Annotated, Literal, TypeAlias

import msgspec
import numpy as np
from numpy.typing import NDArray

from bus.grid import Grid
from simworld.building import Building, BuildingError, random_connected
from simworld.fittings import Clutter, Doorway, Side
from simworld.sonar import SonarRing

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
    "0,0-1,0", if given) that still has so much way ahead, with room for two abreast.
    """

    at_s: NotNegative
    ahead_m: Positive = 8.0
    corridor: str | None = None


class PersonSettings(_Settings, frozen=True):
    """Somebody who walks towards the robot, or a thing put down (``walks_m_s = 0``).

    A cart is broad (``radius_m`` of 0.35, say), slow, and does not yield.
    """

    enters: Enters
    walks_m_s: NotNegative = 1.3
    offset_m: float = 0.0
    yields: bool = True
    radius_m: Annotated[float, msgspec.Meta(gt=0, le=1.0)] = 0.25
    appears: Literal["ahead", "left door", "right door"] = "ahead"


class DoorSettings(_Settings, frozen=True):
    """A door that opens into the robot's corridor, hinged ``enters.ahead_m`` ahead."""

    enters: Enters
    side: Literal["left", "right"] = "left"
    leaf_m: Annotated[float, msgspec.Meta(gt=0, le=2.0)] = 0.8
    stays_s: NotNegative = 8.0


class FalseEchoSettings(_Settings, frozen=True):
    """Some transducers hear the pings of others for a while: too short, a ``share`` of readings.

    ``transducers`` are numbered counter-clockwise, 0 straight ahead.
    """

    at_s: NotNegative
    lasts_s: Positive = 5.0
    transducers: tuple[Annotated[int, msgspec.Meta(ge=0, le=359)], ...] = (0,)
    share: Share = 0.8


class DoorwaySettings(_Settings, frozen=True):
    """A doorway in the wall of a corridor, as in :class:`simworld.fittings.Doorway`.

    ``corridor`` is a pair of intersections; places along it are from the first of them.
    """

    corridor: tuple[Place, Place]
    at_m: NotNegative
    side: Literal["left", "right"] = "left"
    width_m: Positive = 0.9
    depth_m: Positive = 0.15


class ClutterSettings(_Settings, frozen=True):
    """A box that stands in a corridor, as in :class:`simworld.fittings.Clutter`."""

    corridor: tuple[Place, Place]
    at_m: NotNegative
    left_m: float
    length_m: Positive = 0.6
    width_m: Positive = 0.4


class SonarSettings(_Settings, frozen=True):
    """The ring; where each figure comes from says :class:`simworld.sonar.SonarRing`."""

    transducers: Annotated[int, msgspec.Meta(ge=1, le=360)] = 24
    half_angle_deg: Annotated[float, msgspec.Meta(gt=0, le=60)] = 15.0
    nearest_m: NotNegative = 0.15
    farthest_m: Positive = 10.7
    noise_share: Share = 0.01
    noise_m: NotNegative = 0.01
    specular_limit_deg: Annotated[float, msgspec.Meta(ge=0, lt=90)] = 22.5
    dropout: Share = 0.02
    cross_talk: Share = 0.01


def ring_of(settings: SonarSettings) -> SonarRing:
    """The ring of a scenario. Raises SonarError for figures that do not go together."""
    return SonarRing(
        transducers=settings.transducers,
        half_angle_rad=math.radians(settings.half_angle_deg),
        nearest_m=settings.nearest_m,
        farthest_m=settings.farthest_m,
        noise_share=settings.noise_share,
        noise_m=settings.noise_m,
        specular_limit_rad=math.radians(settings.specular_limit_deg),
        dropout=settings.dropout,
        cross_talk=settings.cross_talk,
    )


class ErrandSettings(_Settings, frozen=True, rename={"start": "from", "goal": "to"}):
    """One errand of the queue; ``due_s`` after the run's beginning, and what lateness costs."""

    start: Place
    goal: Place
    expected_again: NotNegative = 0.0
    due_s: NotNegative | None = None
    late_price: NotNegative = 0.0


class RandomErrands(_Settings, frozen=True):
    """So many errands between junctions of the building, drawn with the run's seed."""

    count: Annotated[int, msgspec.Meta(ge=1, le=10_000)]
    expected_again: NotNegative = 0.0


class WorldSettings(_Settings, frozen=True):
    """The [world] table.

    ``floor_plan`` is a map whose echoes are heard in place of those of bare corridors; ``carmen``
    the log of a real robot, played back in place of a simulated day (:mod:`simworld.playback`).
    """

    columns_m: tuple[float, ...]
    rows_m: tuple[float, ...]
    corridors: Literal["all"] | tuple[tuple[Place, Place], ...] | RandomCorridors = "all"
    corridor_width_m: Positive = 2.0
    floor_plan: str | None = None
    carmen: str | None = None
    speed_m_s: Annotated[float, msgspec.Meta(ge=1e-3, le=10)] = 0.085
    start: Start | Literal["anywhere"] = "anywhere"
    ping_period_s: Annotated[float, msgspec.Meta(ge=0.01, le=3600)] = 2.0
    patience_s: Positive = 600.0
    until_s: Positive = 86_400.0
    person: tuple[PersonSettings, ...] = ()
    door: tuple[DoorSettings, ...] = ()
    false_echo: tuple[FalseEchoSettings, ...] = ()
    doorway: tuple[DoorwaySettings, ...] = ()
    clutter: tuple[ClutterSettings, ...] = ()
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


def fittings_of(settings: WorldSettings, building: Building) -> tuple[list[Doorway], list[Clutter]]:
    """Doorways and clutter, seen from the south or west end of their corridors.

    Raises BuildingError for a pair that is no corridor of the grid.
    """
    doorways, boxes = [], []
    for k, door in enumerate(settings.doorway):
        corridor, at_m, turned = _along(building, door.corridor, door.at_m, f"doorway[{k}]")
        side = OTHER_SIDE[door.side] if turned else door.side
        doorways.append(Doorway(corridor, at_m, side, door.width_m, door.depth_m))
    for k, box in enumerate(settings.clutter):
        corridor, at_m, turned = _along(building, box.corridor, box.at_m, f"clutter[{k}]")
        left_m = -box.left_m if turned else box.left_m
        boxes.append(Clutter(corridor, at_m, left_m, box.length_m, box.width_m))
    return doorways, boxes


OTHER_SIDE: dict[str, Side] = {"left": "right", "right": "left"}


def _along(
    building: Building, pair: tuple[Place, Place], at_m: float, key: str
) -> tuple[int, float, bool]:
    """The corridor, the place along it from its first end, and whether the pair turns it about."""
    corridor = corridor_between(building.grid, *pair, f"{key}.corridor")
    turned = pair[0] != building.grid.place(building.grid.ends(corridor)[0])
    return corridor, building.length_m(corridor) - at_m if turned else at_m, turned


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
