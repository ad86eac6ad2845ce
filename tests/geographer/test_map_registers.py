"""Priors on the number of corridors, and evidence about pairs of junctions, against every map."""

from __future__ import annotations

import csv
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.stats import chisquare

from bus.grid import DIRECTIONS, JUNCTION_TYPES, STEP, Grid
from modules.geographer import ConnectedMaps, MapBelief, PairLikelihood, solution
from modules.geographer.density import medium_density, weights_for
from tests.geographer.every_map import Enumerated, Floats, all_maps, enumerate_posterior

SMALL = [(1, 2), (2, 1), (1, 4), (4, 1), (2, 2), (3, 2), (2, 3), (4, 2), (3, 3)]
ORACLE = Path(__file__).parents[3] / "shared" / "oracles" / "connected_maps_by_corridors.csv"


def all_pairs(grid: Grid) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Neighbours, each pair in both orders."""
    found = []
    for v in range(grid.intersections):
        x, y = grid.place(v)
        for d in DIRECTIONS:
            if grid.corridor(x, y, d) >= 0:
                found.append(((x, y), (x + STEP[d][0], y + STEP[d][1])))
    return found


def random_pairs(grid: Grid, n: int, kinds: int, rng: np.random.Generator) -> list[PairLikelihood]:
    """Tables of so many different rows, up to a factor each."""
    chosen = rng.permutation(all_pairs(grid))[:n].tolist()
    tables = [
        rng.random((16, 1)) * rng.random((kinds, 16))[rng.integers(kinds, size=16)] for _ in chosen
    ]
    return [
        PairLikelihood((a[0], a[1]), (b[0], b[1]), t)
        for (a, b), t in zip(chosen, tables, strict=True)
    ]


def assert_agrees(belief: MapBelief, exact: Enumerated) -> None:
    assert_allclose(belief.log_evidence, exact.log_evidence, rtol=1e-12, atol=1e-12)
    assert_allclose(belief.junctions, exact.junctions, atol=1e-12)
    assert_allclose(belief.corridors, exact.corridors, atol=1e-12)
    assert_allclose(belief.corridor_counts, exact.corridor_counts, atol=1e-12)
    scale = max(1.0, abs(exact.log_evidence))
    assert_allclose(belief.entropy, exact.entropy, atol=1e-12 * scale)
    assert_allclose(np.exp(belief.log_probability(exact.maps)), exact.probability, atol=1e-12)
    best = np.exp(belief.log_probability(belief.most_probable()[None]))[0]
    assert_allclose(best, exact.probability.max(), rtol=1e-11)


def problem(
    shape: tuple[int, int], seed: int, counted: bool, pairs: int, kinds: int = 16
) -> tuple[Floats, Floats, Floats, Floats | None, list[PairLikelihood]]:
    rng = np.random.default_rng(seed)
    grid = Grid(*shape)
    return (
        rng.random((grid.rows, grid.columns, JUNCTION_TYPES)) ** 3 * 7.0,
        rng.lognormal(size=grid.corridors),
        rng.random((grid.corridors, 2)),
        rng.random(grid.corridors + 1) ** 3 * 5.0 if counted else None,
        random_pairs(grid, pairs, kinds, rng),
    )


@pytest.mark.parametrize("shape", SMALL)
@pytest.mark.parametrize("logarithmic", [False, True])
@pytest.mark.parametrize(("counted", "pairs"), [(True, 0), (False, 2), (True, 2)])
def test_agrees_with_every_map_one_by_one(
    shape: tuple[int, int],
    logarithmic: bool,
    counted: bool,
    pairs: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    if logarithmic:
        monkeypatch.setattr(solution, "TOLERANCE", -1.0)
    given_ = problem(shape, 1, counted, pairs)
    belief = ConnectedMaps(*shape).posterior(*given_)
    assert_agrees(belief, enumerate_posterior(shape[0], shape[1], *given_))


@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from(SMALL[4:]),
    st.integers(0, 2**32 - 1),
    st.booleans(),
    st.integers(0, 4),
    st.integers(1, 4),
)
def test_any_mixture_of_evidence(
    shape: tuple[int, int], seed: int, counted: bool, pairs: int, kinds: int
) -> None:
    given_ = problem(shape, seed, counted, pairs, kinds)
    belief = ConnectedMaps(*shape).posterior(*given_)
    assert_agrees(belief, enumerate_posterior(shape[0], shape[1], *given_))


@pytest.mark.parametrize("shape", [(3, 2), (3, 3)])
@pytest.mark.parametrize("seed", range(3))
def test_zeros_and_1e_300(shape: tuple[int, int], seed: int) -> None:
    rng = np.random.default_rng(seed)
    grid = Grid(*shape)
    likelihood, odds, corridors, _, _ = problem(shape, seed, False, 0)
    likelihood = 10.0 ** rng.uniform(-300, 0, likelihood.shape)
    counts = 10.0 ** rng.uniform(-300, 0, grid.corridors + 1)
    counts[rng.random(grid.corridors + 1) < 0.3] = 0.0
    counts[grid.corridors // 2] = 1.0
    tables = 10.0 ** rng.uniform(-300, 0, (2, 16, 16))
    tables[rng.random(tables.shape) < 0.1] = 0.0
    pairs = [PairLikelihood((0, 0), (1, 0), tables[0]), PairLikelihood((1, 1), (1, 0), tables[1])]
    given_ = likelihood, odds, corridors, counts, pairs
    belief = ConnectedMaps(*shape).posterior(*given_)
    assert_agrees(belief, enumerate_posterior(shape[0], shape[1], *given_))


@pytest.mark.parametrize("logarithmic", [False, True])
def test_samples_follow_the_posterior(logarithmic: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    if logarithmic:
        monkeypatch.setattr(solution, "TOLERANCE", -1.0)
    given_ = problem((3, 2), 5, True, 2)
    belief = ConnectedMaps(3, 2).posterior(*given_)
    exact = enumerate_posterior(3, 2, *given_)
    n = 40_000
    numbers = 1 << np.arange(7)
    drawn = np.bincount(belief.sample(n, np.random.default_rng(7)) @ numbers, minlength=128)
    expected = np.zeros(128)
    expected[exact.maps @ numbers] = exact.probability * n
    assert drawn[expected == 0].sum() == 0
    often = expected >= 5
    observed = np.append(drawn[often], drawn[~often].sum())
    assert chisquare(observed, np.append(expected[often], expected[~often].sum())).pvalue > 0.001


# The number of corridors.


def test_two_by_two_by_hand() -> None:
    # 4, 4, 4, 1 maps of 1, 2, 3, 4 corridors; weights 1, 3, 0, 8: 4 + 12 + 8 = 24. A corridor is
    # in 1 map of one corridor, in 2 of two, in 1 of four: (1 + 2 * 3 + 8) / 24.
    maps = ConnectedMaps(2, 2)
    belief = maps.posterior(np.ones((2, 2, 16)), corridor_count_weights=[5, 1, 3, 0, 8])
    assert_allclose(belief.corridors, 15 / 24)
    assert_allclose(belief.corridor_counts, [0, 4 / 24, 12 / 24, 0, 8 / 24])
    assert_allclose(belief.log_evidence, 0.0, atol=1e-14)
    assert_allclose(
        belief.entropy, 4 * -(1 / 24 * np.log(1 / 24)) + 4 * (3 / 24 * np.log(8)) + np.log(3) / 3
    )


@pytest.mark.parametrize("shape", [(3, 3), (5, 5), (4, 6)])
def test_a_power_of_the_count_is_odds(shape: tuple[int, int]) -> None:
    # Weights o^k are what odds o say, at any size.
    maps = ConnectedMaps(*shape)
    likelihood = np.random.default_rng(1).random((shape[1], shape[0], 16))
    weights = 0.7 ** np.arange(maps.grid.corridors + 1)
    by_count = maps.posterior(likelihood, corridor_count_weights=weights)
    by_odds = maps.posterior(likelihood, 0.7)
    assert_allclose(by_count.log_evidence, by_odds.log_evidence, rtol=1e-12)
    assert_allclose(by_count.junctions, by_odds.junctions, atol=1e-12)
    assert_allclose(by_count.entropy, by_odds.entropy, rtol=1e-11)
    assert (by_count.most_probable() == by_odds.most_probable()).all()
    assert_allclose(by_count.corridor_counts, by_odds.corridor_counts, atol=1e-12)


@pytest.mark.skipif(not ORACLE.exists(), reason="the oracles are not beside the project")
def test_counts_against_the_oracle() -> None:
    listed: dict[tuple[int, int], dict[int, int]] = {}
    with ORACLE.open() as file:
        for row in csv.DictReader(file):
            shape = int(row["columns"]), int(row["rows"])
            listed.setdefault(shape, {})[int(row["corridors"])] = int(row["connected_maps"])
    for shape, by_corridors in listed.items():
        maps = ConnectedMaps(*shape)
        wanted = medium_density(maps.grid.corridors)
        counts = np.array([by_corridors.get(k, 0) for k in range(len(wanted))], float)
        flat = np.ones((shape[1], shape[0], 16))
        # Weights as they are: the oracle's counts, weighted.
        belief = maps.posterior(flat, corridor_count_weights=wanted)
        expected = counts * wanted / (counts @ wanted)
        assert_allclose(belief.corridor_counts, expected, rtol=1e-10, atol=1e-300)
        # And divided by the counts: the wanted probability itself.
        weights = weights_for(np.where(counts > 0, wanted, 0), maps.count_by_corridors())
        belief = maps.posterior(flat, corridor_count_weights=weights)
        assert_allclose(belief.corridor_counts[counts > 0], wanted[counts > 0], rtol=1e-10)


def test_a_wide_grid_can_want_a_density() -> None:
    maps = ConnectedMaps(6, 6)
    wanted = medium_density(60, 0.6, 0.1)
    possible = maps.count_by_corridors()
    belief = maps.posterior(
        np.ones((6, 6, 16)), corridor_count_weights=weights_for(wanted, possible)
    )
    assert_allclose(belief.corridor_counts, wanted, rtol=1e-10)
    drawn = belief.sample(300, np.random.default_rng(1)).sum(axis=1)
    assert abs(drawn.mean() - 36) < 4 * 6 / np.sqrt(300)


def test_weights_of_counts_beyond_floats() -> None:
    possible = [0, *(10**k + k for k in range(0, 600, 50))]
    wanted = np.append(0.0, np.random.default_rng(1).random(12))
    weights = weights_for(wanted, possible)
    # Whole numbers of 600 digits, so as exact fractions.
    products = [Fraction(float(w)) * n for w, n in zip(weights, possible, strict=True)]
    likely = [k for k in range(13) if weights[k] > 1e-300]
    total = sum(products[k] for k in likely)
    found = [float(products[k] / total) for k in likely]
    assert len(likely) > 5
    assert_allclose(found, wanted[likely] / wanted[likely].sum(), rtol=1e-10)


def test_medium_is_most_probable() -> None:
    curve = medium_density(24, 0.5, 0.1)
    assert curve[0] == 0.0
    assert curve.argmax() == 12
    assert_allclose(curve.sum(), 1.0)
    assert_allclose(curve[10], curve[14])
    assert_allclose(medium_density(24, 0.5, 1e-6)[12], 1.0)


# Pairs.


def test_a_pair_that_factors_is_two_likelihoods() -> None:
    maps = ConnectedMaps(4, 3)
    rng = np.random.default_rng(3)
    first, second = rng.random(16), rng.random(16)
    both = np.ones((3, 4, 16))
    both[1, 2], both[2, 2] = first, second
    apart = maps.posterior(both)
    pair = PairLikelihood((2, 1), (2, 2), np.outer(first, second))
    together = maps.posterior(np.ones((3, 4, 16)), pairs=[pair])
    assert not together._problem.evidence.entangled
    assert_allclose(together.junctions, apart.junctions, atol=1e-13)
    assert_allclose(together.log_evidence, apart.log_evidence, rtol=1e-12)


def test_a_feature_of_the_shared_corridor_costs_nothing() -> None:
    # P(reading | types) depends on whether the corridor is there and then on the first's type.
    grid = Grid(3, 3)
    rng = np.random.default_rng(4)
    given_there, given_absent = rng.random((2, 16))
    east = np.arange(16) & 2 > 0
    table = np.where(east, given_there, given_absent)[:, None] * np.ones(16)
    belief = ConnectedMaps(3, 3).posterior(
        np.ones((3, 3, 16)), pairs=[PairLikelihood((0, 1), (1, 1), table)]
    )
    assert belief._problem.evidence.local
    assert grid.corridors == 12


@pytest.mark.parametrize("pair", all_pairs(Grid(3, 3)))
def test_a_reading_of_two_types_at_any_place(pair: tuple[tuple[int, int], tuple[int, int]]) -> None:
    # The likelihood of "the two types are the same": no product of functions of each.
    table = np.where(np.eye(16) > 0, 0.9, 0.1)
    given_ = np.ones((3, 3, 16)), 1.0, None, None, [PairLikelihood(*pair, table)]
    belief = ConnectedMaps(3, 3).posterior(*given_)
    assert_agrees(belief, enumerate_posterior(3, 3, *given_))


def test_pairs_on_a_grid_too_large_to_list() -> None:
    # Conditioning by hand: the belief given each type of the one junction, mixed.
    maps = ConnectedMaps(5, 6)
    rng = np.random.default_rng(6)
    likelihood, table = rng.random((6, 5, 16)), rng.random((16, 16))
    for first, second in [((2, 2), (3, 2)), ((2, 3), (2, 2))]:
        belief = maps.posterior(likelihood, pairs=[PairLikelihood(first, second, table)])
        logs, parts = [], []
        for t in range(16):
            given_type = likelihood.copy()
            given_type[first[1], first[0]] *= np.arange(16) == t
            given_type[second[1], second[0]] *= table[t]
            part = maps.posterior(given_type)
            logs.append(part.log_evidence)
            parts.append(part.corridors)
        total = np.logaddexp.reduce(logs)
        assert_allclose(belief.log_evidence, total, rtol=1e-12)
        assert_allclose(belief.corridors, np.exp(logs - total) @ parts, atol=1e-12)


def test_every_map_is_listed_with_its_weights() -> None:
    # The oracle of this file: a weight for a count moves exactly the maps that have it.
    weights = np.zeros(5)
    weights[2] = 1.0
    exact = enumerate_posterior(2, 2, np.ones((2, 2, 16)), corridor_count_weights=weights)
    assert_allclose(exact.probability[all_maps(2, 2).sum(axis=1) == 2], 0.25)
