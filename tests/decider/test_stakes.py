"""What a wrong type of the junction ahead costs: by hand, in general, and what it takes to say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings

from bus.grid import EAST, NORTH, SOUTH, WEST, Grid
from modules.decider import Situation
from modules.decider.outlook import decide_by_outlook
from modules.decider.stakes import (
    MAPS,
    coming_back_s,
    most_maps,
    regret_of_leaving,
    regret_s,
    stakes_cells,
    stakes_of,
)
from tests.decider.test_outlook import situation, situations


@settings(max_examples=60, deadline=None)
@given(situations())
def test_a_regret_is_never_negative_and_none_where_the_type_is_right(s: Situation) -> None:
    for maps in (1, 4, 64):
        stakes = stakes_of(s, maps)
        assert (stakes.later_s >= 0.0).all()
        assert not stakes.later_s.diagonal().any()
        assert stakes.cells <= stakes_cells(maps, len(stakes.types), len(s.tasks))
        whole = regret_s(s, stakes, decide_by_outlook(s, maps))
        assert np.isfinite(whole).all()
        assert (whole >= 0.0).all()
        assert not whole.diagonal().any()
        off = ~np.eye(len(stakes.types), dtype=bool)
        assert (whole[np.ix_(stakes.types, stakes.types)][off] >= coming_back_s(s)).all()


@settings(max_examples=30, deadline=None)
@given(situations())
def test_where_no_errand_is_left_a_later_regret_is_none(s: Situation) -> None:
    assert not stakes_of(replace(s, expected=np.zeros(len(s.tasks))), 16).later_s.any()


def ring(times: float) -> Situation:
    """Four corridors of 100 s in a ring, where the one north of (1, 0) may be missing."""
    grid = Grid(2, 2)
    maps = np.ones((2, 4), np.uint8)
    maps[1, grid.corridor(1, 0, NORTH)] = 0
    tasks = np.array([[1, 3], [3, 1]])
    return situation(grid, maps, 1, 2, tasks=tasks, expected=np.full(2, times))


@pytest.mark.parametrize("times", [0.0, 1.0, 2.5])
def test_a_corridor_that_is_thought_away_costs_the_way_round_each_time(times: float) -> None:
    stakes = stakes_of(ring(times), 8)
    # By (1, 0) north it is 100 s both ways, round the other three 300 s. A corridor that is
    # not there is found out where the way would begin, and costs nothing more.
    assert stakes.types == (WEST, NORTH | WEST)
    assert stakes.later_s.tolist() == [[0.0, pytest.approx(2 * times * 200.0)], [0.0, 0.0]]


@pytest.mark.parametrize(("times", "found_out"), [(0.25, 0.25), (1.0, 1.0), (3.0, 1.0)])
def test_what_cannot_be_reached_is_found_out_by_the_first_errand(
    times: float, found_out: float
) -> None:
    grid = Grid(3, 1)
    maps = np.array([[1, 1], [1, 0]], np.uint8)
    s = situation(grid, maps, 1, 0, tasks=np.array([[1, 2]]), expected=np.full(1, times))
    stakes = stakes_of(s, 8)
    assert stakes.types == (WEST, EAST | WEST)
    # The whole building both ways, 400 s; then the way is known.
    assert stakes.later_s[0, 1] == pytest.approx(found_out * 400.0)


def test_a_known_map_leaves_nothing_to_regret_but_having_to_come_back() -> None:
    s = ring(3.0)
    known = replace(
        s,
        maps=s.maps[:1],
        weights=np.ones(1),
        log_probability=np.zeros(1),
        corridor_probability=s.maps[0].astype(float),
    )
    stakes = stakes_of(known, 8)
    assert stakes.types == (NORTH | WEST,)
    assert not stakes.later_s.any()
    whole = regret_s(known, stakes, decide_by_outlook(known, 8))
    assert whole.max() == coming_back_s(known) == 200.0


def test_a_corridor_on_nobodys_way_costs_later_errands_nothing() -> None:
    # Along the first row of a ladder; the last rung, north of (2, 0), may be missing.
    grid = Grid(3, 2)
    maps = np.ones((2, grid.corridors), np.uint8)
    maps[1, grid.corridor(2, 0, NORTH)] = 0
    tasks = np.array([[0, 2], [3, 4]])
    s = situation(grid, maps, 2, 0, tasks=tasks, expected=np.full(2, 5.0))
    assert not stakes_of(s, 8).later_s.any()
    assert stakes_of(replace(s, tasks=np.array([[2, 5], [3, 4]])), 8).later_s[0, 1] > 0.0


def test_the_plan_for_a_type_is_that_of_least_expected_cost() -> None:
    # From (0, 1) to (2, 1) along the second row 200 s; round by the first 400 s, which a plan that
    # takes the last corridor for missing drives in vain. Without the first rung, a quarter of the
    # maps miss that corridor; with it none. Who hopes for it loses nothing where it is.
    grid = Grid(3, 2)
    maps = np.ones((8, grid.corridors), np.uint8)
    maps[:4, grid.corridor(0, 0, NORTH)] = 0
    maps[0, grid.corridor(1, 1, EAST)] = 0
    s = situation(grid, maps, 0, 1, tasks=np.array([[3, 5]]), expected=np.ones(1))
    stakes = stakes_of(s, 8)
    assert stakes.types == (EAST, NORTH | EAST)
    assert not stakes.later_s.any()


def test_the_way_out_for_one_type_is_weighed_where_another_is_true() -> None:
    grid = Grid(2, 2)
    s = ring(0.0)
    # To (0, 1) from (1, 0): 200 s either way. With the north dearer, back west is the choice.
    dear = s.corridor_s.copy()
    dear[grid.corridor(1, 0, NORTH)] = 50.0
    outlook = decide_by_outlook(replace(s, corridor_s=dear), 8)
    at = NORTH | WEST
    assert outlook.decision.direction[[WEST, at]].tolist() == [WEST, NORTH]
    # West is worse than north whatever is seen there, so it counts as north after there and back.
    assert outlook.leaving_s[at].tolist() == pytest.approx([150.0, np.inf, np.inf, 350.0])
    regret = regret_of_leaving(outlook)
    assert regret[WEST, at] == pytest.approx(200.0)
    assert regret[at, WEST] == 0.0  # no such way: found out at once
    assert np.count_nonzero(regret) == 1


def test_types_without_a_map_count_as_the_worst_of_the_others() -> None:
    s = ring(2.0)
    whole = regret_s(s, stakes_of(s, 8), decide_by_outlook(s, 8))
    most = 800.0 + regret_of_leaving(decide_by_outlook(s, 8))[WEST, NORTH | WEST]
    assert whole[WEST, NORTH | WEST] == pytest.approx(most)
    assert whole[SOUTH, EAST] == whole[WEST, EAST] == pytest.approx(most)
    assert whole[NORTH | WEST, WEST] == coming_back_s(s) == 200.0


def test_the_largest_problem_that_fits_is_known_beforehand() -> None:
    assert stakes_cells(4, types=2, tasks=3) == 2 * 4 * (4 + 2) * 3
    assert most_maps(2, 3, 144) == 4
    assert most_maps(2, 3, 143) == 2
    assert most_maps(2, 3, 17) is None
    assert most_maps(2, 3, 10**9) == MAPS[-1]
    with pytest.raises(ValueError, match="maps_per_type is 0"):
        stakes_of(ring(1.0), 0)
