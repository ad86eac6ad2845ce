"""Plans built from scans whose poses are known."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from simworld.carmen import CarmenError, Scan
from simworld.floor_plan import FloorPlan, read_floor_plan
from simworld.occupancy import TRUSTED_M, plan_of_log, plan_of_scans, write_floor_plan
from simworld.survey import survey

BEARINGS_RAD = np.deg2rad(np.arange(181) - 90.0)


def seen(walls: NDArray[np.float64], x: float, y: float, heading: float, beams: int = 181) -> Scan:
    """What a laser without error sees of upright walls (n, 4: west, south, east, north)."""
    ranges = np.full(beams, np.inf)
    for k, angle in enumerate(heading + BEARINGS_RAD):
        c, s = math.cos(angle), math.sin(angle)
        for west, south, east, north in walls:
            if west == east and abs(c) > 1e-12:
                far = (west - x) / c
                hit = far > 0 and south <= y + far * s <= north
            elif south == north and abs(s) > 1e-12:
                far = (south - y) / s
                hit = far > 0 and west <= x + far * c <= east
            else:
                continue
            if hit:
                ranges[k] = min(ranges[k], far)
    return Scan(0.0, x, y, heading, np.where(np.isfinite(ranges), ranges, np.nan))


RING_M = (0.0, 14.0)
"""A ring of corridors 2 m wide whose middles are on these lines."""

OUTER, INNER = (-1.0, -1.0, 15.0, 15.0), (1.0, 1.0, 13.0, 13.0)
WALLS = np.array(
    [
        side
        for w, s, e, n in (OUTER, INNER)
        for side in ((w, s, e, s), (w, n, e, n), (w, s, w, n), (e, s, e, n))
    ]
)


def round_the_ring() -> list[Scan]:
    along = np.linspace(0.0, 14.0, 12)
    corners = [(0.0, 0.0, 0.0), (14.0, 0.0, 0.5), (14.0, 14.0, 1.0), (0.0, 14.0, 1.5)]
    return [
        seen(WALLS, x + math.cos(h * math.pi) * d, y + math.sin(h * math.pi) * d, h * math.pi)
        for x, y, h in corners
        for d in along
    ]


@pytest.fixture(scope="module")
def ring() -> FloorPlan:
    return plan_of_scans(round_the_ring())


def state(plan: FloorPlan, x: float, y: float) -> str:
    u, v = plan.to_image(x, y)
    row, column = int(v / plan.cells.resolution_m), int(u / plan.cells.resolution_m)
    if plan.cells.occupied[row, column]:
        return "occupied"
    return "free" if plan.cells.free[row, column] else "unknown"


def test_free_where_beams_pass_occupied_where_they_end(ring: FloorPlan) -> None:
    assert state(ring, 7.0, 0.0) == state(ring, 13.5, 7.0) == "free"
    assert state(ring, 7.0, 7.0) == state(ring, 7.0, -1.5) == "unknown"
    near_wall = [state(ring, x, -1.0 + dy) for x in (4.0, 9.0) for dy in (-0.02, 0.02)]
    assert "occupied" in near_wall
    assert not (ring.cells.free & ring.cells.occupied).any()


def test_the_built_plan_is_surveyed(ring: FloorPlan) -> None:
    found = survey(ring)
    assert [j.type for j in found.junctions] == [0b0011, 0b0110, 0b1001, 0b1100]
    assert found.columns_m == pytest.approx(RING_M, abs=0.2)
    assert found.rows_m == pytest.approx(RING_M, abs=0.2)
    assert [c.width_m for c in found.corridors] == pytest.approx([2.0] * 4, abs=0.2)


def test_beams_that_never_returned_say_nothing_and_far_ones_only_what_they_pass() -> None:
    ranges = np.full(181, np.nan)
    ranges[90] = TRUSTED_M + 10.0
    plan = plan_of_scans([Scan(0.0, 0.0, 0.0, 0.0, ranges)] * 3)
    assert not plan.cells.occupied.any()
    rows = np.flatnonzero(plan.cells.free.any(axis=1))
    assert len(rows) == 1
    assert plan.cells.free.sum() * plan.cells.resolution_m == pytest.approx(TRUSTED_M, abs=0.1)


def test_written_and_read_again_it_is_the_same(ring: FloorPlan, tmp_path: Path) -> None:
    write_floor_plan(ring.moved(0.2, (3.0, -4.0)), tmp_path / "ring.yaml")
    again = read_floor_plan(tmp_path / "ring.yaml")
    np.testing.assert_array_equal(again.cells.occupied, ring.cells.occupied)
    np.testing.assert_array_equal(again.cells.free, ring.cells.free)
    moved = ring.moved(0.2, (3.0, -4.0))
    assert again.origin_m == pytest.approx(moved.origin_m)
    assert again.turn_rad == pytest.approx(0.2)


def test_scans_that_make_no_plan_are_refused(tmp_path: Path) -> None:
    nothing = Scan(0.0, 0.0, 0.0, 0.0, np.full(181, np.nan))
    with pytest.raises(CarmenError, match="found no echo in 1 scans"):
        plan_of_scans([nothing])
    here = Scan(0.0, 0.0, 0.0, 0.0, np.full(181, 2.0))
    far = Scan(0.0, 1e6, 0.0, 0.0, np.full(181, 2.0))
    with pytest.raises(CarmenError, match="expected a plan of at most"):
        plan_of_scans([here, far])
    path = tmp_path / "blind.log"
    path.write_text(f"FLASER 180 {'81.9 ' * 180}0 0 0 0 0 0 1 host 1\n")
    with pytest.raises(CarmenError, match=r"blind\.log: found no echo"):
        plan_of_log(path)
