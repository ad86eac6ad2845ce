"""Information can have negative value when plans follow the most probable map.

Howard's information value (paper, section 6) is never negative for a plan of least expected cost;
Futures plans with M*_I, the most probable map. More in docs/where-the-paper-errs.md.

    3 -c2- 4 -c3- 5      every corridor takes 240 s
    c4     c5     c6     A = without c4, c6   Pr 0.40
    0 -c0- 1 -c1- 2      B = without c4       Pr 0.32
                         D = without c2, c5   Pr 0.28
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from bus.grid import Grid, Maps
from modules.decider.costs import cost
from modules.decider.futures import FutureTable
from modules.decider.hypotheses import Hypotheses
from modules.decider.roads import roads_of
from modules.decider.value_kernels import Tasks, expectations
from tests.decider.path_reference import all_maps

Floats = NDArray[np.float64]
GRID = Grid(3, 2)
EACH_S = np.full(7, 240.0)
MAPS = np.array([[1, 1, 1, 1, 0, 1, 0], [1, 1, 1, 1, 0, 1, 1], [1, 1, 0, 1, 1, 0, 1]], np.uint8)
WEIGHTS = np.array([0.4, 0.32, 0.28])
TASK = (1, 3)


def cost_table(maps: Maps, task: tuple[int, int]) -> Floats:
    """Cost(T, M_plan, M_true) in seconds, (plan, truth)."""
    return np.array([[cost(GRID, EACH_S, task, plan, true) for true in maps] for plan in maps])


def following_the_most_probable(
    maps: Maps, weights: Floats, task: tuple[int, int], place: int
) -> tuple[float, float]:
    """Expected Futures without and with the junction type at a place, by the decider's table."""
    tasks = Tasks(np.array([task[0]]), np.array([task[1]]), np.ones(1))
    hypotheses = Hypotheses(maps, weights, np.log(weights))
    futures = FutureTable(roads_of(GRID, EACH_S), tasks, hypotheses)
    types = GRID.junction_types(maps)[:, place].astype(np.int64)
    plans = futures.plans_given(np.array([np.zeros_like(types), types]))
    without, informed = expectations(weights, np.zeros(plans.shape), plans, futures.table)
    return float(without), float(informed)


def planning_by_least_cost(costs: Floats, weights: Floats, types: NDArray[np.uint8]) -> float:
    """Expected cost when each type seen is answered by the plan of least expected cost."""
    return sum(float((costs[:, types == t] @ weights[types == t]).min()) for t in np.unique(types))


def test_what_each_plan_costs_under_each_map() -> None:
    # With plan A, 1-4-3; under D c5 is seen to be missing at once, no plan is left, and 1-0-3 is
    # tried: 480 s too. With plan B under D the way round, 1-2-5-4, is still on the map; c2 is
    # found missing at 4: three corridors there, three back, and 1-0-3.
    assert cost_table(MAPS, TASK).tolist() == [
        [480.0, 480.0, 480.0],
        [480.0, 480.0, 1920.0],
        [960.0, 960.0, 480.0],
    ]


def test_to_know_whether_a_corridor_exists_costs_403_seconds() -> None:
    without, informed = following_the_most_probable(MAPS, WEIGHTS, TASK, place=2)
    assert without == pytest.approx(480.0)  # plan A
    # c6 exists: B or D, and B is more probable
    assert informed == pytest.approx((0.4 + 0.32) * 480.0 + 0.28 * 1920.0)
    assert without - informed == pytest.approx(-403.2)


def test_with_plans_of_least_expected_cost_it_costs_nothing() -> None:
    costs, types = cost_table(MAPS, TASK), GRID.junction_types(MAPS)[:, 2]
    assert (costs @ WEIGHTS).min() == pytest.approx(480.0)
    assert planning_by_least_cost(costs, WEIGHTS, types) == pytest.approx(480.0)


SOME = [m for m in all_maps(GRID) if (GRID.junction_types(m[None]) > 0).all()]


@settings(deadline=None, max_examples=60)
@given(
    numbers=st.lists(st.integers(0, len(SOME) - 1), min_size=2, max_size=6, unique=True),
    task=st.tuples(st.integers(0, 5), st.integers(0, 5)),
    place=st.integers(0, 5),
    seed=st.integers(0, 1000),
)
def test_with_plans_of_least_expected_cost_information_never_costs(
    numbers: list[int], task: tuple[int, int], place: int, seed: int
) -> None:
    maps = np.array([SOME[i] for i in numbers])
    weights = np.random.default_rng(seed).dirichlet(np.ones(len(maps)))
    costs, types = cost_table(maps, task), GRID.junction_types(maps)[:, place]
    informed = planning_by_least_cost(costs, weights, types)
    assert informed <= (costs @ weights).min() * (1 + 1e-12)
