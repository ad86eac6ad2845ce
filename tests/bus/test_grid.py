"""Grid, corridors and junction types, against versions that look at one thing at a time."""

from __future__ import annotations

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.grid import (
    DIRECTIONS,
    JUNCTION_TYPES,
    LEFT_OF,
    OPPOSITE,
    RIGHT_OF,
    STEP,
    Grid,
    type_name,
)

sizes = st.tuples(st.integers(1, 6), st.integers(1, 6)).filter(lambda size: size != (1, 1))
grids = sizes.map(lambda size: Grid(*size))


@st.composite
def grids_with_maps(draw: st.DrawFn) -> tuple[Grid, np.ndarray]:
    grid = draw(grids)
    corridors = st.lists(st.integers(0, 1), min_size=grid.corridors, max_size=grid.corridors)
    return grid, np.array(draw(st.lists(corridors, min_size=1, max_size=4)), dtype=np.uint8)


def beside(grid: Grid, x: int, y: int, direction: int) -> tuple[int, int] | None:
    there = x + STEP[direction][0], y + STEP[direction][1]
    return there if 0 <= there[0] < grid.columns and 0 <= there[1] < grid.rows else None


def places(grid: Grid) -> list[tuple[int, int]]:
    return [(x, y) for y in range(grid.rows) for x in range(grid.columns)]


def joined(grid: Grid, corridors: np.ndarray) -> nx.Graph:
    graph = nx.Graph()
    graph.add_edges_from(grid.ends(c) for c in range(grid.corridors) if corridors[c])
    return graph


@given(grids)
def test_a_corridor_leads_wherever_there_is_a_neighbour(grid: Grid) -> None:
    for x, y in places(grid):
        for direction in DIRECTIONS:
            there = beside(grid, x, y, direction)
            corridor = grid.corridor(x, y, direction)
            if there is None:
                assert corridor == -1
                continue
            assert corridor == grid.corridor(*there, OPPOSITE[direction])
            ends = {grid.intersection(x, y), grid.intersection(*there)}
            assert set(grid.ends(corridor)) == ends
            assert grid.ends(corridor)[0] == min(ends)


@given(grids)
def test_corridors_are_numbered_without_a_gap_those_to_the_east_first(grid: Grid) -> None:
    numbered = [
        grid.corridor(x, y, direction)
        for direction in (2, 1)
        for x, y in places(grid)
        if beside(grid, x, y, direction)
    ]
    assert numbered == list(range(grid.corridors))
    assert grid.corridors == grid.east_corridors + grid.north_corridors


@given(grids)
def test_intersections_are_numbered_row_by_row_from_the_south_west(grid: Grid) -> None:
    assert [grid.intersection(x, y) for x, y in places(grid)] == list(range(grid.intersections))
    assert [grid.place(v) for v in range(grid.intersections)] == places(grid)


@given(grids_with_maps())
def test_junction_types_have_a_bit_for_each_corridor(drawn: tuple[Grid, np.ndarray]) -> None:
    grid, maps = drawn
    types = grid.junction_types(maps)
    assert types.shape == (len(maps), grid.intersections)
    for row, corridors in zip(types, maps, strict=True):
        for x, y in places(grid):
            slow = sum(d for d in DIRECTIONS if (c := grid.corridor(x, y, d)) >= 0 and corridors[c])
            assert row[grid.intersection(x, y)] == slow


@given(grids_with_maps())
def test_types_that_occur_are_possible(drawn: tuple[Grid, np.ndarray]) -> None:
    grid, maps = drawn
    for row in grid.junction_types(maps):
        for x, y in places(grid):
            assert grid.possible_types(x, y)[row[grid.intersection(x, y)]]


@given(grids)
def test_possible_types_are_those_that_stay_on_the_grid(grid: Grid) -> None:
    for x, y in places(grid):
        for junction_type in range(JUNCTION_TYPES):
            stays = all(beside(grid, x, y, d) for d in DIRECTIONS if junction_type & d)
            assert grid.possible_types(x, y)[junction_type] == stays


@given(grids_with_maps())
def test_connected_means_one_component_of_corridors(drawn: tuple[Grid, np.ndarray]) -> None:
    grid, maps = drawn
    for corridors in maps:
        graph = joined(grid, corridors)
        expected = bool(corridors.any()) and nx.is_connected(graph)
        assert grid.connected(corridors) == expected


def test_directions_turn_as_on_a_compass() -> None:
    for direction in DIRECTIONS:
        (dx, dy), left, right = STEP[direction], STEP[LEFT_OF[direction]], STEP[RIGHT_OF[direction]]
        assert left == (-dy, dx)
        assert right == (dy, -dx)
        assert STEP[OPPOSITE[direction]] == (-dx, -dy)


def test_a_type_is_named_by_its_corridors() -> None:
    assert [type_name(t) for t in (0, 1, 7, 10, 15)] == ["-", "N", "NES", "EW", "NESW"]


@pytest.mark.parametrize("size", [(0, 3), (3, 0), (1, 1), (-1, -2)])
def test_what_is_no_grid(size: tuple[int, int]) -> None:
    with pytest.raises(ValueError, match=f"got columns={size[0]}, rows={size[1]}"):
        Grid(*size)
