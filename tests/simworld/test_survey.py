"""Made-up buildings, whose corridors and junctions are known, surveyed from their plans."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from bus.grid import Grid
from simworld.building import random_connected
from simworld.floor_plan import Cells, FloorPlan
from simworld.survey import Door, Survey, SurveyError, survey
from tests.simworld.drawn_plans import corridor_boxes, drawn_plan

COLUMNS_M, ROWS_M = (0.0, 14.0, 30.0), (0.0, 13.0)
LADDER = np.ones(7, np.uint8)
WIDTH_M = 2.0


def types_of(found: Survey) -> list[int]:
    """The junction types by intersection, 0 where there is none."""
    grid = Grid(len(found.columns_m), len(found.rows_m))
    types = [0] * grid.intersections
    for junction in found.junctions:
        types[grid.intersection(*junction.place)] = junction.type
    return types


def check(found: Survey, columns_m: object, rows_m: object, corridors: NDArray[np.uint8]) -> None:
    """The survey is that of the building, however the plan was turned."""
    grid = Grid(len(found.columns_m), len(found.rows_m))
    assert np.diff(found.columns_m) == pytest.approx(np.diff(np.asarray(columns_m)), abs=0.35)
    assert np.diff(found.rows_m) == pytest.approx(np.diff(np.asarray(rows_m)), abs=0.35)
    assert types_of(found) == grid.junction_types(corridors[None, :])[0].tolist()
    assert len(found.corridors) == int(corridors.sum())


@st.composite
def lines(draw: st.DrawFn) -> tuple[float, ...]:
    gaps = draw(st.lists(st.floats(13.0, 20.0), min_size=1, max_size=2))
    return (0.0, *np.cumsum(gaps).tolist())


@settings(max_examples=40, deadline=None)
@given(
    columns_m=lines(),
    rows_m=lines(),
    width_m=st.floats(1.5, 2.2),
    turn_deg=st.floats(-42.0, 42.0),
    noise=st.sampled_from([0.0, 0.002, 0.01]),
    density=st.floats(0.6, 1.0),
    seed=st.integers(0, 2**32),
)
def test_any_building_of_corridors_is_found(
    columns_m: tuple[float, ...],
    rows_m: tuple[float, ...],
    width_m: float,
    turn_deg: float,
    noise: float,
    density: float,
    seed: int,
) -> None:
    rng = np.random.default_rng(seed)
    grid = Grid(len(columns_m), len(rows_m))
    corridors = random_connected(grid, density, rng)
    # A line that no corridor runs along does not show where corridors cross it.
    assume(corridors[: grid.east_corridors].reshape(grid.rows, -1).any(axis=1).all())
    assume(corridors[grid.east_corridors :].reshape(-1, grid.columns).any(axis=0).all())
    plan = drawn_plan(
        corridor_boxes(columns_m, rows_m, corridors, width_m), math.radians(turn_deg), noise, rng
    )
    found = survey(plan)
    assert math.degrees(found.turn_rad) == pytest.approx(-turn_deg, abs=1.0)
    check(found, columns_m, rows_m, corridors)
    widths = [corridor.width_m for corridor in found.corridors]
    assert min(widths) == pytest.approx(width_m, abs=0.3)
    assert max(widths) == pytest.approx(width_m, abs=0.3)
    # The middle line of a dead end runs on into one of its corners.
    dead_ends = (1, 2, 4, 8)
    for junction in found.junctions:
        assert junction.off_m is None or junction.off_m < (
            width_m / 2 if junction.type in dead_ends else 0.4
        )


def test_a_ladder_by_hand() -> None:
    found = survey(drawn_plan(corridor_boxes(COLUMNS_M, ROWS_M, LADDER, WIDTH_M)))
    assert types_of(found) == [0b0011, 0b1011, 0b1001, 0b0110, 0b1110, 0b1100]
    assert found.columns_m == pytest.approx(COLUMNS_M, abs=0.15)
    assert found.rows_m == pytest.approx(ROWS_M, abs=0.15)
    assert [c.ends for c in found.corridors][:2] == [((0, 0), (0, 1)), ((0, 0), (1, 0))]
    assert [c.length_m for c in found.corridors][:2] == pytest.approx([13.0, 14.0], abs=0.2)
    assert found.left_out == ()


def test_the_turn_counts_from_the_world_and_keeps_to_its_frame() -> None:
    # The image turned by 10 degrees in the world, the building 15 degrees in the image.
    plan = drawn_plan(corridor_boxes(COLUMNS_M, ROWS_M, LADDER, WIDTH_M), math.radians(15.0))
    found = survey(plan.moved(math.radians(10.0)))
    assert math.degrees(found.turn_rad) == pytest.approx(-25.0, abs=0.5)
    assert found.columns_m == pytest.approx(COLUMNS_M, abs=0.3)
    assert found.rows_m == pytest.approx(ROWS_M, abs=0.3)


def test_a_ring_that_is_first_met_in_the_middle_of_a_side() -> None:
    square = (0.0, 13.0)
    plan = drawn_plan(corridor_boxes(square, square, np.ones(4, np.uint8), WIDTH_M), -0.009)
    check(survey(plan), square, square, np.ones(4, np.uint8))


def test_a_ring_and_a_single_corridor() -> None:
    ring = np.ones(4, np.uint8)
    found = survey(drawn_plan(corridor_boxes((0.0, 12.0), (0.0, 15.0), ring, WIDTH_M), 0.3))
    assert types_of(found) == [0b0011, 0b1001, 0b0110, 0b1100]
    one = survey(drawn_plan(corridor_boxes((0.0, 20.0), (0.0,), np.ones(1, np.uint8), WIDTH_M)))
    assert types_of(one) == [0b0010, 0b1000]
    assert one.columns_m[1] - one.columns_m[0] == pytest.approx(20.0, abs=1.5)


def test_stubs_are_corridors_only_beyond_the_door_stub() -> None:
    # A room behind a door: 1 m wide and 5.5 m from the corridor's middle.
    boxes = corridor_boxes(COLUMNS_M, ROWS_M, LADDER, WIDTH_M)
    plan = drawn_plan([*boxes, (6.5, -5.5, 7.5, 0.0)])
    check(survey(plan), COLUMNS_M, ROWS_M, LADDER)
    shown = survey(plan, door_stub_m=4.0)
    assert len(shown.junctions) == 9  # the stub's two ends, and its column meets the other row
    assert shown.columns_m == pytest.approx((0.0, 7.0, 14.0, 30.0), abs=0.3)
    assert [j.off_m for j in shown.junctions if j.place == (1, 2)] == [None]


def rooms_between() -> FloorPlan:
    """The ladder, and a room of 8 x 7 m that doors on both sides open to its long corridors."""
    boxes = corridor_boxes(COLUMNS_M, ROWS_M, LADDER, WIDTH_M)
    room = (18.0, 3.0, 26.0, 10.0)
    return drawn_plan([*boxes, room, (21.5, 0.0, 22.5, 4.0), (21.5, 9.0, 22.5, 13.0)])


def test_closed_doors_hide_rooms_and_those_between_corridors_stay_open() -> None:
    plan = rooms_between()
    assert len(survey(plan).corridors) == 10
    doors = [
        Door("south", (21.4, 2.0), (22.6, 2.0)),
        Door("north", (21.4, 11.0), (22.6, 11.0)),
        Door("in the corridor", (7.0, -1.0), (7.0, 1.0)),
    ]
    check(survey(plan, doors=doors), COLUMNS_M, ROWS_M, LADDER)


def test_things_in_a_corridor_do_not_split_it() -> None:
    plan = drawn_plan(corridor_boxes(COLUMNS_M, ROWS_M, LADDER, WIDTH_M))
    free = plan.cells.free.copy()
    thing = np.zeros_like(free)
    thing[:] = False
    row, column = round((0.3 + 4.0) / 0.1), round((7.0 + 4.0) / 0.1)  # near (7, 0.3)
    thing[row : row + 5, column : column + 5] = True
    cells = Cells(plan.cells.occupied | thing, free & ~thing, 0.1)
    check(survey(FloorPlan(cells, plan.origin_m, 0.0)), COLUMNS_M, ROWS_M, LADDER)


@pytest.mark.parametrize(
    ("boxes", "says"),
    [
        ([(0.0, 0.0, 30.0, 20.0)], "found free space without corridors"),
        ([(0.0, 0.0, 20.0, 20.0)], "found free space without corridors"),
        ([(0.0, 0.0, 20.0, 0.4)], r"found no free space wider than 0\.6 m"),
    ],
)
def test_an_open_floor_has_no_corridors(
    boxes: list[tuple[float, float, float, float]], says: str
) -> None:
    with pytest.raises(SurveyError, match=says):
        survey(drawn_plan(boxes))


def test_nothing_free_and_no_length_are_refused() -> None:
    with pytest.raises(SurveyError, match="no free space"):
        survey(FloorPlan(Cells(np.ones((9, 9), bool), np.zeros((9, 9), bool), 0.1), (0, 0), 0.0))
    with pytest.raises(SurveyError, match=r"door stub: found -1\.0 m, expected a positive"):
        survey(rooms_between(), door_stub_m=-1.0)


def test_the_same_plan_gives_the_same_survey() -> None:
    first, again = survey(rooms_between()), survey(rooms_between())
    assert (first.junctions, first.corridors) == (again.junctions, again.corridors)
    assert (first.columns_m, first.rows_m) == (again.columns_m, again.rows_m)
