"""Laying a floor plan onto grid lines: which turn and shift put corridors on the lines.

The paper (section 3) assumes that corridors are aligned with grid lines; a map made by a real
robot is turned and shifted as its first pose happened to be.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from simworld.floor_plan import FloorPlan, FloorPlanError

ENOUGH_CLEARANCE_M = 1.0
"""Half the paper's widest corridor: more room around a grid line makes it no better."""

POINTS_EVERY_M = 0.5
"""Spacing of the points along grid lines where clearance is looked up."""

COARSEST_M = 0.5
"""Spacing of the first shifts tried: less than the clearance that guides the search."""

FINEST_M = 0.02
"""Shifts are refined to this."""


AS_GOOD_M = 0.05
"""Less mean clearance than this, by coarse shifts, does not tell one turn from another."""


@dataclass(frozen=True)
class Registration:
    """How a plan lies on grid lines: see :func:`register`.

    ``plan`` is the moved plan: turned by ``turn_rad`` about the world's origin, then shifted by
    ``shift_m``. ``free_share`` is the share of the grid lines that is free space on it.
    """

    plan: FloorPlan
    turn_rad: float
    shift_m: tuple[float, float]
    free_share: float


def register(plan: FloorPlan, columns_m: Sequence[float], rows_m: Sequence[float]) -> Registration:
    """Turn a plan upright and shift it so that grid lines run through its free space.

    ``columns_m``, ``rows_m`` are the grid's lines as in :func:`simworld.building.build`. Tried
    are the four turns that make the walls upright, with every shift that keeps the grid inside
    the plan; the best has the greatest mean clearance along the lines, counted up to
    ``ENOUGH_CLEARANCE_M``; of those as good, as in a symmetric building, it is the least turned.
    It is then refined in turn and shift.

    Raises FloorPlanError where the grid is larger than the plan however it is turned.
    """
    points = _points_on_lines(columns_m, rows_m)
    upright = plan.upright()
    tried = [_best_shift(upright.moved(quarter * math.pi / 2.0), points) for quarter in range(4)]
    fitting = [found for found in tried if found is not None]
    if not fitting:
        rows, columns = plan.cells.free.shape
        raise FloorPlanError(
            f"found a plan of {columns} by {rows} cells of {plan.cells.resolution_m} m, "
            f"expected one large enough for columns {list(columns_m)} and rows {list(rows_m)}"
        )
    best = _refined(_least_turned(plan, fitting, points), points)
    turn_rad = math.remainder(best.turn_rad - plan.turn_rad, 2.0 * math.pi)
    turned_x, turned_y = plan.moved(turn_rad).origin_m
    return Registration(
        plan=best,
        turn_rad=turn_rad,
        shift_m=(best.origin_m[0] - turned_x, best.origin_m[1] - turned_y),
        free_share=float((best.clearance_m(points[:, 0], points[:, 1]) > 0.0).mean()),
    )


def _points_on_lines(columns_m: Sequence[float], rows_m: Sequence[float]) -> NDArray[np.float64]:
    """Points along all grid lines, (n, 2)."""
    points = [(x, y) for x in columns_m for y in _spaced(rows_m[0], rows_m[-1])]
    points += [(x, y) for y in rows_m for x in _spaced(columns_m[0], columns_m[-1])]
    return np.array(points, dtype=np.float64)


def _spaced(low: float, high: float) -> NDArray[np.float64]:
    return np.linspace(low, high, 2 + int((high - low) / POINTS_EVERY_M))


def _score(plan: FloorPlan, points: NDArray[np.float64]) -> float:
    """Mean clearance at the points, counted up to enough."""
    clearance = plan.clearance_m(points[:, 0], points[:, 1])
    return float(np.minimum(clearance, ENOUGH_CLEARANCE_M).mean())


def _least_turned(
    plan: FloorPlan, fitting: Sequence[FloorPlan], points: NDArray[np.float64]
) -> FloorPlan:
    """The best, or of those that are as good the least turned: a building may be symmetric."""
    scores = [_score(found, points) for found in fitting]
    good = [
        found
        for found, score in zip(fitting, scores, strict=True)
        if score >= max(scores) - AS_GOOD_M
    ]
    return min(
        good, key=lambda found: abs(math.remainder(found.turn_rad - plan.turn_rad, math.tau))
    )


def _best_shift(plan: FloorPlan, points: NDArray[np.float64]) -> FloorPlan | None:
    """The plan shifted as well as the coarse steps allow, or None if it does not hold the grid."""
    rows, columns = np.nonzero(plan.cells.free)
    free = np.column_stack(
        plan.to_world(
            (columns + 0.5) * plan.cells.resolution_m, (rows + 0.5) * plan.cells.resolution_m
        )
    )
    low, high = points.max(axis=0) - free.max(axis=0), points.min(axis=0) - free.min(axis=0)
    shifted = [
        plan.moved(0.0, (float(x), float(y)))
        for x in np.arange(low[0], high[0], COARSEST_M)
        for y in np.arange(low[1], high[1], COARSEST_M)
    ]
    return max(shifted, key=lambda found: _score(found, points), default=None)


def _refined(plan: FloorPlan, points: NDArray[np.float64]) -> FloorPlan:
    """Climb by turns about the grid's middle and by shifts, in ever smaller steps."""
    middle = points.mean(axis=0)
    reach_m = float(np.ptp(points, axis=0).max()) / 2.0
    score, step_m = _score(plan, points), COARSEST_M / 2.0
    while step_m >= FINEST_M:
        nudged = [
            _nudged(plan, middle, turn * step_m / reach_m, x * step_m, y * step_m)
            for turn, x, y in product((0.0, 1.0, -1.0), repeat=3)
        ]
        best = max(nudged, key=lambda found: _score(found, points))
        if _score(best, points) > score:
            plan, score = best, _score(best, points)
        else:
            step_m /= 2.0
    return plan


def _nudged(
    plan: FloorPlan, middle: NDArray[np.float64], turn_rad: float, x_m: float, y_m: float
) -> FloorPlan:
    c, s = math.cos(turn_rad), math.sin(turn_rad)
    x, y = float(middle[0]), float(middle[1])
    return plan.moved(turn_rad, (x - (c * x - s * y) + x_m, y - (s * x + c * y) + y_m))
