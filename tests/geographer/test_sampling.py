"""The weighted set of maps: exact given each junction type, and together the belief itself."""

from __future__ import annotations

import numpy as np
import pytest

from modules.geographer.connected_maps import ConnectedMaps
from modules.geographer.sampling import weighted_maps


def _belief(seed: int):  # type: ignore[no-untyped-def]
    rng = np.random.default_rng(seed)
    return ConnectedMaps(3, 3).posterior(rng.random((3, 3, 16)) + 0.01)


@pytest.mark.parametrize("place", [0, 4, 5])
def test_weights_are_the_types_probabilities(place: int) -> None:
    belief = _belief(place)
    found = weighted_maps(belief, place, 16, np.random.default_rng(1))
    types = belief.grid.junction_types(found.maps)[:, place]
    x, y = belief.grid.place(place)
    seen = np.unique(types)
    mass = belief.junctions[y, x, seen].sum()
    for t in seen:
        assert found.weights[types == t].sum() == pytest.approx(belief.junctions[y, x, t] / mass)
    assert found.weights.sum() == pytest.approx(1.0)
    assert mass > 0.95, "only improbable types may have no maps"
    assert max(np.bincount(types)) <= 16


def test_maps_of_a_type_stand_together_and_are_a_sample_given_it() -> None:
    """Corridor frequencies given the type, from many small sets, against the exact posterior."""
    belief, place = _belief(7), 4
    x, y = belief.grid.place(place)
    wanted = int(belief.junctions[y, x].argmax())
    likelihood = np.random.default_rng(7).random((3, 3, 16)) + 0.01
    only = likelihood.copy()
    only[y, x, np.arange(16) != wanted] = 0.0
    exact = ConnectedMaps(3, 3).posterior(only).corridors
    rng = np.random.default_rng(2)
    first = []
    for _ in range(400):
        found = weighted_maps(belief, place, 4, rng)
        types = belief.grid.junction_types(found.maps)[:, place]
        assert (np.diff(types.astype(int)) >= 0).all()
        first += found.maps[types == wanted].tolist()
    share = np.mean(first, axis=0)
    # 1,000 or more maps: the standard error is at most 0.016
    assert len(first) > 1000
    assert share == pytest.approx(exact, abs=0.08)


def test_log_probability_is_the_exact_one() -> None:
    belief = _belief(3)
    found = weighted_maps(belief, 0, 8, np.random.default_rng(5))
    assert found.log_probability == pytest.approx(belief.log_probability(found.maps))
    assert found.cells == 16 * 8 * belief.grid.corridors
