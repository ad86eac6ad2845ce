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

EDGE_CELLS = 16.0
"""Where the distance jumps by more than this a wall ends, and its end echoes, though the rays, far
apart on a wall seen aslant, may miss the cells there. A wall that does not run along the rows has
steps of one cell: seen at 3.6 degrees or more they hide no more than this."""

HALVINGS = 5
"""Times that the degree is halved to find such an end: 6 mm are left at 10.7 m."""


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
def _incidence(normal: float, angle: float) -> float:
    """Angle between a ray and a normal that is known modulo a half turn; nan for no normal."""
    return abs(wrapped(2.0 * (angle - normal))) / 2.0


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
    near: tuple[float, float],
    beyond: tuple[float, float],
    far: float,
) -> tuple[float, float, float]:
    """Where the distance jumps between two rays (angle, distance): angle, distance, the jump."""
    near_angle, nearer = near
    far_angle, farther = beyond
    between = (nearer + farther) / 2.0
    for _ in range(HALVINGS):
        middle = (near_angle + far_angle) / 2.0
        met = min(far, _march(occupied, resolution, x, y, middle, far)[0])
        if met < between:
            near_angle, nearer = middle, met
        else:
            far_angle, farther = middle, met
    return near_angle, nearer, farther - nearer


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
    ``specular`` of its normal, and any ray if it has no normal; so does the end of a wall that
    hides something farther. All cells hide what is behind.
    """
    half = half_angle + ANGLE_SLACK
    step, edge = 2.0 * math.pi / RAYS_PER_TURN, EDGE_CELLS * resolution
    ranges = np.full(len(axes), np.inf)
    last = _march(occupied, resolution, x, y, axes[0] - step, far)
    for j in range(RAYS_PER_TURN):
        angle = axes[0] + j * step
        this = _march(occupied, resolution, x, y, angle, far)
        person = _ray_to_people(people, x, y, angle)
        if person < min(this[0], far):
            _hear(ranges, axes, half, angle, person)
        elif this[1] >= 0:
            incidence = _incidence(normals[this[1], this[2]], angle)
            if math.isnan(incidence) or incidence <= specular:
                _hear(ranges, axes, half, angle, this[0])
        near, beyond = (angle, min(this[0], far)), (angle - step, min(last[0], far))
        normal = normals[this[1], this[2]]
        if last[0] < this[0]:
            near, beyond = beyond, near
            normal = normals[last[1], last[2]]
        # An end beside a cell without a normal has been heard with that cell.
        if beyond[1] - near[1] > edge and not math.isnan(normal):
            at, distance, jump = _edge(occupied, resolution, x, y, near, beyond, far)
            if jump > edge:
                _hear(ranges, axes, half, at, distance)
        last = this
    return ranges
