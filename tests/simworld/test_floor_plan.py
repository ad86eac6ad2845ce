"""Reading map_server maps, their geometry, and echoes among cells against echoes among walls."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

from bus.grid import Grid
from simworld.building import Building, build
from simworld.floor_plan import Cells, FloorPlan, FloorPlanError, read_floor_plan
from simworld.sonar import SonarRing, true_ranges_m

GREY = np.array([[0, 205, 254], [254, 100, 255]], np.uint8)
"""Two rows as the image shows them, the northern first."""

KEYS: dict[str, object] = {
    "image": "map.png",
    "resolution": 0.5,
    "origin": [-1.0, 2.0, 0.0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}


def written(
    folder: Path, changed: Mapping[str, object] = KEYS, pixels: NDArray[np.uint8] = GREY
) -> Path:
    keys = {k: v for k, v in (KEYS | dict(changed)).items() if v is not None}
    (folder / "map.yaml").write_text(yaml.safe_dump(keys))
    if keys.get("image") == "map.png":
        Image.fromarray(pixels).save(folder / "map.png")
    return folder / "map.yaml"


def test_thresholds(tmp_path: Path) -> None:
    # p = (255 - v) / 255: 0 -> 1.0 occupied; 205 -> 0.196078 neither; 254 -> 0.004 free;
    # 100 -> 0.608 neither; 255 -> 0 free. Row 0 of the cells is the image's last.
    cells = read_floor_plan(written(tmp_path)).cells
    assert cells.occupied.tolist() == [[False, False, False], [True, False, False]]
    assert cells.free.tolist() == [[True, False, True], [False, False, True]]
    assert cells.resolution_m == 0.5


def test_negate(tmp_path: Path) -> None:
    # p = v / 255: 205 -> 0.804, 254 and 255 occupied; 0 free; 100 -> 0.392 neither.
    cells = read_floor_plan(written(tmp_path, {"negate": 1})).cells
    assert cells.occupied.tolist() == [[True, False, True], [False, True, True]]
    assert cells.free.tolist() == [[False, False, False], [True, False, False]]


def test_other_thresholds(tmp_path: Path) -> None:
    cells = read_floor_plan(written(tmp_path, {"occupied_thresh": 0.6, "free_thresh": 0.2})).cells
    assert cells.occupied.tolist() == [[False, True, False], [True, False, False]]
    assert cells.free.tolist() == [[True, False, True], [False, True, True]]


def test_colours_are_averaged_and_pgm_is_read(tmp_path: Path) -> None:
    # (255 + 0 + 0) / 3 = 85: p = 0.667 occupied.
    red = np.array([[[255, 0, 0], [255, 255, 255]]], np.uint8)
    cells = read_floor_plan(written(tmp_path, pixels=red)).cells
    assert cells.occupied.tolist() == [[True, False]]
    Image.fromarray(GREY).save(tmp_path / "map.pgm")
    by_pgm = read_floor_plan(written(tmp_path, {"image": "map.pgm"})).cells
    by_png = read_floor_plan(written(tmp_path)).cells
    np.testing.assert_array_equal(by_pgm.occupied, by_png.occupied)


def test_frame_by_hand(tmp_path: Path) -> None:
    # Origin (-1, 2), turned 90 degrees: the rows run north, the columns west.
    plan = read_floor_plan(written(tmp_path, {"origin": [-1.0, 2.0, math.pi / 2]}))
    assert plan.to_world(0.5, 0.0) == pytest.approx((-1.0, 2.5))
    assert plan.to_world(0.0, 0.5) == pytest.approx((-1.5, 2.0))
    # Turned about the world's origin by another 90 degrees, then 10 m east.
    moved = plan.moved(math.pi / 2, (10.0, 0.0))
    assert moved.to_world(0.0, 0.0) == pytest.approx((8.0, -1.0))
    assert moved.to_world(0.5, 0.0) == pytest.approx((7.5, -1.0))


@given(*(st.floats(-50.0, 50.0) for _ in range(5)))
def test_to_image_is_the_inverse_of_to_world(
    x: float, y: float, turn: float, u: float, v: float
) -> None:
    plan = FloorPlan(Cells(np.zeros((2, 2), bool), np.ones((2, 2), bool), 0.1), (x, y), turn)
    assert plan.to_image(*plan.to_world(u, v)) == pytest.approx((u, v), abs=1e-9)


def test_clearance_by_hand() -> None:
    # 5 x 5 cells of 1 m, all free: outside is not. From the middle to the first middle of a
    # cell outside 3 m, from the corner cell 1 m.
    plan = FloorPlan(Cells(np.zeros((5, 5), bool), np.ones((5, 5), bool), 1.0), (10.0, 0.0), 0.0)
    assert plan.clearance_m(12.5, 2.5) == 3.0
    assert plan.clearance_m([10.1, 9.9, 12.5], [0.1, 2.5, 5.1]).tolist() == [1.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({"resolution": None}, "resolution: found no such key, expected a positive number"),
        ({"resolution": "small"}, "resolution: found 'small'"),
        ({"resolution": 0.0}, r"resolution: found 0\.0"),
        ({"resolution": math.nan}, "resolution: found nan"),
        ({"origin": [1.0, 2.0]}, r"origin: found \[1\.0, 2\.0\], expected three numbers"),
        ({"origin": [1.0, 2.0, "north"]}, "origin: found .*'north'"),
        ({"negate": 2}, "negate: found 2, expected 0 or 1"),
        ({"occupied_thresh": 65}, "occupied_thresh: found 65, expected a number from 0 to 1"),
        ({"free_thresh": 0.7}, r"free_thresh: found 0\.7, expected .* occupied_thresh, 0\.65"),
        ({"mode": "raw"}, "mode: found 'raw', expected 'trinary' or 'scale'"),
        ({"image": 7}, "image: found 7, expected the name of an image file"),
        ({"image": "gone.png"}, r"gone\.png.*No such file"),
        ({"image": "map.yaml"}, r"map\.yaml: found no image in it, expected an image file"),
    ],
)
def test_bad_maps_are_refused_by_file_and_key(
    tmp_path: Path, changed: dict[str, object], says: str
) -> None:
    path = written(tmp_path, changed)
    with pytest.raises(FloorPlanError, match=says) as caught:
        read_floor_plan(path)
    assert str(tmp_path) in str(caught.value)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (None, "No such file"),
        ("- 1\n", "found list, expected keys and values"),
        ("a: [", "expected a map_server YAML file"),
    ],
)
def test_no_map_at_all(tmp_path: Path, text: str | None, says: str) -> None:
    if text is not None:
        (tmp_path / "map.yaml").write_text(text)
    with pytest.raises(FloorPlanError, match=says):
        read_floor_plan(tmp_path / "map.yaml")


def test_deep_images_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path, {"image": "deep.png"})
    Image.fromarray(GREY.astype(np.uint16)).save(tmp_path / "deep.png")
    with pytest.raises(FloorPlanError, match="found mode I;16, expected 8 bits a channel"):
        read_floor_plan(path)


def crossing() -> Building:
    """A junction at (0, 0) with exits west, east and north, dead ends 6 and 8 m away."""
    grid = Grid(3, 2)
    corridors = np.array([1, 1, 0, 0, 0, 1, 0], np.uint8)
    assert grid.corridors == 7
    return build([-6.0, 0.0, 8.0], [0.0, 6.0], corridors, 2.0)


def drawn(turn_rad: float, resolution_m: float = 0.05) -> FloorPlan:
    """A plan whose image shows the crossing turned by -turn_rad, walls three cells thick."""
    side = round(24.0 / resolution_m)
    blank = np.zeros((side, side), bool)
    frame = FloorPlan(Cells(blank, blank, resolution_m), (0.0, 0.0), turn_rad)
    u, v = frame.to_image(1.0, 2.5)
    corner_u, corner_v = u - 12.0, v - 12.0
    origin = frame.to_world(corner_u, corner_v)
    column, row = np.meshgrid(np.arange(side), np.arange(side))
    place = FloorPlan(Cells(blank, blank, resolution_m), origin, turn_rad)
    x, y = place.to_world((column + 0.5) * resolution_m, (row + 0.5) * resolution_m)
    free = np.zeros_like(blank)
    near = np.zeros_like(blank)
    for west, south, east, north in ((-7, -1, 9, 1), (-1, -1, 1, 7)):
        free |= (x > west) & (x < east) & (y > south) & (y < north)
        thick = 3 * resolution_m
        near |= (x > west - thick) & (x < east + thick) & (y > south - thick) & (y < north + thick)
    return FloorPlan(Cells(near & ~free, free, resolution_m), origin, turn_rad)


@pytest.mark.parametrize("turn_deg", [0.0, 1.1, 30.0, -100.0])
def test_cells_and_walls_give_the_same_echoes(turn_deg: float) -> None:
    # The corners and the walls are drawn to half a cell's diagonal (35 mm), rays are a degree
    # apart, and a corner is a patch of 0.2 m without a normal, not a point: so a cone that just
    # misses a corner may hear it. A wall a degree off the rows has steps of one cell that tilt
    # its normal by up to 7 degrees there, so a cone may hear one beyond its limit, or lose one.
    # The headings keep the cones' edges at least 1.5 degrees from the walls' true limits.
    ring, building = SonarRing(), crossing()
    plan = drawn(math.radians(turn_deg))
    differences: list[float] = []
    for x, y, heading in ((0.0, 0.0, 0.1), (0.2, -0.1, 0.6), (-5.8, 0.2, 2.95), (0.1, 5.5, 1.4)):
        exact = true_ranges_m(ring, building, x, y, heading)
        cells = true_ranges_m(ring, plan, x, y, heading)
        heard = np.isfinite(exact)
        assert np.isinf(cells[heard]).sum() <= 1
        assert np.isfinite(cells[~heard]).sum() <= 3
        heard &= np.isfinite(cells)
        differences += np.abs(exact[heard] - cells[heard]).tolist()
    assert len(differences) > 60
    assert max(differences) < 0.2
    assert np.percentile(differences, 80) < 0.05


def test_walls_of_cells_are_mirrors_and_their_corners_are_not() -> None:
    narrow = SonarRing(transducers=1, half_angle_rad=math.radians(1.0))
    plan = drawn(math.radians(20.0))
    # In the east corridor the north wall is 1 m off; facing it 30 degrees aslant: lost.
    assert true_ranges_m(narrow, plan, 4.0, 0.0, math.radians(60.0))[0] == math.inf
    straight = true_ranges_m(narrow, plan, 4.0, 0.0, math.radians(90.0))[0]
    assert straight == pytest.approx(1.0, abs=0.1)
    # The corner (1, 1) seen from (3, 0): sqrt(5) m at 153.4 degrees.
    corner = true_ranges_m(narrow, plan, 3.0, 0.0, math.atan2(1.0, -2.0))[0]
    assert corner == pytest.approx(math.sqrt(5.0), abs=0.1)


def test_people_among_cells() -> None:
    # From (3.5, 0) in the east corridor: 4 m ahead; and in the north corridor at (0, 4.5), which
    # is at 127.9 degrees behind the wall y = 1, passed at x = 2.7. Transducer 9 (120 .. 150
    # degrees) hears neither that wall, 30 degrees aslant, nor the corner (1, 1) at 158 degrees.
    ring, plan = SonarRing(), drawn(math.radians(-35.0))
    ahead = true_ranges_m(ring, plan, 3.5, 0.0, 0.0, [(7.5, 0.0, 0.25)])
    hidden = true_ranges_m(ring, plan, 3.5, 0.0, 0.0, [(0.0, 4.5, 0.25)])
    assert ahead[0] == pytest.approx(3.75, abs=1e-9)
    assert hidden[9] == math.inf


def test_off_the_plan_there_is_nothing() -> None:
    ranges = true_ranges_m(SonarRing(), drawn(0.0), 100.0, 0.0, 0.0)
    assert np.isinf(ranges).all()


def test_walls_stand_as_they_were_drawn() -> None:
    # Upright in the world, the walls stand -20 degrees off in an image turned by +20.
    plan = drawn(math.radians(20.0))
    assert math.degrees(plan.cells.wall_turn_rad) == pytest.approx(-20.0, abs=0.3)
    assert math.degrees(plan.upright().turn_rad) == pytest.approx(20.0, abs=0.3)
