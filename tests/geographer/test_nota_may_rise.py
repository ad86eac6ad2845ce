"""NOTA may rise on evidence that a hypothesis is consistent with: the paper says it falls.

"Adding evidence which is consistent with one or more maps in the hypothesis node causes the
posterior probability of the NOTA state to fall" (section 3). More in docs/where-the-paper-errs.md.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from bus.grid import EAST, JUNCTION_TYPES, NORTH, Grid
from modules.geographer.paper import HypothesisSet, PaperNetwork, direct_belief
from modules.geographer.paper.junction_tree import JunctionTree
from tests.geographer.every_map import all_maps

EVERY = all_maps(3, 3)
GRID = Grid(3, 3)


def seen(types: dict[int, int]) -> NDArray[np.float64]:
    """Hard evidence: the types of some intersections."""
    likelihood = np.ones((9, JUNCTION_TYPES))
    for v, junction_type in types.items():
        likelihood[v] = 0.0
        likelihood[v, junction_type] = 1.0
    return likelihood.reshape(3, 3, JUNCTION_TYPES)


def nine_maps() -> HypothesisSet:
    """One map whose south-west corner is NE, and eight whose corner is something else."""
    corner = GRID.junction_types(EVERY)[:, 0]
    return HypothesisSet(
        GRID, np.concatenate([EVERY[corner == NORTH | EAST][:1], EVERY[corner == EAST][:8]])
    )


def test_nota_doubles_though_a_map_fits() -> None:
    chosen, evidence = nine_maps(), seen({0: NORTH | EAST})
    belief = direct_belief(chosen, evidence)
    # n = 9 maps, k = 1 fits, q = 1/4 as a corner has 4 types: (1/4) / (1 + 1/4)
    assert chosen.prior[chosen.nota] == pytest.approx(0.1)
    assert belief.nota == pytest.approx(0.2)
    assert belief.states[0] == pytest.approx(0.8)
    assert JunctionTree(PaperNetwork(chosen)).update(evidence).nota == pytest.approx(0.2)


def test_with_three_maps_that_fit_it_falls() -> None:
    corner = GRID.junction_types(EVERY)[:, 0]
    fits = corner == NORTH | EAST
    chosen = HypothesisSet(GRID, np.concatenate([EVERY[fits][:3], EVERY[~fits][:6]]))
    assert direct_belief(chosen, seen({0: NORTH | EAST})).nota == pytest.approx(0.25 / 3.25)


@given(
    numbers=st.lists(st.integers(0, len(EVERY) - 1), min_size=1, max_size=40, unique=True),
    places=st.sets(st.integers(0, 8), min_size=1, max_size=3),
    which=st.integers(0, 39),
)
def test_nota_falls_exactly_if_more_than_q_n_maps_fit(
    numbers: list[int], places: set[int], which: int
) -> None:
    chosen = HypothesisSet(GRID, EVERY[numbers])
    n, observed = len(numbers), sorted(places)
    truth = chosen.types[which % n]
    k = int((chosen.types[:, observed] == truth[observed]).all(axis=1).sum())
    q = Fraction(1)
    for v in observed:
        q /= len(chosen.types_at(v))
    belief = direct_belief(chosen, seen({v: int(truth[v]) for v in observed}))

    assert belief.nota == pytest.approx(float(q / (k + q)), rel=1e-12)
    before = Fraction(1, n + 1)
    assert (q / (k + q) < before) == (k > q * n)
    if k != q * n:
        assert (belief.nota < chosen.prior[chosen.nota]) == (k > q * n)
