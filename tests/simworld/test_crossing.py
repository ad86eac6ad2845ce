"""Where the junctions of a floor plan are: in the middle of what leads there, not on grid lines."""

from __future__ import annotations

import numpy as np
import pytest

from simworld.body import Body
from simworld.building import build
from simworld.crossing import crossing_m
from simworld.sonar import SonarRing
from tests.simworld.drawn_plans import Box, drawn_plan

COLUMNS_M, ROWS_M = (0.0, 20.0), (0.0, 16.0)
BUILDING = build(COLUMNS_M, ROWS_M, np.ones(4, np.uint8), 2.0)


def ring_of_corridors(off_x_m: float, off_y_m: float) -> list[Box]:
    """Four corridors in a ring; the western and the southern one off their grid lines."""
    west, south = off_x_m, off_y_m
    return [
        (west - 1.0, south - 1.0, 21.0, south + 1.0),
        (west - 1.0, 15.0, 21.0, 17.0),
        (west - 1.0, south - 1.0, west + 1.0, 17.0),
        (19.0, south - 1.0, 21.0, 17.0),
    ]


def test_on_a_building_it_is_where_the_lines_cross() -> None:
    for place in range(4):
        assert crossing_m(BUILDING, BUILDING, place) == BUILDING.position_m(
            *BUILDING.grid.place(place)
        )


@pytest.mark.parametrize(("off_x_m", "off_y_m"), [(0.0, 0.0), (0.4, -0.3), (-0.5, 0.5)])
def test_it_is_in_the_middle_of_the_corridors_that_lead_there(
    off_x_m: float, off_y_m: float
) -> None:
    plan = drawn_plan(ring_of_corridors(off_x_m, off_y_m), resolution_m=0.05)
    assert crossing_m(plan, BUILDING, 0) == pytest.approx((off_x_m, off_y_m), abs=0.08)
    # The north-eastern corridors are on their lines.
    assert crossing_m(plan, BUILDING, 3) == pytest.approx((20.0, 16.0), abs=0.08)


@pytest.mark.parametrize("door_m", [9.5, 10.0, 10.35])
def test_a_side_that_is_entered_through_a_door_is_where_the_door_is(door_m: float) -> None:
    building = build((0.0, 10.0, 20.0), ROWS_M, np.ones(7, np.uint8), 2.0)
    rooms: list[Box] = [(8.0, 2.0, 13.0, 14.0)]
    doors: list[Box] = [
        (door_m - 0.35, 0.9, door_m + 0.35, 2.1),
        (door_m - 0.35, 13.9, door_m + 0.35, 15.1),
    ]
    plan = drawn_plan([*ring_of_corridors(0.0, 0.0), *rooms, *doors], resolution_m=0.05)
    x_m, y_m = crossing_m(plan, building, building.grid.intersection(1, 0))
    assert (x_m, y_m) == pytest.approx((door_m, 0.0), abs=0.06)


def test_the_robot_stops_where_the_corridors_cross() -> None:
    plan = drawn_plan(ring_of_corridors(0.4, -0.3), resolution_m=0.05)
    body = Body(SonarRing(), plan, 0.085, np.random.default_rng(1))
    x_m, y_m = body.crossing_m(BUILDING, 0)
    assert (x_m, y_m) == pytest.approx((0.4, -0.3), abs=0.08)
