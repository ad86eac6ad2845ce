"""The survey of real buildings, against what their maps show by eye, where they are at hand."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from bus.grid import EAST, NORTH, Grid
from simworld.floor_plan import read_floor_plan
from simworld.occupancy import plan_of_log
from simworld.survey import Survey, read_doors, survey

MAPS = Path(__file__).parents[3] / "shared" / "maps"
ACES_COLUMNS_M = (7.0, 26.4, 49.8)
ACES_ROWS_M = (-47.7, -27.6, -9.0)
"""By eye, in a frame of their own, each within 0.6 m."""


def need(name: str) -> Path:
    path = MAPS / name
    if not path.is_file():
        pytest.skip(f"needs the map {path}")
    return path


def complete(found: Survey, columns: int, rows: int) -> None:
    """Every corridor of the grid is there, and no other."""
    grid = Grid(columns, rows)
    assert (len(found.columns_m), len(found.rows_m)) == (columns, rows)
    assert len(found.corridors) == grid.corridors
    types = grid.junction_types(np.ones((1, grid.corridors), np.uint8))[0]
    of_place = {j.place: j.type for j in found.junctions}
    assert [of_place[grid.place(k)] for k in range(grid.intersections)] == types.tolist()


def aces(found: Survey) -> None:
    complete(found, 3, 3)
    for seen, by_eye in ((found.columns_m, ACES_COLUMNS_M), (found.rows_m, ACES_ROWS_M)):
        off = np.array(seen) - np.array(by_eye)
        assert np.abs(off - off.mean()).max() < 0.6
    assert max(j.off_m or 0.0 for j in found.junctions) < 0.7
    assert abs(math.degrees(found.turn_rad)) < 2.0
    assert 1.5 < float(np.median([c.width_m for c in found.corridors])) < 2.2


def test_aces_has_9_junctions_and_12_corridors() -> None:
    aces(survey(read_floor_plan(need("aces/aces.yaml"))))


@pytest.mark.parametrize("door_stub_m", [8.5, 14.0])
def test_the_door_stub_may_be_far_from_its_default(door_stub_m: float) -> None:
    aces(survey(read_floor_plan(need("aces/aces.yaml")), door_stub_m))


def test_the_plan_built_from_the_aces_log_has_them_too() -> None:
    aces(survey(plan_of_log(need("aces/aces-corrected.log.gz"))))


def test_k_wing_has_12_junctions_and_16_corridors() -> None:
    found = survey(read_floor_plan(need("k-wing/k-wing.yaml")))
    complete(found, 6, 2)
    assert found.columns_m[-1] - found.columns_m[0] == pytest.approx(80.0, abs=2.0)
    assert float(np.median([c.width_m for c in found.corridors])) == pytest.approx(1.8, abs=0.2)


@pytest.mark.parametrize(("name", "loop"), [("gdc-3ne/3ne.yaml", 10.0), ("gdc-4/4.yaml", 60.0)])
def test_gdc_floors_give_a_connected_grid_to_correct_by_hand(name: str, loop: float) -> None:
    path = need(name)
    doors = read_doors(path.parent / "doors.yaml")
    found = survey(read_floor_plan(path), doors=doors)
    grid = Grid(len(found.columns_m), len(found.rows_m))
    corridors = np.zeros(grid.corridors, np.uint8)
    for corridor in found.corridors:
        (ax, ay), (bx, _) = corridor.ends
        corridors[grid.corridor(ax, ay, EAST if bx > ax else NORTH)] = 1
    assert grid.connected(corridors)
    # The long corridors: 80 m and more in all, on both sides of the building's middle.
    assert sum(c.length_m for c in found.corridors) > 150.0
    assert 1.4 < float(np.median([c.width_m for c in found.corridors])) < 2.3
    assert found.columns_m[-1] - found.columns_m[0] > 70.0
    assert found.rows_m[-1] - found.rows_m[0] > loop * 0.7
