"""Table 1 of the paper: a few runs come out as its averages and as another program's."""

from __future__ import annotations

import csv
from itertools import islice, pairwise
from pathlib import Path

import numpy as np
import pytest

from benchmarks.table1 import REPRODUCED, TABLE_1, cliques, measure, network_for, random_walk
from bus.grid import Grid
from modules.geographer import ConnectedMaps

ORACLE = Path(__file__).parents[3] / "shared" / "oracles" / "table1.csv"
WALKS = 400


@pytest.fixture(scope="module")
def by_length() -> dict[int, np.ndarray[tuple[int], np.dtype[np.float64]]]:
    """Cells of the largest clique for each state of H, walk by walk."""
    rng = np.random.default_rng(1)
    network = network_for(ConnectedMaps(4, 4), 10, rng)
    return {
        length: np.array(list(islice(cliques(network, length, rng), WALKS))) / 10
        for length in REPRODUCED
    }


@pytest.mark.parametrize("length", REPRODUCED)
def test_the_mean_clique_is_the_other_program_s(
    by_length: dict[int, np.ndarray[tuple[int], np.dtype[np.float64]]], length: int
) -> None:
    cells = by_length[length]
    error = cells.std() / np.sqrt(WALKS)
    assert cells.mean() == pytest.approx(REPRODUCED[length], abs=4 * error, rel=0)
    assert cells.mean() == pytest.approx(REPRODUCED[length], rel=0.25)


@pytest.mark.parametrize("length", REPRODUCED)
def test_the_paper_s_averages_are_within_the_scatter_of_ten_runs(
    by_length: dict[int, np.ndarray[tuple[int], np.dtype[np.float64]]], length: int
) -> None:
    cells = by_length[length]
    rows = [row for row in TABLE_1 if row.explored == length]
    ten = [cells[first : first + 10].mean() for first in range(0, WALKS, 10)]
    mean_of_paper = np.mean([row.clique / row.states for row in rows])
    # three rows of ten runs each, in one mean
    assert abs(mean_of_paper - cells.mean()) < 3 * np.std(ten) / np.sqrt(len(rows))


def test_every_average_of_the_paper_is_a_sum_of_whole_cliques_if_h_counts_nota() -> None:
    for row in TABLE_1:
        # ten cliques of |H| times a product of 4s, 8s and 16s
        assert row.clique * 10 % (row.states * 4) == 0
        assert row.clique * 10 % (row.states + 1)


def test_updates_by_pyagrum_have_the_cliques_reckoned() -> None:
    found = measure(TABLE_1[3], runs=2, walks=20, seed=1)
    assert found.as_reckoned == 2
    assert found.seconds > 0.0
    assert found.clique % 10 == 0


def test_a_walk_follows_the_grid_and_meets_no_junction_twice() -> None:
    grid, rng = Grid(4, 4), np.random.default_rng(1)
    joined = {frozenset(grid.ends(corridor)) for corridor in range(grid.corridors)}
    for _ in range(50):
        walk = random_walk(grid, 10, rng)
        assert len(set(walk)) == 10
        assert all(frozenset(step) in joined for step in pairwise(walk))


@pytest.mark.skipif(not ORACLE.exists(), reason="../shared/oracles/table1.csv is not here")
def test_the_numbers_are_copied_right() -> None:
    with ORACLE.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [
        (
            row.states,
            row.explored,
            row.seconds,
            row.clique,
            row.states * REPRODUCED[row.explored],
        )
        for row in TABLE_1
    ] == [
        (
            int(row["hypotheses"]),
            int(row["explored"]),
            float(row["paper_seconds"]),
            int(row["paper_largest_clique"]),
            int(row["reproduced_largest_clique"]),
        )
        for row in rows
    ]
