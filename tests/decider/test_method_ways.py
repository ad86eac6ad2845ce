"""Section 4's weights and best paths, against every simple path in exact fractions."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.grid import Grid
from modules.decider.methods import best_way, corridor_weights
from modules.decider.methods.ways import corridors_of
from modules.decider.roads import IMPROBABLE, OPEN, PLANNED, SEEN_ABSENT, roads_of
from tests.decider.simple_paths import product, simple_paths, weight

GRID = Grid(3, 3)
EQUAL = roads_of(GRID, np.ones(GRID.corridors))
UNEQUAL = roads_of(GRID, np.array([3.0, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8]))
SOME_LEVELS = st.lists(
    st.sampled_from([SEEN_ABSENT, OPEN, OPEN, PLANNED]), min_size=12, max_size=12
)
SOME_MAPS = st.integers(0, 9).flatmap(
    lambda n: st.lists(
        st.lists(st.integers(0, 1), min_size=12, max_size=12), min_size=n, max_size=n
    )
)


def test_weights_are_those_of_the_paper() -> None:
    maps = np.array([[1, 1, 0, 1], [1, 0, 0, 0], [1, 0, 0, 1]], dtype=np.uint8)
    levels = np.array([OPEN, OPEN, OPEN, PLANNED], dtype=np.uint8)
    third = np.full(3, 1 / 3)
    # (m + 1) / (|H| + 1) with m = 3, 1, 0 of 3 maps; the last is known to exist.
    assert corridor_weights(levels, maps, third) == pytest.approx([1, 2 / 4, 1 / 4, 1])
    absent = np.array([SEEN_ABSENT, IMPROBABLE, OPEN, OPEN], dtype=np.uint8)
    assert corridor_weights(absent, maps, third) == pytest.approx([0, 0, 1 / 4, 3 / 4])


def test_unequal_maps_count_by_their_share() -> None:
    maps = np.array([[1, 0], [0, 1]], dtype=np.uint8)
    levels = np.full(2, OPEN, dtype=np.uint8)
    found = corridor_weights(levels, maps, np.array([0.75, 0.25]))
    assert found == pytest.approx([2.5 / 3, 1.5 / 3])


def test_without_hypotheses_everything_may_be_there() -> None:
    levels = np.array([OPEN, SEEN_ABSENT], dtype=np.uint8)
    assert corridor_weights(levels, np.empty((0, 2), np.uint8), np.empty(0)).tolist() == [1, 0]


def test_shapes_that_do_not_fit_are_refused() -> None:
    with pytest.raises(ValueError, match=r"expected \(n, 2\)"):
        corridor_weights(np.zeros(2, np.uint8), np.ones((3, 4), np.uint8), np.ones(3) / 3)


@settings(max_examples=150, deadline=None)
@given(SOME_LEVELS, SOME_MAPS, st.integers(0, 8), st.integers(0, 8), st.booleans())
def test_the_best_way_has_the_largest_product_and_is_the_shortest_of_those(
    levels: list[int], maps: list[list[int]], place: int, goal: int, equal: bool
) -> None:
    roads = EQUAL if equal else UNEQUAL
    known = np.array(levels, dtype=np.uint8)
    given_maps = np.array(maps, dtype=np.uint8).reshape(-1, 12)
    exact = [weight(known[c], given_maps[:, c]) for c in range(12)]
    n = len(given_maps)
    weights = corridor_weights(known, given_maps, np.full(n, 1 / max(1, n)))
    paths = list(simple_paths(roads, place, goal))
    best = max(product(p, exact) for p in paths)
    shortest = min(sum(roads.seconds[list(p)].tolist()) for p in paths if product(p, exact) == best)
    way = best_way(roads, "section 4", known, weights, place, goal)
    if best == 0:
        assert way.steps == () and way.first == np.inf
        return
    taken = tuple(corridors_of(roads, place, way.steps))
    assert product(taken, exact) == best
    assert way.first == pytest.approx(-math.log(best), abs=1e-9)
    assert way.seconds == pytest.approx(shortest)
    assert sum(roads.seconds[list(taken)].tolist()) == pytest.approx(shortest)
    assert way.known == all(known[c] == PLANNED for c in taken)


@settings(max_examples=60, deadline=None)
@given(SOME_LEVELS, st.integers(0, 8), st.integers(0, 8))
def test_the_alternatives_are_best_in_their_own_order(
    levels: list[int], place: int, goal: int
) -> None:
    known = np.array(levels, dtype=np.uint8)
    weights = np.where(known == OPEN, 0.5, known == PLANNED)
    paths = [p for p in simple_paths(UNEQUAL, place, goal) if all(known[c] >= OPEN for c in p)]
    if not paths:
        return
    seconds = UNEQUAL.seconds.tolist()
    length = {p: sum(seconds[c] for c in p) for p in paths}
    trodden = {p: sum(seconds[c] for c in p if known[c] == PLANNED) for p in paths}
    shortest = best_way(UNEQUAL, "shortest", known, weights, place, goal)
    assert shortest.seconds == min(length.values())
    avoiding = best_way(UNEQUAL, "avoid known", known, weights, place, goal)
    assert (avoiding.first, avoiding.seconds) == min((trodden[p], length[p]) for p in paths)


def test_ties_go_to_the_shorter_and_then_to_north_east_south_west() -> None:
    grid = Grid(2, 2)
    levels = np.full(4, OPEN, dtype=np.uint8)
    weights = np.full(4, 0.5)
    level = roads_of(grid, np.ones(4))
    assert best_way(level, "section 4", levels, weights, 0, 3).steps == (0, 1)
    # The same product by either way, but east first is shorter.
    east = roads_of(grid, np.array([1.0, 2.0, 1.0, 1.0]))
    assert best_way(east, "section 4", levels, weights, 0, 3).steps == (1, 0)
    # Products beat lengths: 0.5 * 0.5 against 0.6 * 0.5.
    better = np.array([0.5, 0.5, 0.6, 0.5])
    assert best_way(east, "section 4", levels, better, 0, 3).steps == (0, 1)


def test_equal_products_of_different_factors_tie() -> None:
    # 0-2-3 is 1/3 * 3/4, 0-1-3 is 1/2 * 1/2: both 1/4, and the second is shorter.
    roads = roads_of(Grid(2, 2), np.array([1.0, 2.0, 1.0, 1.0]))
    levels = np.full(4, OPEN, dtype=np.uint8)
    weights = np.array([0.5, 0.75, float(Fraction(1, 3)), 0.5])
    assert best_way(roads, "section 4", levels, weights, 0, 3).steps == (1, 0)


def test_what_is_as_good_as_absent_is_a_last_resort() -> None:
    levels = np.array([SEEN_ABSENT, OPEN, IMPROBABLE, OPEN], dtype=np.uint8)
    roads = roads_of(Grid(2, 2), np.ones(4))
    weights = np.where(levels == OPEN, 0.5, 0.0)
    assert best_way(roads, "section 4", levels, weights, 0, 3).steps == (0, 1)


def test_random_follows_no_way() -> None:
    with pytest.raises(ValueError, match="random"):
        best_way(EQUAL, "random", np.ones(12, np.uint8), np.ones(12), 0, 1)
