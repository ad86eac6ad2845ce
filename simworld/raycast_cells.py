"""Compiled geometry of sonar among the cells of a floor plan: what each cone hears first.

Rays are cast a degree apart, and one along each edge that hides something. Lengths are metres,
angles radians counter-clockwise from the rows.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

from simworld.raycast import ANGLE_SLACK, disc_range, wrapped

RAYS_PER_TURN = 360
"""The first ray lies on the first axis, so that axes whole degrees apart have rays."""

EDGE_M = 0.3
"""Where the next ray's hit is this much farther, the end of a wall is looked for between them."""

HALVINGS = 5
"""Times that the degree is halved in that search: 6 mm are left at 10.7 m."""


@njit(cache=True)
def _march(
    occupied: NDArray[np.bool_], resolution: float, x: float, y: float, angle: float, far: float
) -> tuple[float, int, int]:
    """Where a ray enters its first occupied cell: distance, row, column; inf for none.

    Steps from cell to cell (Amanatides and Woo, A fast voxel traversal algorithm, 1987).
    """
    rows, columns = occupied.shape
    c, s = math.cos(angle), math.sin(angle)
    column, row = math.floor(x / resolution), math.floor(y / resolution)
    right, up = (1 if c >= 0.0 else -1), (1 if s >= 0.0 else -1)
    next_x = ((column + (right > 0)) * resolution - x) / c if c != 0.0 else np.inf
    next_y = ((row + (up > 0)) * resolution - y) / s if s != 0.0 else np.inf
    step_x = resolution / abs(c) if c != 0.0 else np.inf
    step_y = resolution / abs(s) if s != 0.0 else np.inf
    distance = 0.0
    while distance <= far and 0 <= row < rows and 0 <= column < columns:
        if occupied[row, column]:
            return distance, row, column
        if next_x < next_y:
            distance, next_x, column = next_x, next_x + step_x, column + right
        else:
            distance, next_y, row = next_y, next_y + step_y, row + up
    return np.inf, -1, -1


@njit(cache=True)
def _reflects(normal: float, angle: float, specular: float) -> bool:
    """Whether a wall with this normal (modulo a half turn, nan for diffuse) returns this ray."""
    incidence = abs(wrapped(2.0 * (angle - normal))) / 2.0
    return math.isnan(normal) or incidence <= specular


@njit(cache=True)
def _ray_to_people(people: NDArray[np.float64], x: float, y: float, angle: float) -> float:
    """Distance along a ray to the first person, inf for none."""
    found = np.inf
    for p in range(len(people)):
        dx, dy = people[p, 0] - x, people[p, 1] - y
        away = math.sqrt(dx * dx + dy * dy)
        off = abs(wrapped(math.atan2(dy, dx) - angle))
        if away <= people[p, 2] or (off < math.pi / 2.0 and away * math.sin(off) <= people[p, 2]):
            found = min(found, disc_range(away, off, people[p, 2]))
    return found


@njit(cache=True)
def _edge(
    occupied: NDArray[np.bool_],
    resolution: float,
    x: float,
    y: float,
    near_angle: float,
    far_angle: float,
    between: float,
    far: float,
) -> tuple[float, float, int, int]:
    """The last ray before an edge: its angle, distance, row, column.

    The ray at ``near_angle`` meets something nearer than ``between``, that at ``far_angle`` does
    not. At a shallow angle the hits of rays a degree apart lie so far apart on a wall that its
    end may be missed.
    """
    distance, row, column = np.inf, -1, -1
    for _ in range(HALVINGS + 1):
        middle = (near_angle + far_angle) / 2.0
        d, r, c = _march(occupied, resolution, x, y, middle, far)
        if d < between:
            near_angle, distance, row, column = middle, d, r, c
        else:
            far_angle = middle
    return near_angle, distance, row, column


@njit(cache=True)
def _hear(
    ranges: NDArray[np.float64],
    axes: NDArray[np.float64],
    half: float,
    angle: float,
    distance: float,
) -> None:
    for i in range(len(axes)):
        if distance < ranges[i] and abs(wrapped(angle - axes[i])) <= half:
            ranges[i] = distance


@njit(cache=True)
def hear_cells(
    occupied: NDArray[np.bool_],
    normals: NDArray[np.float32],
    resolution: float,
    people: NDArray[np.float64],
    x: float,
    y: float,
    axes: NDArray[np.float64],
    half_angle: float,
    specular: float,
    far: float,
) -> NDArray[np.float64]:
    """Range of the nearest echo in each cone, inf for none within ``far`` and a cell.

    ``occupied``, ``normals`` (rows, columns) as in :class:`simworld.floor_plan.Cells`; (x, y) and
    ``people`` (p, 3: x, y, radius) in the image's frame. A cell returns a ray that comes within
    ``specular`` of its normal, and any ray if it has no normal; all cells hide what is behind.
    """
    half = half_angle + ANGLE_SLACK
    step = 2.0 * math.pi / RAYS_PER_TURN
    ranges = np.full(len(axes), np.inf)
    last = _march(occupied, resolution, x, y, axes[0] - step, far)
    for j in range(RAYS_PER_TURN):
        angle = axes[0] + j * step
        this = _march(occupied, resolution, x, y, angle, far)
        person = _ray_to_people(people, x, y, angle)
        if person < min(this[0], far):
            _hear(ranges, axes, half, angle, person)
        elif this[1] >= 0 and _reflects(normals[this[1], this[2]], angle, specular):
            _hear(ranges, axes, half, angle, this[0])
        nearer, near, beyond = this, angle, angle - step
        if last[0] < this[0]:
            nearer, near, beyond = last, angle - step, angle
        between = nearer[0] + EDGE_M
        # An edge beside a cell that returns any ray has been heard with that cell.
        if between < max(this[0], last[0]) and not math.isnan(normals[nearer[1], nearer[2]]):
            at, d, row, column = _edge(occupied, resolution, x, y, near, beyond, between, far)
            if row >= 0 and _reflects(normals[row, column], at, specular):
                _hear(ranges, axes, half, at, d)
        last = this
    return ranges
