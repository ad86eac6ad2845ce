from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.stats import chisquare

from bus.grid import DIRECTIONS, EAST, JUNCTION_TYPES, NORTH, SOUTH, WEST, Grid
from modules.geographer import ConnectedMaps, MapBelief, solution
from tests.geographer.every_map import Floats, all_maps, enumerate_posterior

SMALL = [(1, 2), (2, 1), (1, 3), (3, 1), (2, 2), (3, 2), (2, 3), (4, 2), (3, 3)]


def random_likelihood(columns: int, rows: int, seed: int) -> Floats:
    return np.random.default_rng(seed).random((rows, columns, JUNCTION_TYPES))


def uniform(maps: ConnectedMaps) -> Floats:
    return np.ones((maps.grid.rows, maps.grid.columns, JUNCTION_TYPES))


def assert_agrees(belief: MapBelief, args: tuple[Floats, Floats, Floats]) -> None:
    exact = enumerate_posterior(belief.grid.columns, belief.grid.rows, *args)
    assert_allclose(belief.log_evidence, exact.log_evidence, rtol=1e-12, atol=1e-12)
    assert_allclose(belief.junctions, exact.junctions, atol=1e-12)
    assert_allclose(belief.corridors, exact.corridors, atol=1e-12)
    scale = max(1.0, abs(exact.log_evidence))
    assert_allclose(belief.entropy, exact.entropy, atol=1e-12 * scale)
    assert_allclose(np.exp(belief.log_probability(exact.maps)), exact.probability, atol=1e-12)
    best = belief.most_probable()
    assert_allclose(np.exp(belief.log_probability(best[None]))[0], exact.probability.max())


def random_problem(columns: int, rows: int, seed: int) -> tuple[Floats, Floats, Floats]:
    rng = np.random.default_rng(seed)
    corridors = Grid(columns, rows).corridors
    likelihood = rng.random((rows, columns, JUNCTION_TYPES)) ** 3 * 7.0
    return likelihood, rng.lognormal(size=corridors), rng.random((corridors, 2))


@pytest.mark.parametrize(("columns", "rows"), SMALL)
@pytest.mark.parametrize("seed", [1, 2])
def test_agrees_with_every_map_one_by_one(columns: int, rows: int, seed: int) -> None:
    problem = random_problem(columns, rows, seed)
    assert_agrees(ConnectedMaps(columns, rows).posterior(*problem), problem)


@pytest.mark.parametrize(("columns", "rows"), SMALL)
def test_the_logarithmic_passes_say_the_same(
    columns: int, rows: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem = random_problem(columns, rows, 3)
    monkeypatch.setattr(solution, "TOLERANCE", -1.0)
    belief = ConnectedMaps(columns, rows).posterior(*problem)
    assert belief._solution.logarithmic
    assert_agrees(belief, problem)


@pytest.mark.parametrize("seed", range(6))
def test_zeros_are_hard_evidence(seed: int) -> None:
    # Half of the types are ruled out at half of the junctions, around one map that is possible.
    rng = np.random.default_rng(seed)
    maps = all_maps(3, 3)
    truth = maps[rng.integers(len(maps))]
    types = Grid(3, 3).junction_types(truth[None])[0]
    likelihood = rng.integers(0, 2, (9, JUNCTION_TYPES)).astype(float)
    likelihood[np.arange(9), types] = 1.0
    likelihood[rng.random(9) < 0.5] = 1.0
    hard = np.ones((12, 2))
    hard[4] = [1 - truth[4], truth[4]]
    problem = likelihood.reshape(3, 3, JUNCTION_TYPES), np.full(12, 0.7), hard
    belief = ConnectedMaps(3, 3).posterior(*problem)
    assert_agrees(belief, problem)
    assert belief.corridors[4] == pytest.approx(truth[4], abs=1e-15)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(("columns", "rows"), [(3, 2), (3, 3)])
def test_likelihoods_down_to_1e_300_that_disagree(columns: int, rows: int, seed: int) -> None:
    # Every junction is all but certain of a type drawn blindly, so neighbours contradict each
    # other and even the best map has a likelihood far below the smallest float.
    rng = np.random.default_rng(seed)
    likelihood = 10.0 ** rng.uniform(-300, -200, (rows, columns, JUNCTION_TYPES))
    certain = rng.integers(0, JUNCTION_TYPES, (rows, columns, 1))
    np.put_along_axis(likelihood, certain, 1.0, axis=2)
    corridors = Grid(columns, rows).corridors
    problem = likelihood, 10.0 ** rng.uniform(-100, 100, corridors), np.ones((corridors, 2))
    assert_agrees(ConnectedMaps(columns, rows).posterior(*problem), problem)


def test_linear_numbers_alone_would_lose_the_answer() -> None:
    # A 1 by 4 grid with corridors a, b, c from south to north. The two lower junctions say
    # with 1e-200 each that a is not all there is; the upper two rule out b and c. The only map
    # left is a, with types N, S, -, - and the weight 1e-200 * 1e-200 = 1e-400, no float.
    likelihood = np.ones((4, 1, JUNCTION_TYPES))
    likelihood[0, 0, NORTH] = likelihood[1, 0, SOUTH] = 1e-200
    likelihood[2, 0, :] = 0.0
    likelihood[2, 0, [0, NORTH]] = 1.0
    likelihood[3, 0, SOUTH] = 0.0
    belief = ConnectedMaps(1, 4).posterior(likelihood)
    assert belief._solution.logarithmic
    assert_allclose(belief.corridors, [1.0, 0.0, 0.0])
    # Six connected maps (a, b, c, ab, bc, abc), equally probable before.
    assert_allclose(belief.log_evidence, -400 * np.log(10) - np.log(6), rtol=1e-12)
    assert_allclose(belief.sample(5, np.random.default_rng(0)), [[1, 0, 0]] * 5)


def test_what_both_passes_lose_is_found_again() -> None:
    # Two lines of 13 junctions, no rungs: the map is either the whole left line or the whole
    # right one. The left junctions say 1e-150 for the line in the first and last three rows, and
    # 1e-150 against it in the seven between. So left, 6 * 150 = 900 orders down, beats right,
    # 7 * 150 = 1050 down. But either pass alone has left 450 orders behind right after three rows
    # and drops it, and then both agree on right.
    line = [NORTH] + [NORTH | SOUTH] * 11 + [SOUTH]
    likelihood = np.zeros((13, 2, JUNCTION_TYPES))
    likelihood[:, :, 0] = 1.0
    likelihood[range(13), :, line] = 1.0
    outer = [0, 1, 2, 10, 11, 12]
    likelihood[outer, 0, np.take(line, outer)] = 1e-150
    likelihood[3:10, 0, 0] = 1e-150
    maps = ConnectedMaps(2, 13)
    belief = maps.posterior(likelihood)
    assert_allclose(belief.corridors_north, [[1.0, 0.0]] * 12, atol=1e-99)
    evidence = -900 * np.log(10) - np.log(float(maps.count))
    assert_allclose(belief.log_evidence, evidence, rtol=1e-12)


def test_two_by_two_by_hand() -> None:
    # 4 maps of one corridor, 4 of two (adjacent sides), 4 of three, 1 of four: 13. A corridor
    # is in (4 * 1 + 4 * 2 + 4 * 3 + 1 * 4) / 4 = 7 of them. A corner has no corridor in the 2
    # maps of one corridor and the 1 of two that avoid it: 3 of 13.
    maps = ConnectedMaps(2, 2)
    belief = maps.posterior(uniform(maps))
    assert maps.count == 13
    assert_allclose(belief.corridors, 7 / 13)
    assert_allclose(belief.junctions[0, 0, 0], 3 / 13)
    assert_allclose(belief.log_evidence, 0.0, atol=1e-14)
    assert_allclose(belief.entropy, np.log(13))
    # Odds o: the total is 4 o + 4 o^2 + 4 o^3 + o^4; for o = 2: 8 + 16 + 32 + 16 = 72, and a
    # corridor has (8 + 2 * 16 + 3 * 32 + 4 * 16) / 4 = 50 of them.
    assert_allclose(maps.posterior(uniform(maps), corridor_odds=2.0).corridors, 50 / 72)


def test_evidence_has_the_scale_of_the_likelihoods() -> None:
    maps = ConnectedMaps(3, 2)
    belief = maps.posterior(uniform(maps) * 0.5, 3.0, np.full((7, 2), 0.1))
    assert_allclose(belief.log_evidence, 6 * np.log(0.5) + 7 * np.log(0.1))


@pytest.mark.parametrize(("columns", "rows"), [(5, 5), (6, 4), (3, 8), (7, 7)])
def test_one_more_reading_follows_bayes_rule(columns: int, rows: int) -> None:
    # Too many maps to list, but P(new reading | old) must be the sum of pi(J) lambda(J), and
    # the junction's new belief their product: for any junction, at any size.
    maps = ConnectedMaps(columns, rows)
    likelihood = random_likelihood(columns, rows, 4)
    old = maps.posterior(likelihood, 0.8)
    for x, y in [(0, 0), (columns - 1, rows // 2), (columns // 2, rows - 1)]:
        reading = np.random.default_rng(x + y).random(JUNCTION_TYPES)
        updated = likelihood.copy()
        updated[y, x] *= reading
        new = maps.posterior(updated, 0.8)
        product = old.junctions[y, x] * reading
        assert_allclose(new.log_evidence - old.log_evidence, np.log(product.sum()), rtol=1e-10)
        assert_allclose(new.junctions[y, x], product / product.sum(), atol=1e-13)


def test_the_prior_is_kept_apart_for_each_odds() -> None:
    maps = ConnectedMaps(3, 3)
    likelihood = random_likelihood(3, 3, 5)
    for odds in (1.0, 0.2, 1.0):
        again = ConnectedMaps(3, 3).posterior(likelihood, odds)
        assert maps.posterior(likelihood, odds).log_evidence == again.log_evidence


def test_shapes() -> None:
    maps = ConnectedMaps(4, 3)
    belief = maps.posterior(uniform(maps))
    assert belief.junctions.shape == (3, 4, 16)
    assert belief.corridors.shape == (17,)
    assert belief.corridors_east.shape == (3, 3)
    assert belief.corridors_north.shape == (2, 4)
    assert belief.most_probable().shape == (17,)
    assert belief.sample(5, np.random.default_rng(0)).shape == (5, 17)
    grid = maps.grid
    assert belief.corridors_east[2, 1] == belief.corridors[grid.corridor(1, 2, EAST)]
    assert belief.corridors_north[1, 3] == belief.corridors[grid.corridor(3, 1, NORTH)]


def test_cells_are_pairs_of_states_and_types_in_both_passes() -> None:
    # One line: after an intersection nothing crosses, one corridor goes on north or east or
    # both, done, or dead: 1 + 3 + 2 = 6 states. No corridor entering allows 4 types; each of
    # three ways of entering allows 4 more: 16 pairs. Two intersections, two passes: 4 * 22.
    assert ConnectedMaps(1, 2).update_cells == 88
    assert ConnectedMaps(5, 4).update_cells == ConnectedMaps(4, 5).update_cells
    assert ConnectedMaps(12, 3).update_cells == 2 * ConnectedMaps(6, 3).update_cells


# Properties on grids of any shape.

shapes = st.tuples(st.integers(1, 4), st.integers(1, 4)).filter(lambda s: s[0] * s[1] > 1)
seeds = st.integers(0, 2**32 - 1)


@settings(max_examples=40, deadline=None)
@given(shapes, seeds)
def test_marginals_are_probabilities_and_agree_from_both_ends(
    shape: tuple[int, int], seed: int
) -> None:
    belief = ConnectedMaps(*shape).posterior(random_likelihood(*shape, seed))
    grid, junctions = belief.grid, belief.junctions
    assert_allclose(junctions.sum(axis=2), 1.0)
    for direction in DIRECTIONS:
        bits = np.array([bool(t & direction) for t in range(JUNCTION_TYPES)])
        for v in range(grid.intersections):
            x, y = grid.place(v)
            corridor = grid.corridor(x, y, direction)
            expected = belief.corridors[corridor] if corridor >= 0 else 0.0
            assert_allclose(junctions[y, x, bits].sum(), expected, atol=1e-13)


def turned(types: Floats, change: dict[int, int]) -> Floats:
    """The last axis, by junction type, with the directions changed."""
    new = [sum(change[d] for d in DIRECTIONS if t & d) for t in range(JUNCTION_TYPES)]
    result = np.empty_like(types)
    result[..., new] = types
    return result


TRANSPOSED = {NORTH: EAST, EAST: NORTH, SOUTH: WEST, WEST: SOUTH}
MIRRORED = {NORTH: NORTH, EAST: WEST, SOUTH: SOUTH, WEST: EAST}


@settings(max_examples=30, deadline=None)
@given(shapes, seeds)
def test_the_transposed_problem_has_the_transposed_answer(
    shape: tuple[int, int], seed: int
) -> None:
    columns, rows = shape
    likelihood = random_likelihood(columns, rows, seed)
    belief = ConnectedMaps(columns, rows).posterior(likelihood, 0.6)
    other = ConnectedMaps(rows, columns).posterior(
        turned(likelihood.transpose(1, 0, 2), TRANSPOSED), 0.6
    )
    expected = turned(belief.junctions.transpose(1, 0, 2), TRANSPOSED)
    assert_allclose(other.junctions, expected, atol=1e-12)
    assert_allclose(other.corridors_east, belief.corridors_north.T, atol=1e-12)
    assert_allclose(other.log_evidence, belief.log_evidence)
    assert_allclose(other.entropy, belief.entropy, atol=1e-9)


@settings(max_examples=30, deadline=None)
@given(shapes, seeds)
def test_the_mirrored_problem_has_the_mirrored_answer(shape: tuple[int, int], seed: int) -> None:
    maps = ConnectedMaps(*shape)
    likelihood = random_likelihood(*shape, seed)
    belief = maps.posterior(likelihood, 1.7)
    mirrored = maps.posterior(turned(likelihood[:, ::-1], MIRRORED), 1.7)
    assert_allclose(mirrored.junctions, turned(belief.junctions[:, ::-1], MIRRORED), atol=1e-12)
    assert_allclose(mirrored.corridors_east, belief.corridors_east[:, ::-1], atol=1e-12)
    assert_allclose(mirrored.log_evidence, belief.log_evidence)


# Samples.


@pytest.mark.parametrize("logarithmic", [False, True])
@pytest.mark.parametrize(("columns", "rows"), [(3, 2), (2, 3)])
def test_samples_follow_the_posterior(
    columns: int, rows: int, logarithmic: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    if logarithmic:
        monkeypatch.setattr(solution, "TOLERANCE", -1.0)
    problem = random_problem(columns, rows, 6)
    belief = ConnectedMaps(columns, rows).posterior(*problem)
    exact = enumerate_posterior(columns, rows, *problem)
    n = 40_000
    numbers = 1 << np.arange(belief.grid.corridors)
    drawn = np.bincount(belief.sample(n, np.random.default_rng(7)) @ numbers, minlength=128)
    expected = np.zeros(128)
    expected[exact.maps @ numbers] = exact.probability * n
    assert drawn[expected == 0].sum() == 0
    often = expected >= 5
    observed_counts = np.append(drawn[often], drawn[~often].sum())
    expected_counts = np.append(expected[often], expected[~often].sum())
    assert chisquare(observed_counts, expected_counts).pvalue > 0.001


def test_samples_repeat_with_the_seed_and_are_connected() -> None:
    maps = ConnectedMaps(5, 5)
    belief = maps.posterior(random_likelihood(5, 5, 8), 0.5)
    first = belief.sample(50, np.random.default_rng(9))
    assert (first == belief.sample(50, np.random.default_rng(9))).all()
    assert (first != belief.sample(50, np.random.default_rng(10))).any()
    assert all(maps.grid.connected(m) for m in first)
    surprise = -belief.log_probability(belief.sample(4000, np.random.default_rng(11)))
    assert abs(surprise.mean() - belief.entropy) < 4 * surprise.std() / np.sqrt(4000)


def test_sampling_given_a_junction_is_a_second_posterior() -> None:
    maps = ConnectedMaps(4, 4)
    likelihood = random_likelihood(4, 4, 12)
    likelihood[2, 1] *= np.arange(JUNCTION_TYPES) == NORTH | WEST
    drawn = maps.posterior(likelihood).sample(100, np.random.default_rng(13))
    assert (maps.grid.junction_types(drawn)[:, maps.grid.intersection(1, 2)] == NORTH | WEST).all()


def test_log_probability_of_maps_that_are_not_connected() -> None:
    maps = ConnectedMaps(2, 2)
    belief = maps.posterior(uniform(maps))
    # Empty; the two opposite sides; all four.
    given_maps = np.array([[0, 0, 0, 0], [1, 1, 0, 0], [1, 1, 1, 1]], dtype=np.uint8)
    assert_allclose(belief.log_probability(given_maps), [-np.inf, -np.inf, -np.log(13)])
