"""Contradictory evidence: the error names a smallest part that no map fits."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.grid import EAST, JUNCTION_TYPES, NORTH, SOUTH, WEST, Grid
from modules.geographer import ConnectedMaps, ContradictoryEvidenceError, PairLikelihood
from modules.geographer.conflict import smallest_conflict
from tests.geographer.every_map import Floats, all_maps


def certain(junction_type: int) -> Floats:
    likelihood: Floats = np.eye(JUNCTION_TYPES)[junction_type]
    return likelihood


@given(st.integers(1, 40), st.data())
def test_the_smallest_conflict_of_any_items(n: int, data: st.DataObject) -> None:
    culprits = data.draw(st.sets(st.integers(0, n - 1), min_size=1))
    asked = 0

    def fits(kept: list[int]) -> bool:
        nonlocal asked
        asked += 1
        return not culprits <= set(kept)

    assert sorted(smallest_conflict(list(range(n)), fits)) == sorted(culprits)
    k = len(culprits)
    assert asked <= 2 * k * np.log2(n / k) + 2 * k + 1  # Junker's bound


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_what_is_named_conflicts_and_no_part_of_it_does(seed: int) -> None:
    # Types ruled out at random until no map is left; held against every map.
    rng = np.random.default_rng(seed)
    likelihood = (rng.random((3, 3, 16)) < 0.35).astype(float) * rng.random((3, 3, 16))
    types = Grid(3, 3).junction_types(all_maps(3, 3))
    fitting = likelihood.reshape(9, 16)[np.arange(9), types] > 0
    maps = ConnectedMaps(3, 3)
    if fitting.all(axis=1).any():
        maps.posterior(likelihood)
        return
    with pytest.raises(ContradictoryEvidenceError) as error:
        maps.posterior(likelihood)
    named = [maps.grid.intersection(x, y) for x, y in error.value.junctions]
    assert not fitting[:, named].all(axis=1).any()
    for fewer in combinations(named, len(named) - 1):
        assert fitting[:, list(fewer)].all(axis=1).any()
    for x, y in error.value.junctions:
        assert f"[{x},{y}]" in str(error.value)


def test_innocent_evidence_is_not_named() -> None:
    maps = ConnectedMaps(6, 6)
    truth = maps.posterior(np.ones((6, 6, 16))).sample(1, np.random.default_rng(1))
    likelihood = np.eye(16)[maps.grid.junction_types(truth)[0]].reshape(6, 6, 16) + 1e-9
    likelihood[likelihood < 1e-6] = 0.0
    likelihood[2, 3], likelihood[2, 4] = certain(EAST), certain(NORTH)
    likelihood[:2] = likelihood[3:] = 1.0
    likelihood[2, :3] = 1.0
    with pytest.raises(ContradictoryEvidenceError) as error:
        maps.posterior(likelihood)
    assert error.value.junctions == [(3, 2), (4, 2)]
    assert error.value.corridors == []


def test_a_junction_may_contradict_a_corridor() -> None:
    grid = Grid(3, 3)
    likelihood = np.ones((3, 3, 16))
    likelihood[1, 1] = certain(NORTH | SOUTH)
    likelihood[0, 0] = certain(EAST)
    corridors = np.ones((12, 2))
    corridors[grid.corridor(1, 1, WEST)] = 0.0, 1.0
    corridors[grid.corridor(2, 2, WEST)] = 0.0, 1.0
    with pytest.raises(ContradictoryEvidenceError) as error:
        ConnectedMaps(3, 3).posterior(likelihood, corridor_likelihood=corridors)
    assert error.value.junctions == [(1, 1)]
    assert error.value.corridors == [((0, 1), (1, 1))]
    assert "junctions [x,y] [1,1] and corridors [0,1]-[1,1] together" in str(error.value)


def test_one_junction_alone_may_contradict_the_prior() -> None:
    likelihood = np.ones((3, 3, 16))
    likelihood[1, 1] = certain(NORTH | SOUTH)
    odds = np.ones(12)
    odds[Grid(3, 3).corridor(1, 1, NORTH)] = 0.0
    with pytest.raises(ContradictoryEvidenceError) as error:
        ConnectedMaps(3, 3).posterior(likelihood, odds)
    assert error.value.junctions == [(1, 1)]


def test_a_junction_that_allows_nothing() -> None:
    likelihood = np.ones((3, 3, 16))
    likelihood[1, 2] = 0.0
    with pytest.raises(ContradictoryEvidenceError) as error:
        ConnectedMaps(3, 3).posterior(likelihood)
    assert error.value.junctions == [(2, 1)]


def test_evidence_may_contradict_the_number_of_corridors() -> None:
    likelihood = np.ones((3, 3, 16))
    likelihood[1, 1] = certain(15)
    likelihood[0, 0] = certain(EAST)
    likelihood[2, 2, 0] = 0.0
    counts = np.arange(13) == 4  # four around the middle: none left for the corner
    with pytest.raises(ContradictoryEvidenceError) as error:
        ConnectedMaps(3, 3).posterior(likelihood, corridor_count_weights=counts)
    assert error.value.junctions in ([(0, 0), (1, 1)], [(1, 1), (2, 2)])


def test_pairs_are_named_by_their_junctions() -> None:
    same = PairLikelihood((0, 0), (0, 1), np.eye(16))
    likelihood = np.ones((3, 3, 16))
    likelihood[0, 0] = certain(NORTH | EAST)
    with pytest.raises(ContradictoryEvidenceError) as error:
        ConnectedMaps(3, 3).posterior(likelihood, pairs=[same])
    # (0, 1) cannot have the same type: that would be a corridor to the west of the grid's edge.
    assert set(error.value.junctions) <= {(0, 0), (0, 1)}
