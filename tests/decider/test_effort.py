from __future__ import annotations

import functools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.grid import Grid
from modules.decider import LADDER, Situation, cells_bound, decide, largest_that_fits
from modules.decider import cost as cost_of
from modules.decider.futures import FutureTable
from modules.decider.hypotheses import Hypotheses
from modules.decider.roads import roads_of
from modules.decider.value_kernels import Tasks
from tests.decider.path_reference import all_maps

every_map = functools.cache(all_maps)


@st.composite
def situations(draw: st.DrawFn) -> Situation:
    grid = draw(st.sampled_from([Grid(2, 2), Grid(3, 2), Grid(3, 3)]))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    maps = rng.permutation(every_map(grid))[: draw(st.integers(1, 400))]
    n, tasks = len(maps), draw(st.integers(0, 5))
    weights = rng.dirichlet(np.ones(n))
    return Situation(
        grid=grid,
        place=int(rng.integers(grid.intersections)),
        came_from=0,
        waypoints=tuple(rng.integers(0, grid.intersections, draw(st.integers(0, 3))).tolist()),
        tasks=rng.integers(0, grid.intersections, (tasks, 2)),
        expected=rng.uniform(0, 9, tasks),
        maps=maps,
        weights=weights,
        log_probability=np.log(weights),
        corridor_probability=weights @ maps,
        corridor_s=np.full(grid.corridors, 240.0),
        sensing_s=60.0,
    )


@settings(max_examples=100, deadline=None)
@given(situations(), st.sampled_from(LADDER))
def test_the_bound_known_beforehand_holds(s: Situation, hypotheses: int) -> None:
    types = len(np.unique(s.grid.junction_types(s.maps)[:, s.place]))
    bound = cells_bound(s.grid, hypotheses, len(s.tasks), types, len(s.waypoints))
    assert decide(s, hypotheses).cells <= bound


def test_the_bound_by_hand() -> None:
    # 2 x 2 has 4 intersections, so at most 5 options. 4 maps, 3 tasks, 2 types, 2 legs:
    # 4 * 5 * 2 costs of the errand, 4 * 4 pairs of maps with 3 tasks each: 40 + 48 = 88 a type.
    assert cells_bound(Grid(2, 2), 4, tasks=3, types=2, waypoints=2) == 176
    # 8 maps: not all 64 pairs can be asked for, only 5 * 8: 80 + 120 = 200 a type.
    assert cells_bound(Grid(2, 2), 8, tasks=3, types=2, waypoints=2) == 400


def test_the_largest_problem_that_fits_is_chosen() -> None:
    grid = Grid(3, 3)
    bounds = [cells_bound(grid, h, 8, 8) for h in LADDER]
    assert bounds == sorted(bounds)
    for hypotheses, bound in zip(LADDER, bounds, strict=True):
        assert largest_that_fits(grid, 8, 8, bound) == hypotheses
    assert largest_that_fits(grid, 8, 8, bounds[2] - 1) == LADDER[1]
    assert largest_that_fits(grid, 8, 8, bounds[0] - 1) is None


@pytest.mark.parametrize("seed", range(3))
def test_a_pair_of_plan_and_truth_is_reckoned_at_most_once(seed: int) -> None:
    rng = np.random.default_rng(seed)
    grid = Grid(3, 2)
    maps = rng.permutation(every_map(grid))[:20]
    n = len(maps)
    corridor_s = rng.uniform(100, 300, grid.corridors)
    tasks = Tasks(np.array([0, 5]), np.array([4, 1]), np.array([2.0, 3.0]))
    hypotheses = Hypotheses(maps, np.full(n, 1 / n), rng.normal(size=n))
    futures = FutureTable(roads_of(grid, corridor_s), tasks, hypotheses)
    observed = rng.integers(0, 4, (6, n))  # six options, each tells four groups apart
    asked = set()
    for half in (observed[:3], observed[3:], observed):
        plans = futures.plans_given(half)
        asked |= {(int(p), j) for row in plans for j, p in enumerate(row)}
        assert futures.reckoned == len(asked) == np.isfinite(futures.table).sum()
    for plan, truth in sorted(asked):
        by_task = [
            e * cost_of(grid, corridor_s, (a, b), maps[plan], maps[truth])
            for a, b, e in zip(*tasks, strict=True)
        ]
        assert futures.table[plan, truth] == sum(by_task)
