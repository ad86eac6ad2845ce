"""Plans laid onto grid lines: a drawn one by hand, and ACES where the shared maps are at hand."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from simworld.floor_plan import Cells, FloorPlan, FloorPlanError, read_floor_plan
from simworld.registration import register

ACES = Path(__file__).parents[3] / "shared" / "maps" / "aces" / "aces.yaml"
ACES_COLUMNS_M = (7.0, 26.4, 49.8)
ACES_ROWS_M = (-47.7, -27.6, -9.0)


def ladder(turn_rad: float, origin_m: tuple[float, float]) -> FloorPlan:
    """Corridors 2 m wide on x = 0, 8, 20 and y = 0, 6 of the image turned by this, 0.1 m cells."""
    side = 300
    column, row = np.meshgrid(np.arange(side), np.arange(side))
    u, v = (column + 0.5) * 0.1 - 15.0, (row + 0.5) * 0.1 - 15.0
    c, s = math.cos(turn_rad), math.sin(turn_rad)
    x, y = c * u - s * v + 10.0, s * u + c * v + 3.0
    inside = (x > -1) & (x < 21) & (y > -1) & (y < 7)
    solid = ((x > 1) & (x < 7) | (x > 9) & (x < 19)) & (y > 1) & (y < 5)
    free = inside & ~solid
    return FloorPlan(Cells(~free, free, 0.1), origin_m, 0.0)


@pytest.mark.parametrize(("turn_deg", "origin_m"), [(0.0, (0.0, 0.0)), (12.0, (-40.0, 7.0))])
def test_a_drawn_ladder_is_laid_on_its_lines(
    turn_deg: float, origin_m: tuple[float, float]
) -> None:
    plan = ladder(math.radians(turn_deg), origin_m)
    found = register(plan, [0.0, 8.0, 20.0], [0.0, 6.0])
    assert math.degrees(found.turn_rad) == pytest.approx(turn_deg, abs=0.2)
    assert found.free_share == 1.0
    # The image's middle shows (10, 3).
    assert found.plan.to_world(15.0, 15.0) == pytest.approx((10.0, 3.0), abs=0.1)
    again = plan.moved(found.turn_rad, found.shift_m)
    assert again.origin_m == pytest.approx(found.plan.origin_m)
    assert again.turn_rad == pytest.approx(found.plan.turn_rad)


def test_a_plan_a_quarter_turn_off() -> None:
    # On its side the ladder is 6 m by 20 m: lines that fit it only after a quarter turn.
    found = register(ladder(math.radians(5.0), (0.0, 0.0)), [0.0, 6.0], [0.0, 8.0, 20.0])
    assert found.free_share == 1.0
    off = math.remainder(math.degrees(found.turn_rad) - 5.0, 180.0)
    assert abs(off) == pytest.approx(90.0, abs=0.2)


def test_a_grid_too_large_for_the_plan_is_refused() -> None:
    with pytest.raises(FloorPlanError, match="found a plan of 300 by 300 cells"):
        register(ladder(0.0, (0.0, 0.0)), [0.0, 40.0], [0.0, 6.0])


@pytest.mark.skipif(not ACES.exists(), reason=f"no {ACES}")
def test_aces_stands_upright_on_its_grid_lines() -> None:
    # Turn and lines as measured by eye: the building stands about one degree off.
    found = register(read_floor_plan(ACES), ACES_COLUMNS_M, ACES_ROWS_M)
    assert abs(math.degrees(found.turn_rad)) < 3.0
    assert found.free_share > 0.98
    middles_x = [(a + b) / 2 for a, b in pairwise(ACES_COLUMNS_M)]
    middles_y = [(a + b) / 2 for a, b in pairwise(ACES_ROWS_M)]
    for y in ACES_ROWS_M:
        for x in ACES_COLUMNS_M:
            assert free_within(found.plan, x, y, 0.8, 0.8)
        for x in middles_x:
            assert free_within(found.plan, x, y, 0.0, 0.8)
    for x in ACES_COLUMNS_M:
        for y in middles_y:
            assert free_within(found.plan, x, y, 0.8, 0.0)


def free_within(plan: FloorPlan, x: float, y: float, dx: float, dy: float) -> bool:
    """Whether room for the robot (radius 0.3 m) is found so near a point of a grid line."""
    xs, ys = np.meshgrid(np.linspace(x - dx, x + dx, 17), np.linspace(y - dy, y + dy, 17))
    return bool((plan.clearance_m(xs, ys) > 0.3).any())
