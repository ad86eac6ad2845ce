from __future__ import annotations

from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.grid import Grid
from modules.geographer.frontier import START, Frontier, state_count
from modules.geographer.partitions import Partitions, canonical, partition_count
from modules.geographer.sweep import Sweep


def crosses(labels: tuple[int, ...]) -> bool:
    return any(
        labels[a] == labels[c] != labels[b] == labels[d] and 0 not in (labels[a], labels[b])
        for a, b, c, d in combinations(range(len(labels)), 4)
    )


def is_canonical(labels: tuple[int, ...]) -> bool:
    firsts = list(dict.fromkeys(label for label in labels if label))
    return firsts == list(range(1, len(firsts) + 1))


@pytest.mark.parametrize("places", range(1, 7))
def test_partitions_are_all_that_do_not_cross(places: int) -> None:
    listed = {
        labels
        for labels in product(range(places + 1), repeat=places)
        if is_canonical(labels) and not crosses(labels)
    }
    partitions = Partitions.of(places)
    assert {tuple(row) for row in partitions.labels.tolist()} == listed
    assert len(partitions.labels) == len(listed) == partition_count(places)
    assert not partitions.labels[0].any()
    assert (partitions.rank(partitions.labels) == np.arange(len(listed))).all()


def test_partition_counts_are_sequence_a007317_of_the_oeis() -> None:
    assert [partition_count(n) for n in range(11)] == [
        1, 2, 5, 15, 51, 188, 731, 2950, 12235, 51822, 223191,
    ]  # fmt: skip


@given(st.lists(st.integers(0, 5), min_size=1, max_size=8))
def test_canonical_keeps_what_is_connected(labels: list[int]) -> None:
    result = canonical(np.array([labels], dtype=np.uint8))[0].tolist()
    assert is_canonical(tuple(result))
    for a, b in product(range(len(labels)), repeat=2):
        assert (labels[a] == labels[b]) == (result[a] == result[b])
    assert [r == 0 for r in result] == [label == 0 for label in labels]


def test_tables_of_one_line_by_hand() -> None:
    # States: 0 nothing yet; 1, 2, 3 left north, east, both; 4 done; 5 dead. In the next row
    # what left north comes in from the south (code 1); nothing can have left east.
    frontier = Frontier.of(1)
    assert (frontier.idle, frontier.joined, frontier.states) == (1, 1, 6)
    assert frontier.enter.tolist() == [[0, 1, 5, 5, 4, 5]]
    assert frontier.close.tolist() == [[4]]


@pytest.mark.parametrize("width", range(1, 8))
def test_tables_stay_inside(width: int) -> None:
    frontier = Frontier.of(width)
    states = state_count(width)
    assert frontier.enter.shape == (width, states)
    assert frontier.close.shape == (width, frontier.joined)
    assert frontier.enter.min() >= 0
    assert frontier.enter.max() < states
    assert (frontier.enter[:, START] == START).all()
    # Only the lone component may complete the map; closing any other leaves idle rests.
    assert (frontier.close[:, 0] == states - 2).all()
    assert (frontier.close[:, 1 : frontier.idle] == states - 1).all()
    assert (frontier.close[:, frontier.idle :] < frontier.idle).all()


@pytest.mark.parametrize(("columns", "rows"), [(1, 4), (4, 1), (3, 2), (2, 3), (3, 3)])
def test_sweep_writes_and_reads_maps(columns: int, rows: int) -> None:
    grid = Grid(columns, rows)
    sweep = Sweep.of(grid)
    assert sweep.width == min(columns, rows)
    assert sorted(sweep.intersections) == list(range(grid.intersections))
    maps = np.random.default_rng(1).integers(0, 2, (20, grid.corridors)).astype(np.uint8)
    assert (sweep.to_maps(sweep.to_leaves(maps)) == maps).all()
    by_type = np.random.default_rng(2).random((grid.intersections, 16))
    assert (sweep.to_grid(sweep.to_steps(by_type)) == by_type).all()
