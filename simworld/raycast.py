"""Compiled geometry of sonar among wall segments and round people: what each cone hears first.

No rays are sampled: the walls seen from a point change only at the directions of wall ends, so
one ray between two such directions finds the wall that is seen all the way between them, and the
nearest point of that wall inside a cone follows in closed form.

Lengths are metres, angles radians counter-clockwise from east. Walls may touch only at ends.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

ANGLE_SLACK = 1e-9
"""A point on the edge of a cone is inside it, whatever the rounding."""

SAME_DIRECTION = 1e-12
"""Wall ends no further apart than this count as one."""

HIDDEN_BY_M = 1e-6
"""A corner is hidden by a wall that lies more than this before it: not by its own walls."""


@njit(cache=True)
def wrapped(angle: float) -> float:
    """The same angle in [-pi, pi]."""
    return angle - 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))


@njit(cache=True)
def cast_rays(
    walls: NDArray[np.float64], x: float, y: float, angles: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """First wall that each ray from (x, y) meets, -1 for none, and its distance, inf for none."""
    hit = np.full(len(angles), -1, np.int64)
    distance = np.full(len(angles), np.inf)
    for i in range(len(angles)):
        c, s = math.cos(angles[i]), math.sin(angles[i])
        for k in range(len(walls)):
            px, py = walls[k, 0] - x, walls[k, 1] - y
            ex, ey = walls[k, 2] - walls[k, 0], walls[k, 3] - walls[k, 1]
            cross = c * ey - s * ex
            if cross == 0.0:
                continue
            t = (px * ey - py * ex) / cross
            share = (px * s - py * c) / cross
            if 0.0 < t < distance[i] and -1e-12 <= share <= 1.0 + 1e-12:
                hit[i], distance[i] = k, t
    return hit, distance


@njit(cache=True)
def _near(walls: NDArray[np.float64], x: float, y: float, far: float) -> NDArray[np.float64]:
    """The walls that come within ``far`` of (x, y)."""
    kept = np.empty_like(walls)
    n = 0
    for k in range(len(walls)):
        ex, ey = walls[k, 2] - walls[k, 0], walls[k, 3] - walls[k, 1]
        share = ((x - walls[k, 0]) * ex + (y - walls[k, 1]) * ey) / (ex * ex + ey * ey)
        share = min(1.0, max(0.0, share))
        dx, dy = walls[k, 0] + share * ex - x, walls[k, 1] + share * ey - y
        if dx * dx + dy * dy <= far * far:
            kept[n] = walls[k]
            n += 1
    return kept[:n]


@njit(cache=True)
def _ends(walls: NDArray[np.float64], x: float, y: float) -> NDArray[np.float64]:
    """Directions of all wall ends, increasing, the first one again (a turn on) at the end.

    Four more are among them, so that no two that follow each other are farther than a right
    angle apart, and what lies between them meets a cone in one piece.
    """
    n = len(walls)
    ends = np.empty(2 * n + 5)
    for k in range(n):
        ends[2 * k] = math.atan2(walls[k, 1] - y, walls[k, 0] - x)
        ends[2 * k + 1] = math.atan2(walls[k, 3] - y, walls[k, 2] - x)
    for k in range(4):
        ends[2 * n + k] = (k - 2) * math.pi / 2.0
    ends[: 2 * n + 4].sort()
    kept = 1
    for k in range(1, 2 * n + 4):
        if ends[k] - ends[kept - 1] > SAME_DIRECTION:
            ends[kept] = ends[k]
            kept += 1
    ends[kept] = ends[0] + 2.0 * math.pi
    return ends[: kept + 1]


@njit(cache=True)
def _foot(wall: NDArray[np.float64], x: float, y: float) -> tuple[float, float]:
    """Direction and length of the perpendicular from (x, y) to a wall's line."""
    ex, ey = wall[2] - wall[0], wall[3] - wall[1]
    depth = ((wall[0] - x) * ey - (wall[1] - y) * ex) / math.sqrt(ex * ex + ey * ey)
    direction = math.atan2(-ex, ey)
    return (direction, depth) if depth >= 0.0 else (wrapped(direction + math.pi), -depth)


@njit(cache=True)
def _window(axis: float, half: float, a: float, b: float) -> tuple[float, float]:
    """Part of the directions [a, b] inside a cone, relative to its axis; low > high for none.

    Both are less than a half turn wide, so that they meet in one piece around the axis.
    """
    middle = wrapped((a + b) / 2.0 - axis)
    return max(middle - (b - a) / 2.0, -half), min(middle + (b - a) / 2.0, half)


@njit(cache=True)
def _nearest(wanted: float, low: float, high: float) -> float:
    return min(high, max(low, wanted))


@njit(cache=True)
def _hear_wall(
    ranges: NDArray[np.float64],
    axes: NDArray[np.float64],
    half: float,
    specular: float,
    wall: NDArray[np.float64],
    x: float,
    y: float,
    a: float,
    b: float,
) -> None:
    """Echoes of the wall seen between directions a and b: its nearest point that reflects."""
    direction, depth = _foot(wall, x, y)
    for i in range(len(axes)):
        low, high = _window(axes[i], half, a, b)
        normal = wrapped(direction - axes[i])
        low, high = max(low, normal - specular), min(high, normal + specular)
        if low <= high:
            at = _nearest(normal, low, high)
            ranges[i] = min(ranges[i], depth / math.cos(at - normal))


@njit(cache=True)
def disc_range(away: float, off: float, radius: float) -> float:
    """Distance to a disc's rim along a ray that passes its centre at the angle ``off``."""
    if away <= radius:
        return 0.0
    return away * math.cos(off) - math.sqrt(max(0.0, radius**2 - (away * math.sin(off)) ** 2))


@njit(cache=True)
def _hear_person(
    ranges: NDArray[np.float64],
    axes: NDArray[np.float64],
    half: float,
    away: float,
    direction: float,
    radius: float,
    a: float,
    b: float,
    wall_direction: float,
    wall_depth: float,
) -> None:
    """Echoes of a person where they stand before the wall seen between directions a and b."""
    spread = math.pi if away <= radius else math.asin(radius / away)
    for i in range(len(axes)):
        low, high = _window(axes[i], half, a, b)
        centre = wrapped(direction - axes[i])
        low, high = max(low, centre - spread), min(high, centre + spread)
        if low <= high:
            at = _nearest(centre, low, high)
            found = disc_range(away, at - centre, radius)
            if found * math.cos(axes[i] + at - wall_direction) < wall_depth:
                ranges[i] = min(ranges[i], found)


@njit(cache=True)
def _hear_corners(
    ranges: NDArray[np.float64],
    axes: NDArray[np.float64],
    half: float,
    near: NDArray[np.float64],
    corners: NDArray[np.float64],
    x: float,
    y: float,
    far: float,
) -> None:
    """Echoes of the corners that no wall hides."""
    direction = np.empty(1)
    for k in range(len(corners)):
        dx, dy = corners[k, 0] - x, corners[k, 1] - y
        away = math.sqrt(dx * dx + dy * dy)
        if away > far:
            continue
        direction[0] = math.atan2(dy, dx)
        if cast_rays(near, x, y, direction)[1][0] < away - HIDDEN_BY_M:
            continue
        for i in range(len(axes)):
            if abs(wrapped(direction[0] - axes[i])) <= half:
                ranges[i] = min(ranges[i], away)


@njit(cache=True)
def hear_segments(
    walls: NDArray[np.float64],
    corners: NDArray[np.float64],
    people: NDArray[np.float64],
    x: float,
    y: float,
    axes: NDArray[np.float64],
    half_angle: float,
    specular: float,
    far: float,
) -> NDArray[np.float64]:
    """Range of the nearest echo in each cone, inf beyond ``far`` or for none.

    ``walls`` (n, 4) reflect within ``specular`` of their normal, ``corners`` (k, 2) and
    ``people`` (p, 3: x, y, radius) everywhere; what a wall hides does not echo. What a person
    hides may: the person is nearer in any cone that contains it. ``axes`` (m,) are the cones'
    directions.
    """
    half = half_angle + ANGLE_SLACK
    ranges = np.full(len(axes), np.inf)
    near = _near(walls, x, y, far)
    ends = _ends(near, x, y)
    seen, _ = cast_rays(near, x, y, (ends[1:] + ends[:-1]) / 2.0)
    for k in range(len(seen)):
        normal, depth = 0.0, np.inf
        if seen[k] >= 0:
            normal, depth = _foot(near[seen[k]], x, y)
            _hear_wall(ranges, axes, half, specular, near[seen[k]], x, y, ends[k], ends[k + 1])
        for p in range(len(people)):
            dx, dy = people[p, 0] - x, people[p, 1] - y
            _hear_person(
                ranges, axes, half, math.sqrt(dx * dx + dy * dy), math.atan2(dy, dx),
                people[p, 2], ends[k], ends[k + 1], normal, depth,
            )  # fmt: skip
    _hear_corners(ranges, axes, half, near, corners, x, y, far)
    for i in range(len(ranges)):
        if ranges[i] > far:
            ranges[i] = np.inf
    return ranges
