"""The planner against exact dynamic programming, bounds, and itself."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from benchmarks.ctp import Traveller, delaunay, weathers_of
from bus.grid import Grid
from modules.decider.roads import roads_of
from modules.decider.traveller import (
    FREE,
    UNKNOWN,
    Errands,
    Instance,
    Moves,
    PlanError,
    independent_worlds,
    least_cells,
    look_ahead,
)
from modules.decider.traveller.errand_kernels import mean_cost
from modules.decider.traveller.lookahead import CAUTIONS
from modules.decider.traveller.way_kernels import learn
from modules.decider.traveller.world_kernels import clairvoyant
from tests.decider.traveller_reference import all_weathers, exact, exact_moves, instances, ladder

slow = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])


def at_start(instance: Instance, seed_world: int = -1) -> tuple[NDArray[np.uint8], ...]:
    """What is known at the start in one weather, and every weather that agrees."""
    known = np.full(len(instance.cost), UNKNOWN, dtype=np.uint8)
    learn(instance.roads(), known, all_weathers(instance)[seed_world], 0)
    return known, all_weathers(instance, known)


def repeated(worlds: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """The same distribution, with enough worlds of each kind to look into every leaf."""
    return np.repeat(worlds, 8, axis=0)


@slow
@given(instances(6, 9), st.integers(0, 10**6))
def test_with_room_enough_the_plan_is_the_exact_optimum(instance: Instance, seed: int) -> None:
    known, every = at_start(instance)
    # a dozen worlds: edges depend on each other, and the first plan is often not the best
    once = every[np.random.default_rng(seed).permutation(len(every))[:12]]
    worlds = repeated(once)
    cells = 100 * least_cells(instance.vertices, len(worlds))
    found = look_ahead(instance.roads(), known, 0, instance.goal, worlds, cells)
    assert found.expected.min() == pytest.approx(exact(instance, once, 0), rel=1e-8)
    assert found.cells < cells


@slow
@given(instances())
def test_bounds_hold_at_every_budget(instance: Instance) -> None:
    known, worlds = at_start(instance)
    best = exact(instance, worlds, 0)
    least = least_cells(instance.vertices, len(worlds))
    for cells in (least, 2 * least, 50 * least):
        found = look_ahead(instance.roads(), known, 0, instance.goal, worlds, cells)
        assert found.cells <= cells
        assert found.expected.min() >= best - 1e-9
        assert (found.bound <= found.expected + 1e-9).all()
        assert found.bound.min() <= best + 1e-9


@slow
@given(instances())
def test_never_worse_than_any_base_policy_and_never_better_than_the_clairvoyant(
    instance: Instance,
) -> None:
    known, worlds = at_start(instance)
    roads = instance.roads()
    least = least_cells(instance.vertices, len(worlds))
    found = look_ahead(roads, known, 0, instance.goal, worlds, least)
    hope = roads.seconds  # the first of CAUTIONS
    errands = Errands(np.array([instance.goal]), np.ones(1), 0.0)
    optimist = mean_cost(roads, errands, worlds, np.ones(len(worlds)), known, hope, 0)
    seer = clairvoyant(roads, worlds, instance.goal)[:, 0].mean()
    assert CAUTIONS[0] == (0.0, 0.0)
    assert seer - 1e-9 <= found.expected.min() <= optimist + 1e-9


@slow
@given(instances())
def test_more_room_never_expects_more(instance: Instance) -> None:
    known, worlds = at_start(instance)
    least = least_cells(instance.vertices, len(worlds))
    values = [
        look_ahead(instance.roads(), known, 0, instance.goal, worlds, k * least).expected.min()
        for k in (1, 2, 4, 8, 16)
    ]
    assert all(b <= a + 1e-9 for a, b in pairwise(values))


def test_edges_that_depend_on_each_other_are_used_as_such() -> None:
    # Going by 1 costs more than the sure way 0 - 4, but 0 - 1 shows whether 2 - 4 is free:
    # in half the worlds both 1 - 2 and 2 - 4 are free, in the others neither.
    ends = np.array([[0, 1], [1, 2], [2, 4], [0, 3], [3, 4]])
    instance = Instance(5, ends, np.ones(5), np.array([1.0, 1.0, 1.0, 5.0, 5.0]))
    together = np.array([[1, 1, 1, 1, 1], [1, 0, 0, 1, 1]] * 20, dtype=np.uint8)
    apart = np.array([[1, a, b, 1, 1] for a in (0, 1) for b in (0, 1)] * 10, dtype=np.uint8)
    known = np.array([FREE, UNKNOWN, UNKNOWN, FREE, UNKNOWN], dtype=np.uint8)
    for worlds, expected in ((together, 7.5), (apart, 10.0)):
        found = look_ahead(instance.roads(), known, 0, 4, worlds, 4000)
        by_1 = found.expected[found.to.tolist().index(1)]
        # together: 3 or 1 + 1 + 10; apart: 3, 4 + 10, 12 or 12
        assert by_1 == pytest.approx(7.5 if worlds is together else 10.25)
        assert found.expected.min() == pytest.approx(expected)
        assert exact_moves(instance, worlds, 0)[1] == pytest.approx(by_1)


def test_a_grid_of_connected_maps_is_planned_on_exactly() -> None:
    # the decider's own graph, where a direction off the grid leaves a gap among the corridors
    grid = Grid(3, 2)
    every = (np.arange(1 << grid.corridors)[:, None] >> np.arange(grid.corridors) & 1).astype(
        np.uint8
    )
    corridor_s = np.linspace(10.0, 16.0, grid.corridors)
    roads = roads_of(grid, corridor_s)
    place, goal = 0, grid.intersections - 1
    instance = Instance(
        grid.intersections,
        np.array([grid.ends(c) for c in range(grid.corridors)]),
        np.ones(grid.corridors),
        corridor_s,
    )
    joined = np.isfinite(clairvoyant(roads, every, goal)[:, place])
    for seed in range(6):
        rng = np.random.default_rng(seed)
        truth = every[rng.choice(np.flatnonzero(joined))]
        known = np.full(grid.corridors, UNKNOWN, dtype=np.uint8)
        learn(roads, known, truth, place)
        fits = joined & ((every == (known == FREE)) | (known == UNKNOWN)).all(axis=1)
        once = every[fits]
        worlds = repeated(once)
        cells = 100 * least_cells(grid.intersections, len(worlds))
        found = look_ahead(roads, known, place, goal, worlds, cells)
        assert found.expected.min() == pytest.approx(exact(instance, once, place), rel=1e-8)


def test_the_same_question_has_the_same_answer_bit_for_bit() -> None:
    instance = ladder(24, 1)
    roads = instance.roads()
    known = np.full(len(instance.cost), UNKNOWN, dtype=np.uint8)
    learn(roads, known, weathers_of(instance, 1, 5)[0], 0)

    def ask() -> Moves:
        rng = np.random.default_rng(7)
        p = instance.probability
        worlds = independent_worlds(roads, p, known, 0, instance.goal, 200, rng)
        return look_ahead(roads, known, 0, instance.goal, worlds, 9000)

    one, other = ask(), ask()
    for part in ("to", "cost", "expected", "bound"):
        assert getattr(one, part).tobytes() == getattr(other, part).tobytes()
    assert one.cells == other.cells <= 9000


@pytest.mark.parametrize("vertices", [20, 50, 100])
def test_weathers_are_driven_to_their_goal_and_never_below_the_clairvoyant(vertices: int) -> None:
    instance = delaunay(vertices, 1)
    weathers = weathers_of(instance, 2 if vertices < 100 else 1, 3)
    roads = instance.roads()
    seer = clairvoyant(roads, weathers, instance.goal)[:, 0]
    for planner in ("optimistic", "waywiser"):
        traveller = Traveller(instance, roads, planner)
        for weather, least in zip(weathers, seer, strict=True):
            assert traveller.drive(weather) >= least - 1e-9


def test_over_many_weathers_it_costs_less_than_the_optimist() -> None:
    instance = ladder(12, 2)
    weathers = weathers_of(instance, 150, 9)
    roads = instance.roads()
    mean = {}
    for planner in ("optimistic", "hindsight", "rollout", "waywiser"):
        traveller = Traveller(instance, roads, planner)
        mean[planner] = np.mean([traveller.drive(w) for w in weathers])
    assert mean["waywiser"] <= mean["optimistic"]
    assert mean["waywiser"] <= 1.02 * min(mean.values())


def test_questions_that_make_no_sense_are_refused() -> None:
    ends = np.array([[0, 1], [1, 2], [0, 2]])
    roads = Instance(3, ends, np.ones(3), np.ones(3)).roads()
    known = np.array([FREE, UNKNOWN, FREE], dtype=np.uint8)
    fits = np.ones((4, 3), dtype=np.uint8)

    def refused(
        said: str,
        *,
        known: NDArray[np.uint8] = known,
        worlds: NDArray[np.uint8] = fits,
        cells: int = 1000,
    ) -> None:
        with pytest.raises(PlanError, match=said):
            look_ahead(roads, known, 0, 2, worlds, cells)

    refused(r"worlds have shape \(0, 3\), expected \(1 or more, 3\)", worlds=fits[:0])
    refused(r"known has shape \(2,\), expected \(3,\)", known=known[:2])
    refused("edge 0 of 0 is unknown", known=np.full(3, UNKNOWN, dtype=np.uint8))
    refused("39 cells, expected at least 40 for 4 worlds and 3 vertices", cells=39)
    lies = fits.copy()
    lies[2, 0] = 0
    refused("world 2 contradicts what is known of edge 0", worlds=lies)
    cut = np.array([FREE, UNKNOWN, 0], dtype=np.uint8)
    lost = np.array([[1, 1, 0], [1, 0, 0]], dtype=np.uint8)
    refused("world 1 has no way from 0 to 2", known=cut, worlds=lost)
