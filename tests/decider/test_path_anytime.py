"""The path decision refined until stopped: what it has by then, and why it stopped."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.grid import Grid
from modules.decider import Situation, decide
from modules.decider.anytime import refine
from modules.decider.effort import cells_bound
from tests.decider.path_reference import all_maps

GRID = Grid(3, 3)
UNLIMITED = 10**12
every_map = functools.cache(all_maps)


def situation_of(seed: int, maps: int, expected: float = 10.0) -> Situation:
    """So many equally likely maps, an errand, four expected tasks."""
    rng = np.random.default_rng(seed)
    drawn = every_map(GRID)[rng.integers(0, len(every_map(GRID)), maps)]
    return Situation(
        grid=GRID,
        place=4,
        came_from=0,
        waypoints=(8,),
        tasks=rng.integers(0, 9, (4, 2)),
        expected=rng.uniform(0, expected, 4),
        maps=drawn,
        weights=np.full(maps, 1 / maps),
        log_probability=np.zeros(maps),
        corridor_probability=drawn.mean(axis=0),
        corridor_s=rng.uniform(100, 400, GRID.corridors),
        sensing_s=60.0,
    )


def most_of_a_type(s: Situation) -> int:
    types = s.grid.junction_types(s.maps)[:, s.place]
    return int(np.bincount(types).max())


def types_of(s: Situation) -> int:
    return len(np.unique(s.grid.junction_types(s.maps)[:, s.place]))


def test_it_stops_with_nothing_left_when_every_map_was_used() -> None:
    s = situation_of(1, maps=60)
    refined = refine(s, UNLIMITED, agreeing=100)
    assert refined.stopped == "nothing left"
    assert refined.hypotheses_per_type >= most_of_a_type(s)
    whole = decide(s)
    assert (refined.decision.direction == whole.direction).all()
    assert refined.decision.cells == whole.cells


def test_it_stops_out_of_cells_before_the_size_that_might_not_fit() -> None:
    s = situation_of(1, maps=60)
    one = cells_bound(GRID, 1, 4, types_of(s))
    two = cells_bound(GRID, 2, 4, types_of(s))
    spent = decide(s, 1).cells
    short = refine(s, spent + two - 1, agreeing=100)
    assert (short.stopped, short.hypotheses_per_type) == ("out of cells", 1)
    enough = refine(s, spent + two, agreeing=100)
    assert enough.hypotheses_per_type == 2
    assert refine(s, one - 1).hypotheses_per_type == 0


def test_it_stops_settled_when_doublings_change_nothing() -> None:
    s = situation_of(3, maps=400, expected=0.0)
    refined = refine(s, UNLIMITED, agreeing=2)
    assert refined.stopped == "settled"
    size = refined.hypotheses_per_type
    assert size < most_of_a_type(s)
    for before in (size // 2, size // 4):
        assert (decide(s, before).direction == refined.decision.direction).all()
    assert (decide(s, size // 8).direction != refined.decision.direction).any() or size == 4


def test_to_begin_with_it_takes_the_shortest_consistent_way() -> None:
    s = situation_of(1, maps=60)
    refined = refine(s, 0)
    assert (refined.stopped, refined.hypotheses_per_type, refined.cells) == ("out of cells", 0, 0)
    types = np.arange(16)
    direction = refined.decision.direction
    assert ((direction & types) == direction)[types > 0].all()
    assert direction[1:].all()  # there is an errand: whatever is found, it goes somewhere


def test_without_any_map_there_is_nothing_left_at_once() -> None:
    s = situation_of(1, maps=60)
    none = replace(s, maps=s.maps[:0], weights=s.weights[:0], log_probability=np.empty(0))
    assert refine(none, 0).stopped == "nothing left"


def test_it_needs_at_least_one_doubling_to_agree() -> None:
    with pytest.raises(ValueError, match="agreeing is 0, expected at least 1"):
        refine(situation_of(1, maps=4), UNLIMITED, agreeing=0)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 120), st.integers(0, 20_000), st.integers(1, 4))
def test_it_never_touches_more_cells_than_it_was_given(
    seed: int, maps: int, cells: int, agreeing: int
) -> None:
    s = situation_of(seed, maps)
    refined = refine(s, cells, agreeing)
    assert refined.cells <= cells
    if refined.stopped == "nothing left":
        assert (refined.decision.direction == decide(s).direction).all()
    if refined.hypotheses_per_type:
        same = decide(s, refined.hypotheses_per_type)
        assert (refined.decision.direction == same.direction).all()
    if refined.stopped == "out of cells":
        wanted = max(1, 2 * refined.hypotheses_per_type)
        assert refined.cells + cells_bound(GRID, wanted, 4, types_of(s)) > cells
