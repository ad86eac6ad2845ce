"""Floor plans from laser scans whose poses are known: an occupancy grid, and its files.

Each cell's log odds grow where a beam ends in it and fall where one passes (Moravec and Elfes,
High resolution maps from wide angle sonar, 1985; Thrun, Burgard and Fox, Probabilistic Robotics,
2005, chapter 9).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import yaml
from numba import njit
from numpy.typing import NDArray
from PIL import Image

from simworld.carmen import CarmenError, Scan, read_carmen
from simworld.floor_plan import Cells, FloorPlan

RESOLUTION_M = 0.05
"""Side of a cell, as usual for maps of offices."""

TRUSTED_M = 20.0
"""Beams are followed so far: beyond, a degree between beams and an error of the pose blur walls."""

MARGIN_M = 1.0
"""Unknown cells around all that was seen."""

PASSED, ENDED = -0.7, 1.4
"""What one beam adds to a cell's log odds: a cell in which one of three beams ends is as likely
occupied as not (assumption: beams graze the cells of a wall before they end in it)."""

OCCUPIED_ABOVE, FREE_BELOW = 0.65, 0.196
"""map_server's thresholds; two beams that passed make a cell free."""

LIMIT = 8.0
"""Log odds stay within this, so that what was moved away is forgotten in time."""

MOST_CELLS = 100_000_000

BLACK, GREY, WHITE = 0, 205, 254
"""Occupied, unknown and free in an image, as map_saver writes them."""


def plan_of_log(path: Path | str) -> FloorPlan:
    """The floor plan seen in a CARMEN log with corrected poses. Raises CarmenError."""
    scans = read_carmen(path).scans
    try:
        return plan_of_scans(scans)
    except CarmenError as error:
        raise CarmenError(f"{path}: {error}") from None


def plan_of_scans(scans: Sequence[Scan], resolution_m: float = RESOLUTION_M) -> FloorPlan:
    """The floor plan that scans at known poses show, in the frame of the poses.

    Raises CarmenError where the poses lie so far apart that no plan holds them, and where
    nothing returned a beam.
    """
    if not any(np.isfinite(scan.ranges_m).any() for scan in scans):
        raise CarmenError(f"found no echo in {len(scans)} scans, expected some")
    poses = np.array([(scan.x_m, scan.y_m, scan.heading_rad) for scan in scans])
    reach_m = TRUSTED_M + MARGIN_M
    low, high = poses[:, :2].min(axis=0) - reach_m, poses[:, :2].max(axis=0) + reach_m
    columns, rows = (math.ceil(size / resolution_m) for size in high - low)
    if columns * rows > MOST_CELLS:
        raise CarmenError(
            f"found poses {high[0] - low[0]:.0f} by {high[1] - low[1]:.0f} m apart, expected a "
            f"plan of at most {MOST_CELLS:,} cells of {resolution_m:g} m"
        )
    log_odds = np.zeros((rows, columns), np.float64)
    for scan, (x, y, heading) in zip(scans, poses, strict=True):
        _add_scan(
            log_odds,
            resolution_m,
            x - low[0],
            y - low[1],
            heading + scan.bearings_rad,
            scan.ranges_m,
        )
    return _cropped(log_odds, low, resolution_m)


def _cropped(
    log_odds: NDArray[np.float64], low: NDArray[np.float64], resolution_m: float
) -> FloorPlan:
    """The plan with a margin around what was seen."""
    margin = round(MARGIN_M / resolution_m)
    bounds = []
    for axis in (1, 0):
        seen = np.flatnonzero(log_odds.any(axis=axis))
        bounds.append((max(0, int(seen[0]) - margin), int(seen[-1]) + margin + 1))
    (south, north), (west, east) = bounds
    probability = 1.0 / (1.0 + np.exp(-log_odds[south:north, west:east]))
    cells = Cells(probability > OCCUPIED_ABOVE, probability < FREE_BELOW, resolution_m)
    origin_m = float(low[0]) + west * resolution_m, float(low[1]) + south * resolution_m
    return FloorPlan(cells, origin_m, 0.0)


@njit(cache=True)
def _add_scan(
    log_odds: NDArray[np.float64],
    resolution: float,
    x: float,
    y: float,
    angles: NDArray[np.float64],
    ranges: NDArray[np.float64],
) -> None:
    """Follow each beam from cell to cell (Amanatides and Woo, 1987) to where it ends."""
    rows, columns = log_odds.shape
    for beam in range(len(angles)):
        far = min(ranges[beam], TRUSTED_M) if ranges[beam] > 0.0 else TRUSTED_M
        c, s = math.cos(angles[beam]), math.sin(angles[beam])
        column, row = math.floor(x / resolution), math.floor(y / resolution)
        right, up = (1 if c >= 0.0 else -1), (1 if s >= 0.0 else -1)
        next_x = ((column + (right > 0)) * resolution - x) / c if c != 0.0 else np.inf
        next_y = ((row + (up > 0)) * resolution - y) / s if s != 0.0 else np.inf
        step_x = resolution / abs(c) if c != 0.0 else np.inf
        step_y = resolution / abs(s) if s != 0.0 else np.inf
        # A beam that never returned says nothing of what it passed.
        while ranges[beam] > 0.0 and 0 <= row < rows and 0 <= column < columns:
            ends = min(next_x, next_y) > far
            change = ENDED if ends and ranges[beam] <= TRUSTED_M else PASSED
            log_odds[row, column] = min(max(log_odds[row, column] + change, -LIMIT), LIMIT)
            if ends:
                break
            if next_x < next_y:
                next_x, column = next_x + step_x, column + right
            else:
                next_y, row = next_y + step_y, row + up


def write_floor_plan(plan: FloorPlan, path: Path) -> None:
    """Write a plan as map_server reads it: the YAML file, and a PGM image beside it.

    Raises OSError.
    """
    cells = plan.cells
    grey = np.where(cells.occupied, BLACK, np.where(cells.free, WHITE, GREY)).astype(np.uint8)
    image = path.with_suffix(".pgm")
    Image.fromarray(grey[::-1]).save(image)
    keys = {
        "image": image.name,
        "resolution": cells.resolution_m,
        "origin": [*map(float, plan.origin_m), float(plan.turn_rad)],
        "negate": 0,
        "occupied_thresh": OCCUPIED_ABOVE,
        "free_thresh": FREE_BELOW,
    }
    path.write_text(yaml.safe_dump(keys, sort_keys=False), encoding="utf-8")
