"""Sets of hypotheses: how they are drawn, and when they are replaced."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from bus.grid import JUNCTION_TYPES, Maps
from modules.geographer import ConnectedMaps, ContradictoryEvidenceError
from modules.geographer.density import medium_density
from modules.geographer.paper import (
    HypothesesError,
    HypothesisSet,
    direct_belief,
    draw_hypotheses,
    first_set,
    revise,
)
from tests.geographer.every_map import all_maps

Floats = NDArray[np.float64]
MAPS = ConnectedMaps(3, 3)
NOTHING = np.ones((3, 3, JUNCTION_TYPES))
WAY = [4, 5, 2, 1, 0, 3, 6, 7, 8]


def classified(truth: Maps, walk: list[int]) -> Floats:
    """Lambda(J) when these junctions were seen as they are in a map (corridors,)."""
    types = MAPS.grid.junction_types(truth[None])[0]
    likelihood = np.ones((9, JUNCTION_TYPES))
    likelihood[walk] = 0.0
    likelihood[walk, types[walk]] = 1.0
    return likelihood.reshape(3, 3, JUNCTION_TYPES)


def consistent(evidence: Floats) -> Maps:
    """Every connected map that the evidence does not rule out, by enumeration."""
    maps = all_maps(3, 3)
    rows = evidence.reshape(-1, JUNCTION_TYPES)
    fits = rows[np.arange(9), MAPS.grid.junction_types(maps)] > 0
    return maps[fits.all(axis=1)]


@pytest.mark.parametrize("states", [2, 10, 200])
def test_a_set_has_as_many_different_connected_maps_as_asked_for(states: int) -> None:
    chosen = first_set(MAPS, states, np.random.default_rng(1), medium_density(12))
    assert chosen.states == states
    assert not chosen.exhaustive
    assert chosen.prior.tolist() == [1 / states] * states


def test_the_same_seed_draws_the_same_set() -> None:
    sets = [first_set(MAPS, 50, np.random.default_rng(3)) for _ in range(2)]
    assert np.array_equal(sets[0].maps, sets[1].maps)


def test_medium_density_is_preferred() -> None:
    rng = np.random.default_rng(1)
    preferred = np.concatenate(
        [first_set(MAPS, 20, rng, medium_density(12, 0.5, 0.05)).maps for _ in range(20)]
    )
    anyhow = np.concatenate([first_set(MAPS, 20, rng).maps for _ in range(20)])
    # 5 % either way were asked for; all connected maps together spread more, around 0.59
    assert abs(preferred.mean(axis=1).mean() - 0.5) < 0.03
    assert preferred.mean(axis=1).std() < 0.07
    assert anyhow.mean(axis=1).mean() > 0.55
    assert anyhow.mean(axis=1).std() > 0.1


def test_all_possible_maps_are_taken_when_they_fit() -> None:
    evidence = classified(all_maps(3, 3)[1000], WAY[:4])
    possible = consistent(evidence)
    exact = MAPS.posterior(evidence)
    assert len(possible) > 5
    for states, fits in ((len(possible), False), (len(possible) + 1, True)):
        chosen = draw_hypotheses(exact, states, np.random.default_rng(1))
        assert chosen.exhaustive is fits
        listed = {m.tobytes() for m in possible}
        assert {m.tobytes() for m in chosen.maps} <= listed
        assert len(chosen.maps) == states - 1
    belief = direct_belief(chosen, evidence)
    assert np.abs(belief.junctions - exact.junctions).max() < 1e-9


def test_a_rare_map_keeps_a_set_from_being_exhaustive() -> None:
    surely = classified(all_maps(3, 3)[1000], WAY)
    almost = np.where(surely > 0, 1.0, 1e-3)
    chosen = draw_hypotheses(MAPS.posterior(almost), 50, np.random.default_rng(1))
    assert len(chosen.maps) < 49
    assert not chosen.exhaustive


def test_a_set_stays_while_one_of_its_maps_fits() -> None:
    rng = np.random.default_rng(1)
    chosen = first_set(MAPS, 10, rng)
    revision = revise(chosen, classified(chosen.maps[4], WAY[:5]), MAPS, 10, rng)
    assert not revision.replaced
    assert revision.hypotheses is chosen


def test_a_set_is_replaced_until_it_is_exhaustive_and_right() -> None:
    rng = np.random.default_rng(1)
    truth = all_maps(3, 3)[777]
    chosen, replaced = HypothesisSet(MAPS.grid, all_maps(3, 3)[:5]), 0
    for seen in range(len(WAY) + 1):
        evidence = classified(truth, WAY[:seen])
        before = direct_belief(chosen, evidence)
        revision = revise(chosen, evidence, MAPS, 6, rng)
        assert revision.replaced == (before.states[-1] > before.states[:-1].max())
        if revision.replaced:
            possible = {m.tobytes() for m in consistent(evidence)}
            assert {m.tobytes() for m in revision.hypotheses.maps} <= possible
            assert not revision.belief.nota_exceeds
        replaced += revision.replaced
        chosen = revision.hypotheses
    assert replaced > 1
    assert chosen.exhaustive
    assert chosen.contains(truth)
    assert revision.belief.states.max() == 1.0


def test_an_exhaustive_set_that_turns_out_wrong_is_replaced() -> None:
    truth, other = all_maps(3, 3)[[777, 12]]
    wrong = HypothesisSet(MAPS.grid, other[None], exhaustive=True)
    evidence = classified(truth, WAY)
    revision = revise(wrong, evidence, MAPS, 6, np.random.default_rng(1))
    assert revision.replaced
    assert revision.hypotheses.contains(truth)


def test_an_exhaustive_set_does_not_ask_for_a_density() -> None:
    only_one = np.zeros(13)
    only_one[5] = 1.0
    truth = all_maps(3, 3)[777]
    assert truth.sum() != 5
    wrong = HypothesisSet(MAPS.grid, all_maps(3, 3)[:1])
    revision = revise(wrong, classified(truth, WAY), MAPS, 6, np.random.default_rng(1), only_one)
    assert revision.hypotheses.contains(truth)


def test_bad_questions_are_refused() -> None:
    rng = np.random.default_rng(1)
    with pytest.raises(HypothesesError, match="found 1, expected at least 2"):
        draw_hypotheses(MAPS.posterior(NOTHING), 1, rng)
    nowhere = np.zeros_like(NOTHING)
    nowhere[:, :, 0] = 1.0  # no corridor at any junction: no map
    with pytest.raises(ContradictoryEvidenceError):
        revise(first_set(MAPS, 5, rng), nowhere, MAPS, 5, rng)
