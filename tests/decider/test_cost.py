from __future__ import annotations

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from bus.grid import Grid
from modules.decider import cost
from tests.decider.path_reference import reference_cost

# 3 -c2- 4 -c3- 5      north row: 20 s a corridor; all others 10 s, but c4 20 s
# c4     c5     c6
# 0 -c0- 1 -c1- 2
LADDER_3X2 = Grid(3, 2)
SECONDS = np.array([10.0, 10, 20, 20, 20, 10, 10])


def corridors(*present: int) -> NDArray[np.uint8]:
    row = np.zeros(LADDER_3X2.corridors, dtype=np.uint8)
    row[list(present)] = 1
    return row


def test_a_right_plan_costs_its_shortest_path() -> None:
    plan = corridors(0, 1, 6)  # 0-1-2-5: 10 + 10 + 10
    assert cost(LADDER_3X2, SECONDS, (0, 5), plan, plan) == 30.0


def test_what_the_plan_lacks_does_not_help_while_the_plan_holds() -> None:
    plan = corridors(4, 2, 3)  # 0-3-4-5: 20 + 20 + 20, though 0-1-2-5 is there too
    assert cost(LADDER_3X2, SECONDS, (0, 5), plan, corridors(0, 1, 2, 3, 4, 6)) == 60.0


def test_followed_until_contradicted_then_replanned_in_the_corrected_plan() -> None:
    plan = corridors(0, 1, 2, 3, 4, 6)
    truth = corridors(0, 1, 2, 3, 4)
    # 0-1-2 takes 20; c6 is missing; back 2-1-0 takes 20, then 0-3-4-5 takes 60
    assert cost(LADDER_3X2, SECONDS, (0, 5), plan, truth) == 20 + 20 + 60


def test_without_a_corrected_plan_all_that_was_not_seen_absent_may_exist() -> None:
    plan = corridors(0, 1, 6)
    truth = corridors(0, 1, 3, 5)
    # 0-1-2 takes 20; c6 is missing and the plan has no other path; hoping for c3 it goes
    # 2-1-4-5, over c5 that it saw when it passed 1: 10 + 10 + 20
    assert cost(LADDER_3X2, SECONDS, (0, 5), plan, truth) == 20 + 40


def test_hope_may_fail_and_is_then_corrected_too() -> None:
    plan = corridors(0, 1, 6)
    truth = corridors(0, 1, 2, 3, 4)
    # as above to 2 (20), but c5 was seen to be absent at 1: 2-1-0-3-4-5 = 20 + 60
    assert cost(LADDER_3X2, SECONDS, (0, 5), plan, truth) == 20 + 80


def test_an_unreachable_goal_costs_every_corridor_both_ways() -> None:
    plan = corridors(0, 1, 6)
    assert cost(LADDER_3X2, SECONDS, (0, 5), plan, corridors(0, 1)) == 2 * SECONDS.sum()


def test_going_nowhere_is_free() -> None:
    assert cost(LADDER_3X2, SECONDS, (4, 4), corridors(0), corridors(0)) == 0.0


cases = st.sampled_from([Grid(2, 2), Grid(3, 2), Grid(3, 3), Grid(4, 1)]).flatmap(
    lambda grid: st.tuples(
        st.just(grid),
        # few different times, so that ties are common
        st.lists(st.integers(1, 3), min_size=grid.corridors, max_size=grid.corridors),
        st.tuples(st.integers(0, grid.intersections - 1), st.integers(0, grid.intersections - 1)),
        st.integers(0, 2**grid.corridors - 1),
        st.integers(0, 2**grid.corridors - 1),
    )
)


def bits(number: int, length: int) -> NDArray[np.uint8]:
    return np.array([number >> k & 1 for k in range(length)], dtype=np.uint8)


def true_length(
    grid: Grid, seconds: list[int], corridors: NDArray[np.uint8], task: tuple[int, int]
) -> float:
    graph = nx.Graph()
    graph.add_nodes_from(range(grid.intersections))
    for c in np.flatnonzero(corridors).tolist():
        graph.add_edge(*grid.ends(c), weight=seconds[c])
    try:
        return float(nx.dijkstra_path_length(graph, *task))
    except nx.NetworkXNoPath:
        return float("inf")


@settings(max_examples=300, deadline=None)
@given(cases)
def test_cost_equals_the_reference(
    case: tuple[Grid, list[int], tuple[int, int], int, int],
) -> None:
    grid, seconds, task, plan_bits, truth_bits = case
    plan, truth = bits(plan_bits, grid.corridors), bits(truth_bits, grid.corridors)
    found = cost(grid, np.array(seconds, dtype=np.float64), task, plan, truth)
    assert found == reference_cost(grid, [float(s) for s in seconds], task, plan, truth)


@settings(max_examples=200, deadline=None)
@given(cases)
def test_cost_is_never_below_the_true_shortest_path(
    case: tuple[Grid, list[int], tuple[int, int], int, int],
) -> None:
    grid, seconds, task, plan_bits, truth_bits = case
    plan, truth = bits(plan_bits, grid.corridors), bits(truth_bits, grid.corridors)
    found = cost(grid, np.array(seconds, dtype=np.float64), task, plan, truth)
    shortest = true_length(grid, seconds, truth, task)
    assert found == 2 * sum(seconds) if shortest == np.inf else found >= shortest


@settings(max_examples=200, deadline=None)
@given(cases)
def test_cost_of_a_plan_that_is_a_subgraph_of_the_truth_is_its_shortest_path(
    case: tuple[Grid, list[int], tuple[int, int], int, int],
) -> None:
    grid, seconds, task, plan_bits, truth_bits = case
    plan, truth = (
        bits(plan_bits & truth_bits, grid.corridors),
        bits(truth_bits, grid.corridors),
    )
    shortest = true_length(grid, seconds, plan, task)
    if shortest < np.inf:
        found = cost(grid, np.array(seconds, dtype=np.float64), task, plan, truth)
        assert found == pytest.approx(shortest, abs=0)
