"""Laser scans of a real robot as readings of a ring of sonars.

A detector pings with a whole ring from its vantage. A log has scans of half a circle from where
the robot went by. So a ring's reading is put together: what a scan near the vantage saw, as seen
from there, and for the half that it did not see the nearest scan that looked the other way.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from simworld.carmen import Scan

TRANSDUCERS = 24
HALF_CONE_RAD = math.radians(7.5)
"""Cones of 15 degrees side by side: a laser's beam, unlike sound, comes back from a wall at any
angle, so wider cones would hear the walls beside everything."""

FARTHEST_M = 10.7
"""What the simulated ring hears (:class:`simworld.sonar.SonarRing`)."""


def ring_readings(
    scans: Sequence[Scan], x_m: float, y_m: float, heading_rad: float, within_m: float = 1.0
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Readings at a pose from the scans that were taken within this distance of it.

    Returns ranges (scans, transducers) in metres, nan where nothing is heard within
    ``FARTHEST_M``, and whether each cone was seen at all, the same shape. Transducer i looks
    i * 15 degrees counter-clockwise from the heading. The nearest scan comes first.
    """
    near = sorted(
        (scan for scan in scans if _off_m(scan, x_m, y_m) <= within_m),
        key=lambda scan: _off_m(scan, x_m, y_m),
    )
    cones = [_cones(scan, x_m, y_m, heading_rad) for scan in near]
    ranges_m = np.full((len(near), TRANSDUCERS), np.nan)
    seen = np.zeros(ranges_m.shape, np.bool_)
    for k, first in enumerate(cones):
        for more_m, more_seen in (first, *cones):
            fill = more_seen & ~seen[k]
            ranges_m[k, fill] = more_m[fill]
            seen[k] |= fill
    return ranges_m, seen


def ring_of_scan(scan: Scan) -> NDArray[np.float64]:
    """What a ring in the place of the laser, facing as it does, hears of one scan.

    Ranges (transducers,) in metres; nan where nothing is heard within ``FARTHEST_M``, and from
    behind, where the laser does not look.
    """
    ranges_m, seen = _cones(scan, scan.x_m, scan.y_m, scan.heading_rad)
    return np.where(seen, ranges_m, np.nan)


def _off_m(scan: Scan, x_m: float, y_m: float) -> float:
    return math.hypot(scan.x_m - x_m, scan.y_m - y_m)


def _cones(
    scan: Scan, x_m: float, y_m: float, heading_rad: float
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """The nearest point of one scan in each cone from a pose, and which cones it saw."""
    angles = scan.heading_rad + scan.bearings_rad
    dx = scan.x_m + scan.ranges_m * np.cos(angles) - x_m
    dy = scan.y_m + scan.ranges_m * np.sin(angles) - y_m
    far_m, bearings = np.hypot(dx, dy), np.arctan2(dy, dx)
    axes = heading_rad + np.arange(TRANSDUCERS) * (2.0 * math.pi / TRANSDUCERS)
    in_cone = np.abs(_wrapped(bearings[:, None] - axes)) <= HALF_CONE_RAD
    in_cone &= (far_m <= FARTHEST_M)[:, None]
    nearest_m = np.where(in_cone, far_m[:, None], np.inf).min(axis=0)
    off = np.abs(_wrapped(axes - scan.heading_rad))
    seen = off <= math.pi / 2.0 - HALF_CONE_RAD
    return np.where(np.isfinite(nearest_m), nearest_m, np.nan), seen


def _wrapped(angle: NDArray[np.floating]) -> NDArray[np.float64]:
    wrapped: NDArray[np.float64] = np.remainder(angle + math.pi, 2.0 * math.pi) - math.pi
    return wrapped
