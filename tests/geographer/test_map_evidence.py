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
)


@pytest.mark.parametrize(("columns", "rows"), [(0, 3), (3, -1), (1, 1)])
def test_grids_without_corridors(columns: int, rows: int) -> None:
    with pytest.raises(ValueError, match=f"columns={columns}, rows={rows}"):
        ConnectedMaps(columns, rows)


def test_too_wide_a_grid_says_what_it_would_need() -> None:
    # 11 lines: 223191 idle rests, 974427 - 223191 = 751236 joined ones, so 223191 + 3 * 751236
    # + 2 = 2476901 states; 11 * 12 intersections of 8 bytes each: 2.44 GiB.
    with pytest.raises(GridTooWideError) as error:
        ConnectedMaps(11, 12)
    for fact in ("11 by 12", "2476901", "2.4 GiB", "at most 10"):
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
    with pytest.raises(EvidenceError, match="corridor_odds: all are 0"):
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
    with pytest.raises(ContradictoryEvidenceError, match="corridors have evidence too"):
        ConnectedMaps(2, 2).posterior(np.ones((2, 2, 16)), 1.0, np.array([[1.0, 0.0]] * 4))


def test_maps_of_the_wrong_form() -> None:
    belief = ConnectedMaps(2, 2).posterior(np.ones((2, 2, 16)))
    with pytest.raises(EvidenceError, match=r"maps: found shape \(4,\), expected \(n, 4\)"):
        belief.log_probability(np.ones(4, np.uint8))
    with pytest.raises(EvidenceError, match="maps: found an entry 2, expected 0 or 1"):
        belief.log_probability(np.full((1, 4), 2, np.uint8))


def test_importing_compiles_nothing() -> None:
    program = (
        "import modules.geographer as g\n"
        "from modules.geographer import log_kernels, sweep_kernels, walk_kernels\n"
        "kernels = [k for m in (log_kernels, sweep_kernels, walk_kernels)\n"
        "           for k in vars(m).values() if hasattr(k, 'signatures')]\n"
        "assert len(kernels) >= 8 and not any(k.signatures for k in kernels)\n"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
