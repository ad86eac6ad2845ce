"""Counts of connected maps.

The numbers were found by enumeration up to 4 by 4 and, beyond, by independent frontier
implementations; 5 by 5 also with Graphillion (github.com/takemaru/graphillion).
"""

from __future__ import annotations

import csv
from collections import defaultdict
from pathlib import Path

import numpy as np
import pytest

from modules.geographer import ConnectedMaps
from tests.geographer.every_map import all_maps

COUNTS = {
    (2, 2): 13,
    (3, 2): 80,
    (3, 3): 1759,
    (4, 3): 38910,
    (4, 4): 3565408,
    (5, 5): 115950036540,
    (6, 6): 58767505304355301,
    (7, 7): 460758354232497326633959,
}
BY_CORRIDORS = {
    (2, 2): [0, 4, 4, 4, 1],
    (3, 2): [0, 7, 10, 16, 20, 19, 7, 1],
    (3, 3): [0, 12, 22, 48, 101, 192, 306, 404, 387, 208, 66, 12, 1],
}
ORACLES = Path(__file__).parents[3] / "shared" / "oracles"


@pytest.mark.parametrize("shape", COUNTS)
def test_counts(shape: tuple[int, int]) -> None:
    columns, rows = shape
    assert ConnectedMaps(columns, rows).count == COUNTS[shape]
    assert ConnectedMaps(rows, columns).count == COUNTS[shape]


@pytest.mark.parametrize("shape", BY_CORRIDORS)
def test_counts_by_corridors(shape: tuple[int, int]) -> None:
    assert ConnectedMaps(*shape).count_by_corridors() == BY_CORRIDORS[shape]


@pytest.mark.parametrize("shape", [(1, 2), (5, 1), (2, 4), (4, 2), (3, 3)])
def test_counts_by_corridors_against_every_map(shape: tuple[int, int]) -> None:
    corridors = ConnectedMaps(*shape).grid.corridors
    listed = np.bincount(all_maps(*shape).sum(axis=1), minlength=corridors + 1)
    assert ConnectedMaps(*shape).count_by_corridors() == listed.tolist()


@pytest.mark.parametrize("length", [2, 3, 10, 40])
def test_one_line_has_an_interval_for_each_pair_of_ends(length: int) -> None:
    # A connected map of a line is a run from one intersection to a later one.
    assert ConnectedMaps(length, 1).count == length * (length - 1) // 2


@pytest.mark.parametrize("shape", [(4, 4), (5, 4), (5, 5), (7, 7)])
def test_counts_by_corridors_sum_to_the_count(shape: tuple[int, int]) -> None:
    maps = ConnectedMaps(*shape)
    by_corridors = maps.count_by_corridors()
    assert sum(by_corridors) == maps.count
    # One corridor anywhere; all; all but one (no corridor of a grid is a bridge).
    corridors = maps.grid.corridors
    assert by_corridors[1] == corridors
    assert by_corridors[-2:] == [corridors, 1]


@pytest.mark.skipif(not ORACLES.exists(), reason="the oracles are not beside the project")
def test_counts_against_the_oracle_files() -> None:
    with (ORACLES / "connected_maps.csv").open() as file:
        for row in csv.DictReader(file):
            maps = ConnectedMaps(int(row["columns"]), int(row["rows"]))
            assert maps.count == int(row["connected_maps"])
    listed: dict[tuple[int, int], dict[int, int]] = defaultdict(dict)
    with (ORACLES / "connected_maps_by_corridors.csv").open() as file:
        for row in csv.DictReader(file):
            shape = int(row["columns"]), int(row["rows"])
            listed[shape][int(row["corridors"])] = int(row["connected_maps"])
    for shape, counts in listed.items():
        found = ConnectedMaps(*shape).count_by_corridors()
        assert {k: n for k, n in enumerate(found) if n} == counts
