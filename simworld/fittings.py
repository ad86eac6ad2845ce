"""What a corridor has beside its walls: doorways off it, and clutter that stands in it.

Places are along a corridor from the centre of its south or west end, in metres; left is to the
north of a corridor that runs east and to the west of one that runs north.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from bus.grid import NORTH, STEP
from simworld.building import Building, BuildingError

Side: TypeAlias = Literal["left", "right"]

NEAR_M = 1e-9
"""Walls closer to a line than this lie on it."""

WAY_M = 0.3
"""Free to both sides of a corridor's centre line: the robot's radius and 5 cm. What stands in its
way, and may be met, is somebody who does not walk."""


@dataclass(frozen=True)
class Doorway:
    """A rectangular recess in a corridor's wall, its middle ``at_m`` along.

    Shallow, it is the stub before a closed door; metres deep, an open door and the room behind
    it. Its jambs are corners, which always echo.
    """

    corridor: int
    at_m: float
    side: Side
    width_m: float = 0.9
    depth_m: float = 0.15


@dataclass(frozen=True)
class Clutter:
    """A box that stands in a corridor, square to it: its middle ``at_m`` along, ``left_m`` aside.

    ``length_m`` is along the corridor, ``width_m`` across.
    """

    corridor: int
    at_m: float
    left_m: float
    length_m: float = 0.6
    width_m: float = 0.4


def fitted(
    building: Building, doorways: Sequence[Doorway] = (), clutter: Sequence[Clutter] = ()
) -> Building:
    """The building with doorways cut into its walls, and boxes put into its corridors.

    Raises BuildingError for a doorway that no uninterrupted wall of a corridor holds or that
    breaks into something else, and for a box that touches a wall or stands in one.
    """
    for k, doorway in enumerate(doorways):
        building = _with_doorway(building, doorway, f"doorway[{k}]")
    for k, box in enumerate(clutter):
        building = _with_box(building, box, f"clutter[{k}]")
    return building


def _with_doorway(building: Building, doorway: Doorway, key: str) -> Building:
    _check_size(key, width_m=doorway.width_m, depth_m=doorway.depth_m)
    along, left = _axes(building, doorway.corridor, key)
    outward = left if doorway.side == "left" else -left
    # With the free space on its left, a wall runs backwards on the left side of a corridor.
    direction = -along if doorway.side == "left" else along
    wall_m = building.corridor_width_m / 2
    middle = _at(building, doorway.corridor, doorway.at_m) + wall_m * outward
    p, q = (middle + share * doorway.width_m * direction for share in (-0.5, 0.5))
    walls = building.walls
    found = [k for k, wall in enumerate(walls) if _holds(wall, p, q)]
    if not found:
        raise BuildingError(
            f"{key}: found {doorway.at_m:g} m along on the {doorway.side}, expected a place where "
            f"an uninterrupted wall of that corridor holds {doorway.width_m:g} m"
        )
    deep = doorway.depth_m * outward
    outline = np.array([p, p + deep, q + deep, q])
    others = np.delete(walls, found[0], axis=0)
    _check_clear(others, outline, key)
    a, b = walls[found[0], :2], walls[found[0], 2:]
    new = _segments(np.array([a, *outline, b]))
    return _changed(building, np.concatenate([others, new]), outline)


def _with_box(building: Building, box: Clutter, key: str) -> Building:
    _check_size(key, length_m=box.length_m, width_m=box.width_m)
    along, left = _axes(building, box.corridor, key)
    middle = _at(building, box.corridor, box.at_m) + box.left_m * left
    ahead, aside = box.length_m / 2 * along, box.width_m / 2 * left
    # Clockwise: the free space around it is on the left of its sides.
    outline = np.array(
        [middle - ahead - aside, middle - ahead + aside, middle + ahead + aside,
         middle + ahead - aside]
    )  # fmt: skip
    if abs(box.left_m) - box.width_m / 2 < WAY_M:
        raise BuildingError(
            f"{key}.left_m: found {box.left_m:g} for a box {box.width_m:g} m wide, expected "
            f"{WAY_M:g} m free on both sides of the centre line, where the robot drives"
        )
    _check_clear(building.walls, outline, key)
    if building.clearance_m(*middle.tolist()) <= 0.0:
        raise BuildingError(f"{key}: found a box inside a wall, expected free space")
    sides = _segments(np.concatenate([outline, outline[:1]]))
    return _changed(building, np.concatenate([building.walls, sides]), outline)


def _check_size(key: str, **sizes_m: float) -> None:
    for name, size_m in sizes_m.items():
        if not (np.isfinite(size_m) and size_m > 0.0):
            raise BuildingError(f"{key}.{name}: found {size_m}, expected more than 0")


def _axes(
    building: Building, corridor: int, key: str
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Unit vectors along a corridor and to its left. Raises BuildingError if there is none."""
    if not (0 <= corridor < building.grid.corridors and building.corridors[corridor]):
        raise BuildingError(f"{key}.corridor: found {corridor}, expected one of the building")
    if corridor < building.grid.east_corridors:
        return np.array([1.0, 0.0]), np.array([0.0, 1.0])
    return np.array(STEP[NORTH], dtype=np.float64), np.array([-1.0, 0.0])


def _at(building: Building, corridor: int, at_m: float) -> NDArray[np.float64]:
    first, _ = building.grid.ends(corridor)
    along = _axes(building, corridor, "")[0]
    return np.array(building.position_m(*building.grid.place(first))) + at_m * along


def _holds(wall: NDArray[np.float64], p: NDArray[np.float64], q: NDArray[np.float64]) -> bool:
    """Whether both points lie inside a wall, p before q, and not at its ends."""
    a, b = wall[:2], wall[2:]
    length_m = float(np.hypot(*(b - a)))
    direction = (b - a) / length_m
    normal = np.array([-direction[1], direction[0]])
    off = [abs(float(normal @ (point - a))) for point in (p, q)]
    at = [float(direction @ (point - a)) for point in (p, q)]
    return max(off) < NEAR_M and NEAR_M < at[0] < at[1] < length_m - NEAR_M


def _check_clear(walls: NDArray[np.float64], outline: NDArray[np.float64], key: str) -> None:
    """Raise BuildingError where an upright rectangle touches a wall, all of which are upright."""
    low, high = outline.min(axis=0), outline.max(axis=0)
    from_m, to_m = np.minimum(walls[:, :2], walls[:, 2:]), np.maximum(walls[:, :2], walls[:, 2:])
    if ((from_m <= high + NEAR_M) & (to_m >= low - NEAR_M)).all(axis=1).any():
        raise BuildingError(
            f"{key}: found it from {low.round(3).tolist()} to {high.round(3).tolist()} m, "
            "expected a place clear of all other walls"
        )


def _segments(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.concatenate([points[:-1], points[1:]], axis=1)


def _changed(
    building: Building, walls: NDArray[np.float64], more_corners: NDArray[np.float64]
) -> Building:
    corners = np.concatenate([building.corners, more_corners])
    for array in (walls, corners):
        array.setflags(write=False)
    return replace(building, walls=walls, corners=corners)
