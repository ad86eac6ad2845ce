"""The space of a plan that the robot passes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from simworld.floor_plan import FloorPlan
from simworld.survey.doors import Door

THING_M2 = 0.5
"""Anything smaller that stands in free space is furniture, or noise of the map: it is no wall."""

BESIDE_DOOR_M = (0.5, 0.75, 1.0, 1.25, 1.5)
"""How far from a door is looked for what lies beside it: beyond the robot's radius."""


@dataclass(frozen=True, eq=False)
class Space:
    """What the robot's centre can reach in a plan; arrays are (rows, columns) of its image.

    - ``clearances_m``: distance from each cell to the nearest wall, door or unknown cell.
    - ``passable``: bool, the largest connected part where that is more than the robot's radius.
    - ``resolution_m``: side of a cell.
    """

    clearances_m: NDArray[np.float64]
    passable: NDArray[np.bool_]
    resolution_m: float

    def clearance_m(self, u_m: float, v_m: float) -> float:
        """The clearance at a point of the image's frame, which must be on the plan."""
        rows, columns = self.passable.shape
        row = min(max(int(v_m / self.resolution_m), 0), rows - 1)
        column = min(max(int(u_m / self.resolution_m), 0), columns - 1)
        return float(self.clearances_m[row, column])


def space_of(
    plan: FloorPlan, radius_m: float, doors: Sequence[Door] = (), room_m: float = math.inf
) -> Space:
    """The space that a robot of this radius passes, doors closed. It may be empty.

    A door stays open where what lies on each side of it is longer than ``room_m``: it is a door
    within a corridor, not that of a room.
    """
    free = _without_things(plan.cells.free, THING_M2 / plan.cells.resolution_m**2)
    if doors:
        parts = _parts(_clearances_m(_closed(free, plan, doors), plan), radius_m)
        doors = [door for door in doors if _ends_at_room(parts, plan, door, room_m)]
    clearances_m = _clearances_m(_closed(free, plan, doors), plan)
    parts = _parts(clearances_m, radius_m)
    sizes = np.bincount(parts.ravel())
    sizes[0] = 0
    passable = (parts == sizes.argmax()) & (parts > 0)
    return Space(clearances_m, passable, plan.cells.resolution_m)


def _clearances_m(free: NDArray[np.bool_], plan: FloorPlan) -> NDArray[np.float64]:
    cells: NDArray[np.float64] = ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1]
    return cells * plan.cells.resolution_m


def _parts(clearances_m: NDArray[np.float64], radius_m: float) -> NDArray[np.int32]:
    """The number of the connected part that each cell belongs to, 0 for what is not passed."""
    parts: NDArray[np.int32] = ndimage.label(clearances_m > radius_m, np.ones((3, 3)))[0]
    return parts


def _ends_at_room(parts: NDArray[np.int32], plan: FloorPlan, door: Door, room_m: float) -> bool:
    """Whether a side of a closed door is no longer than a room, either way along the image."""
    boxes = ndimage.find_objects(parts)
    for part in _beside(parts, plan, door):
        rows, columns = boxes[part - 1] if part else (slice(0, 0), slice(0, 0))
        cells = max(rows.stop - rows.start, columns.stop - columns.start)
        if cells * plan.cells.resolution_m <= room_m:
            return True
    return False


def _beside(parts: NDArray[np.int32], plan: FloorPlan, door: Door) -> Iterator[int]:
    """The part on each side of a door, 0 for none."""
    (ax, ay), (bx, by) = door.from_m, door.to_m
    width_m = max(math.dist(door.from_m, door.to_m), 1e-9)
    normal = (ay - by) / width_m, (bx - ax) / width_m
    for side in (-1.0, 1.0):
        away_m = side * np.array(BESIDE_DOOR_M)
        x, y = (ax + bx) / 2.0 + normal[0] * away_m, (ay + by) / 2.0 + normal[1] * away_m
        row, column = _cells_at(plan, x, y)
        found = parts[row, column]
        yield int(found[np.flatnonzero(found)[0]]) if found.any() else 0


def _cells_at(
    plan: FloorPlan, x: NDArray[np.float64], y: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Row and column of world points, those off the plan left out."""
    rows, columns = plan.cells.free.shape
    u, v = plan.to_image(x, y)
    column = np.floor(u / plan.cells.resolution_m).astype(np.int64)
    row = np.floor(v / plan.cells.resolution_m).astype(np.int64)
    on_plan = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
    return row[on_plan], column[on_plan]


def _without_things(free: NDArray[np.bool_], cells: float) -> NDArray[np.bool_]:
    """Free space with the small islands in it filled."""
    islands, _ = ndimage.label(~np.pad(free, 1, constant_values=False), np.ones((3, 3)))
    small = np.bincount(islands.ravel()) < cells
    small[islands[0, 0]] = False  # all that is connected to the plan's margin
    small[0] = False
    filled: NDArray[np.bool_] = free | small[islands][1:-1, 1:-1]
    return filled


def _closed(free: NDArray[np.bool_], plan: FloorPlan, doors: Sequence[Door]) -> NDArray[np.bool_]:
    """Free space with doors drawn as walls."""
    closed = free.copy()
    for door in doors:
        steps = 2 + int(4 * math.dist(door.from_m, door.to_m) / plan.cells.resolution_m)
        x, y = (np.linspace(a, b, steps) for a, b in zip(door.from_m, door.to_m, strict=True))
        closed[_cells_at(plan, x, y)] = False
    return closed
