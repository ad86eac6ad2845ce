"""The building's outline against shapely's union of boxes, and properties of random maps."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from shapely.geometry import LineString, MultiLineString, Point, box
from shapely.ops import unary_union

from bus.grid import DIRECTIONS, EAST, NORTH, STEP, Grid
from simworld.building import Building, BuildingError, build, random_connected


@st.composite
def buildings(draw: st.DrawFn) -> Building:
    columns, rows = draw(st.tuples(st.integers(1, 4), st.integers(2, 4)))
    width_m = draw(st.sampled_from([1.5, 1.75, 2.0]))
    gaps = st.sampled_from([0.25, 1.0, 7.5, 20.0])
    columns_m = np.cumsum([draw(gaps) + width_m for _ in range(columns)]) - 10.0
    rows_m = np.cumsum([draw(gaps) + width_m for _ in range(rows)]) - 30.0
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    corridors = random_connected(Grid(columns, rows), draw(st.floats(0.05, 1.0)), rng)
    return build(columns_m.tolist(), rows_m.tolist(), corridors, width_m)


def boxes(building: Building) -> list[tuple[float, float, float, float]]:
    """Each corridor with the junction squares at its ends: the definition of the free space."""
    half = building.corridor_width_m / 2
    found = []
    for corridor in np.flatnonzero(building.corridors):
        a, b = (building.grid.place(end) for end in building.grid.ends(int(corridor)))
        (x0, y0), (x1, y1) = building.position_m(*a), building.position_m(*b)
        found.append((x0 - half, y0 - half, x1 + half, y1 + half))
    return found


def free_space(building: Building):  # type: ignore[no-untyped-def]
    return unary_union([box(*corners) for corners in boxes(building)])


def points(rows: NDArray[np.float64]) -> list[tuple[float, ...]]:
    return sorted(tuple(float(v) for v in row) for row in rows)


@given(buildings())
def test_walls_are_the_boundary_of_the_union_of_corridors(building: Building) -> None:
    walls = MultiLineString([[(a, b), (c, d)] for a, b, c, d in building.walls])
    boundary = free_space(building).boundary
    assert walls.length == pytest.approx(boundary.length)
    assert boundary.difference(walls.buffer(1e-6)).length == pytest.approx(0.0, abs=1e-9)


@given(buildings())
def test_outline_is_closed_and_every_corner_joins_two_walls(building: Building) -> None:
    assert points(building.walls[:, :2]) == points(building.walls[:, 2:])
    assert points(building.walls[:, :2]) == points(building.corners)


@given(buildings())
def test_walls_that_meet_are_not_collinear_pieces_of_one(building: Building) -> None:
    upright = building.walls[:, 0] == building.walls[:, 2]
    starts = {tuple(w[:2]): upright[k] for k, w in enumerate(building.walls)}
    assert all(starts[tuple(w[2:])] != upright[k] for k, w in enumerate(building.walls))


@given(buildings())
def test_free_space_is_on_the_left_of_each_wall(building: Building) -> None:
    free = free_space(building)
    for x0, y0, x1, y1 in building.walls:
        length = math.hypot(x1 - x0, y1 - y0)
        left = (
            (x0 + x1) / 2 - (y1 - y0) / length * 0.01,
            (y0 + y1) / 2 + (x1 - x0) / length * 0.01,
        )
        assert free.contains(Point(left))


@given(buildings())
def test_no_wall_crosses_a_corridors_centre_line(building: Building) -> None:
    walls = MultiLineString([[(a, b), (c, d)] for a, b, c, d in building.walls])
    for corridor in np.flatnonzero(building.corridors):
        ends = [building.grid.place(end) for end in building.grid.ends(int(corridor))]
        centre = LineString([building.position_m(*end) for end in ends])
        assert walls.distance(centre) == pytest.approx(building.corridor_width_m / 2)


@given(buildings())
def test_a_wall_lies_across_every_missing_exit_and_across_no_other(building: Building) -> None:
    half = building.corridor_width_m / 2
    walls = MultiLineString([[(a, b), (c, d)] for a, b, c, d in building.walls]).buffer(1e-9)
    for intersection in range(building.grid.intersections):
        x, y = building.grid.place(intersection)
        exits = building.truth_type(x, y)
        if not exits:
            continue
        centre_x, centre_y = building.position_m(x, y)
        for direction in DIRECTIONS:
            dx, dy = STEP[direction]
            middle = np.array([centre_x + dx * half, centre_y + dy * half])
            across = np.array([dy * half, dx * half])
            side = LineString([middle - across, middle + across])
            covered = 0.0 if exits & direction else 2 * half
            assert side.intersection(walls).length == pytest.approx(covered, abs=1e-6)


@given(buildings(), st.floats(-12.0, 80.0), st.floats(-32.0, 60.0))
def test_clearance_is_the_distance_to_the_boundary(building: Building, x: float, y: float) -> None:
    free, here = free_space(building), Point(x, y)
    distance = free.boundary.distance(here)
    found = building.clearance_m(x, y)
    assert abs(found) == pytest.approx(distance, abs=1e-9)
    if distance > 1e-9:
        assert (found > 0) == free.contains(here)


def test_one_corridor_by_hand() -> None:
    building = build([0.0, 10.0], [5.0], np.array([1], np.uint8), 2.0)
    # From -1 to 11 (each square reaches 1 m beyond its centre), from 4 to 6.
    assert points(building.corners) == [(-1.0, 4.0), (-1.0, 6.0), (11.0, 4.0), (11.0, 6.0)]
    assert len(building.walls) == 4
    assert building.length_m(0) == 10.0
    assert building.position_m(1, 0) == (10.0, 5.0)
    assert building.truth_type(0, 0) == 2  # east
    assert building.truth_type(1, 0) == 8  # west
    assert building.clearance_m(5.0, 5.25) == pytest.approx(0.75)
    assert building.clearance_m(5.0, 7.5) == pytest.approx(-1.5)


def test_length_of_a_corridor_that_runs_north() -> None:
    building = build([0.0], [1.0, 8.5], np.array([1], np.uint8), 1.5)
    assert building.length_m(0) == 7.5


def test_the_building_cannot_be_changed() -> None:
    given_map = np.array([1], np.uint8)
    building = build([0.0, 10.0], [5.0], given_map, 2.0)
    given_map[0] = 0
    assert building.corridors[0] == 1
    with pytest.raises(ValueError, match="read-only"):
        building.walls[0, 0] = 3.0


@pytest.mark.parametrize(
    ("columns_m", "rows_m", "corridors", "width_m", "says"),
    [
        ([0, 0], [0, 9], [1, 1, 1, 1], 2.0, "columns_m: found 0 then 0 at 0 and 1"),
        ([0, 9], [9, 0], [1, 1, 1, 1], 2.0, "rows_m: found 9 then 0 at 0 and 1"),
        ([0, 2], [0, 9], [1, 1, 1, 1], 2.0, "lines 0 and 1 are 2 m apart, expected more than"),
        ([0, math.nan], [0, 9], [1, 1, 1, 1], 2.0, "expected increasing lines"),
        ([0, math.inf], [0, 9], [1, 1, 1, 1], 2.0, "expected finite numbers"),
        ([0, 9], [0, 9], [1, 1, 1, 1], 0.0, "corridor_width_m: found 0.0"),
        ([0, 9], [0, 9], [1, 1, 1, 1], math.nan, "corridor_width_m: found nan"),
        ([0, 9], [0, 9], [0, 0, 0, 0], 2.0, "expected at least one"),
        ([0, 9], [0, 9], [1, 1, 0, 0], 2.0, r"found \[0, 1\] in more than one component"),
        ([0, 9], [0, 9], [1, 1, 1], 2.0, r"found shape \(3,\), expected \(4,\)"),
        ([0, 9], [0, 9], [1, 2, 1, 1], 2.0, "expected 0 and 1 only"),
    ],
)
def test_what_is_no_building_is_refused(
    columns_m: list[float], rows_m: list[float], corridors: list[int], width_m: float, says: str
) -> None:
    with pytest.raises(BuildingError, match=says):
        build(columns_m, rows_m, np.array(corridors, np.uint8), width_m)


@given(st.integers(1, 5), st.integers(2, 5), st.floats(0.01, 1.0), st.integers(0, 10**6))
def test_random_maps_are_connected_and_as_dense_as_asked(
    columns: int, rows: int, density: float, seed: int
) -> None:
    grid = Grid(columns, rows)
    found = random_connected(grid, density, np.random.default_rng(seed))
    assert grid.connected(found)
    assert found.sum() == max(1, round(density * grid.corridors))
    again = random_connected(grid, density, np.random.default_rng(seed))
    assert np.array_equal(found, again)


def test_random_maps_reach_every_map_of_their_size() -> None:
    # 2 x 2: four corridors in a ring. Two that touch: 4 ways; any three: 4 ways.
    grid, rng = Grid(2, 2), np.random.default_rng(5)
    for density, ways in ((0.5, 4), (0.75, 4)):
        found = {tuple(random_connected(grid, density, rng).tolist()) for _ in range(200)}
        assert len(found) == ways


def test_density_out_of_range_is_refused() -> None:
    for density in (0.0, 1.5, math.nan):
        with pytest.raises(BuildingError, match="density"):
            random_connected(Grid(2, 2), density, np.random.default_rng(1))


def test_grid_constants_agree_with_the_compass() -> None:
    # The cross of a 3 x 3 grid: all corridors at the centre, north is towards row 2.
    building = build([0, 9, 18], [0, 9, 18], np.ones(12, np.uint8), 2.0)
    assert building.truth_type(1, 1) == 15
    assert building.truth_type(0, 0) == NORTH | EAST
    assert all(b > a for a, b in pairwise(building.rows_m))
