"""The shipped random office: connected, of medium density, another for every seed, and it runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.grid import Grid
from scenarios.draw import draw
from scenarios.scenario import check, find, load
from tests.scenarios.launches import ended, start, waywiser


@given(seed=st.integers(0, 2**63 - 1))
def test_every_seed_draws_a_connected_office_of_medium_density(seed: int) -> None:
    drawn = draw(load(find("office-4x4"), seed=seed), "office-4x4")
    corridors = drawn.plan.building.corridors
    grid = Grid(4, 4)
    assert grid.connected(corridors)
    assert int(corridors.sum()) == round(0.6 * grid.corridors)
    leads = grid.junction_types(corridors[None, :])[0]
    assert len(drawn.plan.errands) == 6
    for errand in drawn.plan.errands:
        assert errand.start != errand.goal
        assert leads[errand.start] and leads[errand.goal]
        assert errand.expected_again == 3.0
    assert len(drawn.plan.people) == 2


def test_the_seed_alone_decides() -> None:
    scenario = load(find("office-4x4"))
    once, again = (draw(scenario, "office-4x4").plan for _ in range(2))
    other = draw(load(find("office-4x4"), seed=2), "office-4x4").plan
    assert np.array_equal(once.building.corridors, again.building.corridors)
    assert (once.errands, once.start, once.heading) == (again.errands, again.start, again.heading)
    assert not np.array_equal(once.building.corridors, other.building.corridors)


@given(seed=st.integers(0, 1000), density=st.floats(1e-9, 0.1))
def test_even_the_least_density_leaves_a_corridor_to_run_errands_in(
    seed: int, density: float
) -> None:
    table = {
        "about": "sparse",
        "seed": seed,
        "world": {
            "columns_m": [0.0, 20.0, 40.0],
            "rows_m": [0.0, 20.0],
            "corridors": {"random": True, "density": density},
        },
        "random_errands": {"count": 2},
    }
    plan = draw(check(table, "sparse"), "sparse").plan
    assert int(plan.building.corridors.sum()) == 1
    assert all(errand.start != errand.goal for errand in plan.errands)


@pytest.mark.parametrize("seed", ["1", "2"])
def test_it_runs_to_its_end_in_one_process(tmp_path: Path, seed: str) -> None:
    log = str(tmp_path / "run.mcap")
    said = waywiser("launch", "office-4x4", "--seed", seed, "--in-process", "--log", log, "--json")
    assert (said.status, said.json["reason"]) == (0, "done")


def test_it_runs_to_its_end_in_processes_with_the_same_log(tmp_path: Path) -> None:
    one, many = tmp_path / "one.mcap", tmp_path / "many.mcap"
    assert waywiser("launch", "office-4x4", "--in-process", "--log", str(one)).status == 0
    assert ended(start("launch", "office-4x4", "--log", str(many))).status == 0
    assert one.read_bytes() == many.read_bytes()
