"""Made-up floor plans: corridors on grid lines, turned, with door stubs and noise."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bus.grid import Grid
from simworld.floor_plan import Cells, FloorPlan

Box = tuple[float, float, float, float]
"""West, south, east, north in metres."""

MARGIN_M = 3.0


def corridor_boxes(
    columns_m: Sequence[float],
    rows_m: Sequence[float],
    corridors: NDArray[np.uint8],
    width_m: float,
) -> list[Box]:
    """The free space of each corridor of a map, with the junctions at its ends."""
    grid = Grid(len(columns_m), len(rows_m))
    half = width_m / 2
    boxes = []
    for corridor in np.flatnonzero(corridors):
        (ax, ay), (bx, by) = (grid.place(end) for end in grid.ends(int(corridor)))
        boxes.append(
            (
                columns_m[ax] - half,
                rows_m[ay] - half,
                columns_m[bx] + half,
                rows_m[by] + half,
            )
        )
    return boxes


def drawn_plan(
    boxes: Sequence[Box],
    turn_rad: float = 0.0,
    noise: float = 0.0,
    rng: np.random.Generator | None = None,
    resolution_m: float = 0.1,
) -> FloorPlan:
    """A plan of free boxes, walls around them, all turned counter-clockwise in the world.

    ``noise`` is the share of free cells that are not free but unknown.
    """
    points = [(x, y) for w, s, e, n in boxes for x in (w, e) for y in (s, n)]
    c, s = math.cos(turn_rad), math.sin(turn_rad)
    xs = [c * x - s * y for x, y in points]
    ys = [s * x + c * y for x, y in points]
    west, south = min(xs) - MARGIN_M, min(ys) - MARGIN_M
    columns = round((max(xs) + MARGIN_M - west) / resolution_m)
    rows = round((max(ys) + MARGIN_M - south) / resolution_m)
    column, row = np.meshgrid(np.arange(columns), np.arange(rows))
    x, y = west + (column + 0.5) * resolution_m, south + (row + 0.5) * resolution_m
    u, v = c * x + s * y, c * y - s * x
    free = np.zeros(u.shape, np.bool_)
    near = np.zeros(u.shape, np.bool_)
    thick = 2 * resolution_m
    for w, s_, e, n in boxes:
        free |= (u > w) & (u < e) & (v > s_) & (v < n)
        near |= (u > w - thick) & (u < e + thick) & (v > s_ - thick) & (v < n + thick)
    walls = near & ~free
    if rng is not None:
        free &= rng.random(free.shape) >= noise
    return FloorPlan(Cells(walls, free, resolution_m), (west, south), 0.0)
