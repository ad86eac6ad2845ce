"""decide() against the paper's equations, evaluated by enumeration with H = all maps."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.grid import DIRECTIONS, JUNCTION_TYPES, Grid, Maps
from modules.decider import Situation, decide
from tests.decider.path_reference import Expectations, all_maps

every_map = functools.cache(all_maps)


@st.composite
def situations(draw: st.DrawFn, grid: Grid) -> Situation:
    """Any place, errand and tasks; some junctions seen, some only suspected."""
    maps: Maps = every_map(grid)
    types = grid.junction_types(maps)
    places = st.integers(0, grid.intersections - 1)
    truth = draw(st.integers(0, len(maps) - 1))
    seen = sorted(draw(st.sets(places, max_size=2)))
    maps = maps[(types[:, seen] == types[truth, seen]).all(axis=1)]
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    weights = rng.dirichlet(np.ones(len(maps)))
    marginals = weights @ maps
    if draw(st.booleans()):  # say of some corridor that it is known, or improbable, unlike H
        marginals[rng.integers(grid.corridors)] = draw(st.sampled_from([0.0, 0.5, 1.0]))
    place = draw(places)
    x, y = grid.place(place)
    behind = [0] + [d for d in DIRECTIONS if grid.corridor(x, y, d) >= 0]
    tasks = draw(st.lists(st.tuples(places, places), max_size=3))
    return Situation(
        grid=grid,
        place=place,
        came_from=draw(st.sampled_from(behind)),
        waypoints=tuple(draw(st.lists(places, max_size=2))),
        tasks=np.array(tasks, dtype=np.int64).reshape(-1, 2),
        expected=rng.uniform(0, 5, len(tasks)),
        maps=maps,
        weights=weights,
        log_probability=np.log(weights),
        corridor_probability=marginals,
        # no two sums of different powers of two are equal: every shortest path is unique
        corridor_s=rng.permutation(2.0 ** np.arange(grid.corridors)),
        sensing_s=draw(st.sampled_from([0.0, 1.0, 10.0])),
    )


def check(situation: Situation) -> None:
    decision = decide(situation)
    types = set(situation.grid.junction_types(situation.maps)[:, situation.place].tolist())
    for junction_type in range(JUNCTION_TYPES):
        behind = situation.came_from
        if junction_type not in types or junction_type & behind != behind:
            assert decision.known_s[junction_type] == np.inf
            assert decision.unknown_s[junction_type] == np.inf
            continue
        expected = Expectations(situation, junction_type)
        known, options = expected.known(), expected.unknown()
        least = min((value for value, _ in options), default=np.inf)
        assert decision.known_s[junction_type] == pytest.approx(known, rel=1e-9)
        assert decision.unknown_s[junction_type] == pytest.approx(least, rel=1e-9)
        if abs(least - known) > 1e-6:
            assert decision.explores[junction_type] == (least < known)
        if decision.explores[junction_type]:
            best = {direction for value, direction in options if value <= least + 1e-6}
            assert decision.direction[junction_type] in best


@settings(max_examples=200, deadline=None)
@given(situations(Grid(2, 2)))
def test_values_equal_the_equations_on_2x2(situation: Situation) -> None:
    check(situation)


@settings(max_examples=120, deadline=None)
@given(situations(Grid(3, 2)))
def test_values_equal_the_equations_on_3x2(situation: Situation) -> None:
    check(situation)
