"""Corners of ways, and the turn that makes them upright."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from simworld.survey.net import Net, Way

CORNER_RAD = math.radians(35.0)
"""Where a way turns by less than this it bends, and is still one corridor."""


def cornered(net: Net, tolerance_m: float) -> Net:
    """The net with a place at every corner of a way.

    A way is as straight as a line that it leaves by no more than the tolerance (Douglas and
    Peucker, Algorithms for the reduction of the number of points, 1973).
    """
    places, ways = dict(net.places), []
    unused = max(places, default=0) + 1
    for way in net.ways:
        corners = _corners(way.path_m, tolerance_m)
        numbers = [way.ends[0], *range(unused, unused + len(corners)), way.ends[1]]
        unused += len(corners)
        bounds = [0, *corners, len(way.path_m) - 1]
        for number, corner in zip(numbers[1:-1], corners, strict=True):
            places[number] = (float(way.path_m[corner, 0]), float(way.path_m[corner, 1]))
        for k in range(len(numbers) - 1):
            part = way.path_m[bounds[k] : bounds[k + 1] + 1]
            ways.append(Way((numbers[k], numbers[k + 1]), part))
    return Net(places, tuple(ways))


def upright_turn_rad(net: Net) -> float:
    """The turn, in [-pi/4, pi/4], that lays most of the ways' length along the axes.

    The circular mean of four times each way's direction, by length. The direction is that of the
    way's middle half: where ways meet, the skeleton bends.
    """
    fourfold = 0j
    for way in net.ways:
        quarter = len(way.path_m) // 4
        off = way.path_m[quarter : len(way.path_m) - quarter]
        (xx, xy), (_, yy) = np.cov(off.T, bias=True)
        fourfold += way.length_m * np.exp(2.0j * math.atan2(2.0 * xy, xx - yy))
    return -math.atan2(fourfold.imag, fourfold.real) / 4.0


def askew_rad(way: Way, turn_rad: float = 0.0) -> float:
    """How far the line from end to end, turned by this, is from an axis, in [0, pi/4]."""
    across = way.path_m[-1] - way.path_m[0]
    return abs(math.remainder(math.atan2(across[1], across[0]) + turn_rad, math.pi / 2.0))


def runs_east(way: Way) -> bool:
    """Whether it runs rather along the rows than along the columns."""
    across = np.abs(way.path_m[-1] - way.path_m[0])
    return bool(across[0] >= across[1])


def _corners(path_m: NDArray[np.float64], tolerance_m: float) -> list[int]:
    """Indices of the points where a path turns."""
    kept = _reduced(path_m, 0, len(path_m) - 1, tolerance_m)
    while True:
        bends = [k for k in range(1, len(kept) - 1) if _turn_rad(path_m, kept, k) < CORNER_RAD]
        if not bends:
            return kept[1:-1]
        slightest = min(bends, key=lambda k: _turn_rad(path_m, kept, k))
        del kept[slightest]


def _turn_rad(path_m: NDArray[np.float64], kept: list[int], k: int) -> float:
    before, at, after = (path_m[kept[k + step]] for step in (-1, 0, 1))
    (ax, ay), (bx, by) = at - before, after - at
    return abs(math.remainder(math.atan2(by, bx) - math.atan2(ay, ax), 2.0 * math.pi))


def _reduced(path_m: NDArray[np.float64], first: int, last: int, tolerance_m: float) -> list[int]:
    """First, last and what lies between and is needed to stay within the tolerance."""
    kept, open_parts = [first, last], [(first, last)]
    while open_parts:
        a, b = open_parts.pop()
        off_m = _off_line(path_m[a : b + 1])
        farthest = int(off_m.argmax())
        if off_m[farthest] > tolerance_m:
            kept.append(a + farthest)
            open_parts += [(a, a + farthest), (a + farthest, b)]
    return sorted(kept)


def _off_line(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Distance of points from the line between the first and last, or from both where equal."""
    along = points[-1] - points[0]
    length_m = math.hypot(*along)
    away = points - points[0]
    if length_m < 1e-9:
        off: NDArray[np.float64] = np.linalg.norm(away, axis=1)
        return off
    crossed: NDArray[np.float64] = np.abs(away[:, 0] * along[1] - away[:, 1] * along[0])
    return crossed / length_m
