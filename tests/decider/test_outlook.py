"""Paths by least expected cost: what counts as an errand, what is chosen, what it takes."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.grid import DIRECTIONS, EAST, NORTH, OPPOSITE, STEP, Grid, Maps
from modules.decider import Situation
from modules.decider.outlook import (
    WORLDS,
    decide_by_outlook,
    errands_of,
    most_worlds,
    outlook_cells,
)
from modules.decider.traveller.lookahead import CAUTIONS
from tests.decider.path_reference import all_maps

every_map = functools.cache(all_maps)


def situation(grid: Grid, maps: Maps, place: int, goal: int, **parts: object) -> Situation:
    """Equally likely maps, one errand, none to come, unless parts say otherwise."""
    plain = Situation(
        grid=grid,
        place=place,
        came_from=0,
        waypoints=(goal,),
        tasks=np.empty((0, 2), np.int64),
        expected=np.empty(0),
        maps=maps,
        weights=np.full(len(maps), 1 / len(maps)),
        log_probability=np.zeros(len(maps)),
        corridor_probability=maps.mean(axis=0),
        corridor_s=np.full(grid.corridors, 100.0),
        sensing_s=0.0,
    )
    return replace(plain, **parts)  # type: ignore[arg-type]


@st.composite
def situations(draw: st.DrawFn) -> Situation:
    grid = draw(st.sampled_from([Grid(2, 2), Grid(3, 2), Grid(3, 3)]))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    maps = rng.permutation(every_map(grid))[: draw(st.integers(1, 200))]
    tasks = draw(st.integers(0, 3))
    place, goal = rng.permutation(grid.intersections)[:2].tolist()
    return situation(
        grid,
        maps,
        place,
        goal,
        tasks=rng.integers(0, grid.intersections, (tasks, 2)),
        expected=rng.uniform(0, 4, tasks),
        sensing_s=draw(st.sampled_from([0.0, 60.0])),
    )


@settings(max_examples=60, deadline=None)
@given(situations(), st.sampled_from((1, 2, 4, 8, 16)))
def test_the_cells_known_beforehand_suffice_and_every_answer_can_be_driven(
    s: Situation, worlds: int
) -> None:
    found = decide_by_outlook(s, worlds).decision
    types = np.unique(s.grid.junction_types(s.maps)[:, s.place])
    legs = len(errands_of(s).goals)
    assert found.cells <= outlook_cells(s.grid, worlds, len(types), legs)
    for junction_type in types[types > 0].tolist():
        assert found.direction[junction_type] in DIRECTIONS
        assert found.direction[junction_type] & junction_type
    outlook = decide_by_outlook(s, worlds)
    again = outlook.decision
    # The way out is the cheapest there is, and what it costs is the better of the two values.
    for junction_type in np.flatnonzero(~np.isnan(outlook.leaving_s[:, 0])).tolist():
        ways = outlook.leaving_s[junction_type]
        chosen = DIRECTIONS.index(int(found.direction[junction_type]))
        assert ways[chosen] == ways.min()
        assert ways.min() == min(found.known_s[junction_type], found.unknown_s[junction_type])
    assert found.direction.tolist() == again.direction.tolist()
    assert found.unknown_s.tobytes() == again.unknown_s.tobytes()


def test_the_largest_problem_that_fits_is_known_beforehand() -> None:
    grid = Grid(3, 3)
    assert outlook_cells(grid, 4, types=2, legs=3) == 2 * 3 * 2 * (4 * (7 + 9))
    assert most_worlds(grid, 2, 3, 2 * 3 * 2 * 64) == 4
    assert most_worlds(grid, 2, 3, 2 * 3 * 2 * 64 - 1) == 2
    assert most_worlds(grid, 2, 3, 10) is None
    assert most_worlds(grid, 2, 3, 10**9) == WORLDS[-1]


def test_later_errands_are_taken_twice_first_for_what_they_teach() -> None:
    s = situation(
        Grid(3, 2),
        every_map(Grid(3, 2)),
        0,
        5,
        tasks=np.array([[5, 0], [1, 2], [3, 4]]),
        expected=np.array([3.0, 0.5, 0.0]),
    )
    errands = errands_of(s)
    assert errands.goals.tolist() == [5, 5, 0, 1, 2, 5, 0]
    assert errands.weight.tolist() == [1.0, 1.0, 1.0, 0.5, 0.5, 2.0, 2.0]


def test_every_waypoint_is_an_errand_and_cells_count_each_leg() -> None:
    maps = np.ones((1, 7), np.uint8)
    s = situation(Grid(3, 2), maps, 0, 5, waypoints=(5, 2, 3))
    assert errands_of(s).goals.tolist() == [5, 2, 3]
    # each base policy is driven over all three legs
    assert decide_by_outlook(s, 1).decision.cells >= 3 * len(CAUTIONS)


def test_a_way_past_news_is_longer_by_the_sensing() -> None:
    # From 0 to 1 directly 300 s; by 3 and 4 150 s, and 200 s of sensing at 4, where the corridor
    # to 5 may be missing. The first step must be that of the way which was weighed.
    grid = Grid(3, 2)
    maps = np.ones((8, grid.corridors), np.uint8)
    maps[:, grid.corridor(1, 0, EAST)] = 0
    maps[4:, grid.corridor(1, 1, EAST)] = 0
    corridor_s = np.full(grid.corridors, 50.0)
    corridor_s[grid.corridor(0, 0, EAST)] = 300.0
    s = situation(grid, maps, 0, 1, corridor_s=corridor_s, sensing_s=200.0)
    assert decide_by_outlook(s, 8).decision.direction[NORTH | EAST] == EAST
    # It has to come back as well: what is learnt by then serves twice.
    twice = decide_by_outlook(replace(s, waypoints=(1, 0)), 8).decision
    assert twice.direction[NORTH | EAST] == NORTH
    assert decide_by_outlook(replace(s, sensing_s=0.0), 8).decision.direction[NORTH | EAST] == NORTH


def test_sensing_is_paid_where_there_is_anything_to_learn() -> None:
    grid = Grid(2, 2)
    maps = np.ones((8, grid.corridors), np.uint8)
    maps[6:, grid.corridor(1, 0, NORTH)] = 0
    corridor_s = np.full(grid.corridors, 100.0)
    corridor_s[[grid.corridor(0, 0, EAST), grid.corridor(1, 0, NORTH)]] = 30.0, 60.0
    s = situation(grid, maps, 0, 3, corridor_s=corridor_s, sensing_s=20.0)
    found = decide_by_outlook(s, 64).decision
    assert found.unknown_s[NORTH | EAST] == pytest.approx(6 / 8 * 90.0 + 2 / 8 * 260.0 + 20.0)


def test_what_is_as_good_as_known_is_taken_for_known_in_every_map() -> None:
    grid = Grid(2, 2)
    maps = np.ones((8, grid.corridors), np.uint8)
    north = grid.corridor(0, 1, EAST)
    maps[0, north] = 0
    sure = maps.mean(axis=0)
    sure[north] = 0.995
    s = situation(grid, maps, 0, 3, corridor_probability=sure)
    found = decide_by_outlook(s, 64).decision
    assert found.hypotheses == 1
    assert found.known_s[NORTH | EAST] == pytest.approx(200.0)


@pytest.mark.parametrize(("there", "tries"), [(2, False), (6, True)])
def test_a_shorter_way_is_tried_where_that_is_expected_to_take_less(
    there: int, tries: bool
) -> None:
    # From 0 north about to 3 it takes 200 s, sure; east and then north 30 + 60 s where the last
    # corridor exists, in 2 or in 6 of 8 maps, and 30 + 30 + 200 s where it does not.
    grid = Grid(2, 2)
    maps = np.ones((8, grid.corridors), np.uint8)
    maps[there:, grid.corridor(1, 0, NORTH)] = 0
    corridor_s = np.full(grid.corridors, 100.0)
    corridor_s[grid.corridor(0, 0, EAST)] = 30.0
    corridor_s[grid.corridor(1, 0, NORTH)] = 60.0
    found = decide_by_outlook(situation(grid, maps, 0, 3, corridor_s=corridor_s), 64).decision
    at = NORTH | EAST
    # what would take longer even with the whole map seen at its end is not reckoned
    assert found.known_s[at] == (np.inf if tries else pytest.approx(200.0))
    assert found.unknown_s[at] == (pytest.approx(6 / 8 * 90.0 + 2 / 8 * 260.0) if tries else np.inf)
    assert found.explores[at] == tries
    assert found.direction[at] == (EAST if tries else NORTH)
    assert found.hypotheses == 2


def test_what_no_map_has_goes_by_hope_and_spare_time_is_refused() -> None:
    s = situation(Grid(2, 2), np.ones((1, 4), np.uint8), 0, 3)
    found = decide_by_outlook(s, 4).decision
    assert found.direction[EAST] == EAST
    assert np.isinf(found.known_s[EAST])
    with pytest.raises(ValueError, match="without waypoints"):
        decide_by_outlook(replace(s, waypoints=(0,)), 4)
    with pytest.raises(ValueError, match="worlds_per_type is 0"):
        decide_by_outlook(s, 0)


@pytest.mark.parametrize("seed", range(12))
def test_who_follows_it_arrives(seed: int) -> None:
    grid = Grid(3, 3)
    rng = np.random.default_rng(seed)
    maps = rng.permutation(every_map(grid))
    types = grid.junction_types(maps)
    truth = types[0]
    place, goal = rng.permutation(np.flatnonzero(truth))[:2].tolist()
    agree = (types[:, [place, goal]] > 0).all(axis=1)
    came_from, steps = 0, 0
    while place != goal:
        s = situation(
            grid,
            maps[agree],
            place,
            goal,
            came_from=came_from,
            tasks=np.array([[goal, 0], [2, 6]]),
            expected=np.array([2.0, 1.0]),
            sensing_s=60.0,
        )
        direction = int(decide_by_outlook(s, 32).decision.direction[truth[place]])
        agree &= types[:, place] == truth[place]
        x, y = grid.place(place)
        dx, dy = STEP[direction]
        place, came_from = grid.intersection(x + dx, y + dy), OPPOSITE[direction]
        steps += 1
        assert steps <= 2 * grid.corridors
