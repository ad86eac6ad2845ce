from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from bus.grid import EAST, JUNCTION_TYPES, NORTH
from modules.geographer import (
    ConnectedMaps,
    ContradictoryEvidenceError,
    EvidenceError,
    GridTooWideError,
    PairLikelihood,
    ProblemTooLargeError,
)
from modules.geographer.density import medium_density, weights_for


@pytest.mark.parametrize(("columns", "rows"), [(0, 3), (3, -1), (1, 1)])
def test_grids_without_corridors(columns: int, rows: int) -> None:
    with pytest.raises(ValueError, match=f"columns={columns}, rows={rows}"):
        ConnectedMaps(columns, rows)


def test_too_wide_a_grid_says_what_it_would_need() -> None:
    # 11 lines: 223191 idle rests, 974427 - 223191 = 751236 joined ones, so 223191 + 3 * 751236
    # + 2 = 2476901 states; 11 * 12 intersections of 8 bytes each: 2.44 GiB.
    with pytest.raises(GridTooWideError) as error:
        ConnectedMaps(11, 12)
    # Cells: both passes, 132 steps, states and 4 * 223191 + 12 * 751236 pairs with types.
    cells = str(2 * 132 * (2476901 + 4 * 223191 + 12 * 751236))
    for fact in ("11 by 12", "2476901", cells, "2.4 GiB", "at most 10"):
        assert fact in str(error.value)


def test_long_grids_are_not_wide() -> None:
    assert ConnectedMaps(60, 2).posterior(np.ones((2, 60, 16))).corridors.shape == (178,)


@pytest.mark.parametrize(
    ("name", "arguments", "found", "expected"),
    [
        ("junction_likelihood", (np.ones((3, 2, 16)),), r"\(3, 2, 16\)", r"\(2, 3, 16\)"),
        ("corridor_odds", (np.ones((2, 3, 16)), np.ones(6)), r"\(6,\)", r"\(7,\)"),
        ("corridor_likelihood", (np.ones((2, 3, 16)), 1.0, np.ones(7)), r"\(7,\)", r"\(7, 2\)"),
    ],
)
def test_wrong_shapes(name: str, arguments: tuple[object], found: str, expected: str) -> None:
    with pytest.raises(EvidenceError, match=f"{name}: found shape {found}, expected {expected}"):
        ConnectedMaps(3, 2).posterior(*arguments)  # type: ignore[arg-type]


@pytest.mark.parametrize("bad", [-0.1, np.nan, np.inf])
def test_numbers_that_are_no_likelihoods(bad: float) -> None:
    maps = ConnectedMaps(3, 2)
    likelihood = np.ones((2, 3, 16))
    likelihood[1, 2, 5] = bad
    with pytest.raises(EvidenceError, match=rf"junction_likelihood\[1, 2, 5\]: found {bad}"):
        maps.posterior(likelihood)
    with pytest.raises(EvidenceError, match=rf"corridor_odds.*found {bad}"):
        maps.posterior(np.ones((2, 3, 16)), corridor_odds=bad)
    corridors = np.ones((7, 2))
    corridors[6, 1] = bad
    with pytest.raises(EvidenceError, match=rf"corridor_likelihood\[6, 1\]: found {bad}"):
        maps.posterior(np.ones((2, 3, 16)), 1.0, corridors)


def test_odds_that_allow_no_map() -> None:
    with pytest.raises(EvidenceError, match="corridor_odds: no connected map"):
        ConnectedMaps(2, 2).posterior(np.ones((2, 2, 16)), corridor_odds=0.0)


def test_contradiction_names_the_junctions_that_speak() -> None:
    # The junction at (0, 0) has a corridor east for certain, its neighbour (1, 0) none west.
    likelihood = np.ones((3, 3, JUNCTION_TYPES))
    likelihood[0, 0] = np.arange(JUNCTION_TYPES) == EAST
    likelihood[0, 1] = np.arange(JUNCTION_TYPES) == NORTH
    # Types that lead off the grid are no evidence.
    likelihood[2, 2, NORTH] = 0.0
    with pytest.raises(ContradictoryEvidenceError) as error:
        ConnectedMaps(3, 3).posterior(likelihood)
    assert "[0,0], [1,0]" in str(error.value)
    assert "[2,2]" not in str(error.value)


def test_contradiction_by_connectedness_alone() -> None:
    # Both lines of a ladder of three rungs are known, its rungs absent: not one component.
    likelihood = np.zeros((3, 2, JUNCTION_TYPES))
    likelihood[0, :, NORTH] = likelihood[1, :, NORTH | 4] = likelihood[2, :, 4] = 1.0
    with pytest.raises(ContradictoryEvidenceError):
        ConnectedMaps(2, 3).posterior(likelihood)
    likelihood[1, 0, NORTH | EAST | 4] = likelihood[1, 1, NORTH | 4 | 8] = 1.0
    belief = ConnectedMaps(2, 3).posterior(likelihood)
    assert belief.corridors_east[:, 0] == pytest.approx([0, 1, 0])


def test_contradictory_corridors() -> None:
    with pytest.raises(ContradictoryEvidenceError, match=r"together$"):
        ConnectedMaps(2, 2).posterior(np.ones((2, 2, 16)), 1.0, np.array([[1.0, 0.0]] * 4))


def test_counts_that_are_none() -> None:
    flat = np.ones((2, 2, 16))
    maps = ConnectedMaps(2, 2)
    with pytest.raises(EvidenceError, match=r"corridor_count_weights: found shape \(4,\), exp.*5"):
        maps.posterior(flat, corridor_count_weights=np.ones(4))
    with pytest.raises(EvidenceError, match=r"corridor_count_weights\[1\]: found -1.0"):
        maps.posterior(flat, corridor_count_weights=[0, -1, 1, 1, 1])
    # No connected map has no corridor.
    with pytest.raises(EvidenceError, match=r"no connected map.*corridor_count_weights"):
        maps.posterior(flat, corridor_count_weights=[1, 0, 0, 0, 0])


@pytest.mark.parametrize(
    ("first", "second"), [((0, 0), (1, 1)), ((0, 0), (0, 0)), ((2, 0), (3, 0)), ((-1, 0), (0, 0))]
)
def test_pairs_that_are_no_neighbours(first: tuple[int, int], second: tuple[int, int]) -> None:
    pair = PairLikelihood(first, second, np.ones((16, 16)))
    with pytest.raises(EvidenceError, match=r"pairs\[0\]: found junctions .* two neighbours"):
        ConnectedMaps(3, 3).posterior(np.ones((3, 3, 16)), pairs=[pair])


def test_pairs_with_a_table_that_is_none() -> None:
    for table, said in ((np.ones((16, 15)), r"shape \(16, 15\)"), (np.full((16, 16), -1), "-1.0")):
        pair = PairLikelihood((0, 0), (1, 0), table)
        with pytest.raises(EvidenceError, match=rf"pairs\[0\].likelihood.*found {said}"):
            ConnectedMaps(3, 3).posterior(np.ones((3, 3, 16)), pairs=[pair])


def test_numbers_that_are_no_numbers() -> None:
    with pytest.raises(EvidenceError, match="junction_likelihood: expected numbers"):
        ConnectedMaps(2, 2).posterior([["a", "b"], ["c"]])


def test_too_much_to_remember_says_what_it_would_need() -> None:
    counts = np.ones(9 * 8 * 2 + 1)
    with pytest.raises(ProblemTooLargeError, match=r"\d+ table entries.* GiB; at most 4 GiB"):
        ConnectedMaps(9, 9).posterior(np.ones((9, 9, 16)), corridor_count_weights=counts)
    # Six pairs across the same frontier: 8^6 classes at once.
    table = np.random.default_rng(1).random((16, 16))
    pairs = [PairLikelihood((x, 1), (x, 2), table) for x in range(7)]
    with pytest.raises(ProblemTooLargeError):
        ConnectedMaps(7, 7).posterior(np.ones((7, 7, 16)), pairs=pairs)


@pytest.mark.parametrize("density", [(0.0, 0.1), (1.1, 0.1), (0.5, 0.0), (0.5, np.nan)])
def test_densities_that_are_none(density: tuple[float, float]) -> None:
    with pytest.raises(EvidenceError, match="density: found mean"):
        medium_density(24, *density)


def test_probabilities_of_numbers_that_no_map_has() -> None:
    possible = ConnectedMaps(2, 2).count_by_corridors()
    with pytest.raises(EvidenceError, match=r"probability: found \[1.0\] for \[0\] corridors"):
        weights_for([1, 0, 0, 0, 0], possible)
    with pytest.raises(EvidenceError, match=r"a sum of 0\.0"):
        weights_for(np.zeros(5), possible)


def test_maps_of_the_wrong_form() -> None:
    belief = ConnectedMaps(2, 2).posterior(np.ones((2, 2, 16)))
    with pytest.raises(EvidenceError, match=r"maps: found shape \(4,\), expected \(n, 4\)"):
        belief.log_probability(np.ones(4, np.uint8))
    with pytest.raises(EvidenceError, match="maps: found an entry 2, expected 0 or 1"):
        belief.log_probability(np.full((1, 4), 2, np.uint8))


def test_importing_compiles_nothing() -> None:
    program = (
        "import modules.geographer as g\n"
        "from modules.geographer import log_kernels, register_kernels, sweep_kernels\n"
        "from modules.geographer import walk_kernels\n"
        "modules = log_kernels, register_kernels, sweep_kernels, walk_kernels\n"
        "kernels = [k for m in modules\n"
        "           for k in vars(m).values() if hasattr(k, 'signatures')]\n"
        "assert len(kernels) >= 8 and not any(k.signatures for k in kernels)\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
