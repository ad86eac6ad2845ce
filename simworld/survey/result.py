"""What a survey finds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from simworld.floor_plan import FloorPlan

Place: TypeAlias = tuple[int, int]
"""An intersection (x, y) of the grid, from the south-west."""

Position: TypeAlias = tuple[float, float]
"""x and y in metres."""


@dataclass(frozen=True)
class Junction:
    """An intersection that has corridors.

    ``place`` is (x, y) on the grid, ``type`` its four bits (N=1, E=2, S=4, W=8), ``at_m`` where
    the plan shows it in the upright frame, ``off_m`` how far that is from where its grid lines
    cross; both None where a corridor only passes a line, and the plan shows no junction.
    """

    place: Place
    type: int
    at_m: Position | None
    off_m: float | None


@dataclass(frozen=True)
class Corridor:
    """A corridor between two neighbouring intersections, the south or west one first."""

    ends: tuple[Place, Place]
    length_m: float
    width_m: float


@dataclass(frozen=True, eq=False)
class Survey:
    """The corridors and junctions of a plan, and the grid that they lie on.

    - ``turn_rad``: counter-clockwise about the world's origin, makes the building upright;
      ``plan`` is the plan so turned, and all positions are in its frame.
    - ``columns_m``, ``rows_m``: the grid lines, increasing.
    - ``left_out``: what looked like a way but is no corridor of the grid, in words.
    - ``paths_m``: (points, 2) each, the middle lines that the corridors were read off.
    """

    plan: FloorPlan
    turn_rad: float
    columns_m: tuple[float, ...]
    rows_m: tuple[float, ...]
    junctions: tuple[Junction, ...]
    corridors: tuple[Corridor, ...]
    left_out: tuple[str, ...]
    paths_m: tuple[NDArray[np.float64], ...]
