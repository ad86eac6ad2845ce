"""One more reading: the same belief as from scratch, by less work."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from modules.geographer import (
    ConnectedMaps,
    ContradictoryEvidenceError,
    EvidenceError,
    MapBelief,
    PairLikelihood,
    map_belief,
    solution,
    sweep_kernels,
)
from modules.geographer.messages import Messages
from tests.geographer.every_map import Floats


def assert_same(found: MapBelief, expected: MapBelief) -> None:
    assert_allclose(found.log_evidence, expected.log_evidence, rtol=1e-12, atol=1e-12)
    assert_allclose(found.junctions, expected.junctions, atol=1e-13)
    assert_allclose(found.corridors, expected.corridors, atol=1e-13)
    assert_allclose(found.entropy, expected.entropy, atol=1e-10)
    assert (found.most_probable() == expected.most_probable()).all()
    drawn = [belief.sample(20, np.random.default_rng(1)) for belief in (found, expected)]
    assert (drawn[0] == drawn[1]).all()
    logs = [belief.log_probability(drawn[0]) for belief in (found, expected)]
    assert_allclose(logs[0], logs[1], rtol=1e-12, atol=1e-12)


@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from([(1, 2), (4, 1), (2, 2), (3, 3), (5, 4), (4, 6)]),
    st.lists(st.tuples(st.integers(0, 99), st.booleans()), min_size=1, max_size=5),
    st.integers(0, 2**32 - 1),
    st.sampled_from([0, map_belief.FEW]),
)
def test_updates_one_after_the_other(
    shape: tuple[int, int], visits: list[tuple[int, bool]], seed: int, few: int
) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(map_belief, "FEW", few)
        check_updates(shape, visits, seed)


def check_updates(shape: tuple[int, int], visits: list[tuple[int, bool]], seed: int) -> None:
    # Some beliefs between are asked for everything, some for nothing.
    maps = ConnectedMaps(*shape)
    rng = np.random.default_rng(seed)
    likelihood = rng.random((shape[1], shape[0], 16))
    belief = maps.posterior(likelihood, 0.7)
    for number, asked in visits:
        x, y = maps.grid.place(number % maps.grid.intersections)
        reading = rng.random(16) ** 4 * 3.0
        likelihood[y, x] *= reading
        belief = belief.update(x, y, reading)
        fresh = maps.posterior(likelihood, 0.7)
        assert_allclose(belief.log_evidence, fresh.log_evidence, rtol=1e-12)
        assert_allclose(belief.junction(x, y), fresh.junctions[y, x], atol=1e-13)
        if asked:
            assert_same(belief, fresh)
    assert_same(belief, fresh)


@pytest.mark.usefixtures("no_grid_is_small")
def test_junctions_one_by_one() -> None:
    maps = ConnectedMaps(4, 5)
    likelihood = np.random.default_rng(1).random((5, 4, 16))
    old = maps.posterior(likelihood)
    belief = old.update(1, 2, np.arange(16.0))
    for y in range(5):
        for x in range(4):
            alone = old.update(1, 2, np.arange(16.0)).junction(x, y)
            assert_allclose(alone, belief.junctions[y, x], atol=1e-14)
            assert_allclose(old.junction(x, y), old.junctions[y, x], atol=0)


class Steps:
    """Counts the steps that messages take."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.taken = 0
        for name in ("pull_step", "push_step"):
            monkeypatch.setattr(sweep_kernels, name, self._counted(name))

    def _counted(self, name: str):  # type: ignore[no-untyped-def]
        original = getattr(sweep_kernels, name)

        def counted(*arguments: object) -> object:
            self.taken += 1
            return original(*arguments)

        return counted


@pytest.fixture
def no_grid_is_small(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(map_belief, "FEW", 0)


@pytest.mark.usefixtures("no_grid_is_small")
def test_how_much_work_an_update_is(monkeypatch: pytest.MonkeyPatch) -> None:
    # The claim of the docstring, in steps of the sweep: a fresh belief takes 30 back and 30 forth.
    maps = ConnectedMaps(5, 6)
    belief = maps.posterior(np.random.default_rng(1).random((6, 5, 16)))
    belief = belief.update(4, 5, np.ones(16))
    belief.junctions  # noqa: B018
    steps = Steps(monkeypatch)
    reading = np.random.default_rng(2).random(16)
    new = belief.update(2, 3, reading)
    assert new.log_evidence != belief.log_evidence
    assert new.junction(2, 3).sum() == pytest.approx(1.0)
    assert steps.taken == 0
    new.junction(3, 3)
    assert steps.taken == 1
    new.junction(2, 2)
    assert steps.taken == 1 + 5
    new.junctions  # noqa: B018
    assert steps.taken == 29
    for _ in range(10):  # more readings at one place cost nothing more
        new = new.update(2, 3, reading)
    assert steps.taken == 29


def _modes() -> list[dict[str, object]]:
    table = np.random.default_rng(3).random((16, 16))
    return [
        {"corridor_count_weights": np.arange(13.0)},
        {"pairs": [PairLikelihood((0, 0), (0, 1), table)]},
    ]


@pytest.mark.parametrize("mode", _modes(), ids=["counted", "pairs"])
def test_updates_of_what_is_not_local(mode: dict[str, object]) -> None:
    maps = ConnectedMaps(3, 3)
    likelihood = np.random.default_rng(4).random((3, 3, 16))
    reading = np.random.default_rng(5).random(16)
    found = maps.posterior(likelihood, **mode).update(1, 2, reading)  # type: ignore[arg-type]
    likelihood[2, 1] *= reading
    assert_same(found, maps.posterior(likelihood, **mode))  # type: ignore[arg-type]


def test_updates_in_logarithms(monkeypatch: pytest.MonkeyPatch) -> None:
    maps = ConnectedMaps(3, 3)
    likelihood = np.random.default_rng(4).random((3, 3, 16))
    old = maps.posterior(likelihood)
    reading = np.random.default_rng(5).random(16)
    late = old.update(1, 2, reading)
    monkeypatch.setattr(solution, "TOLERANCE", -1.0)
    found = maps.posterior(likelihood).update(1, 2, reading)
    likelihood[2, 1] *= reading
    assert_same(found, maps.posterior(likelihood))
    assert_same(late, maps.posterior(likelihood))


def _certain(junction_type: int, otherwise: float) -> Floats:
    likelihood = np.full(16, otherwise)
    likelihood[junction_type] = 1.0
    return likelihood


@pytest.mark.usefixtures("no_grid_is_small")
@pytest.mark.parametrize("otherwise", [1e-5, 1e-60, 1e-300, 0.0])
def test_evidence_against_all_that_was_believed(otherwise: float) -> None:
    # What was all but ruled out comes back: old marginals have no digits left for it.
    maps = ConnectedMaps(3, 3)
    likelihood = np.ones((3, 3, 16))
    likelihood[1, 1] = _certain(15, max(otherwise, 1e-300))
    reading = _certain(1, otherwise)
    found = maps.posterior(likelihood).update(1, 1, reading).update(0, 1, np.arange(16.0))
    likelihood[1, 1] *= reading
    likelihood[1, 0] *= np.arange(16.0)
    assert_same(found, maps.posterior(likelihood))


def test_the_old_belief_stays() -> None:
    maps = ConnectedMaps(4, 4)
    old = maps.posterior(np.ones((4, 4, 16)))
    before = old.junctions.copy(), old.log_evidence
    old.update(1, 1, np.arange(16.0)).junctions  # noqa: B018
    assert (old.junctions == before[0]).all()
    assert old.log_evidence == before[1]
    assert isinstance(old._messages, Messages)


def test_contradictory_updates() -> None:
    belief = ConnectedMaps(2, 2).posterior(np.ones((2, 2, 16)))
    belief = belief.update(0, 0, _certain(2, 0.0))
    with pytest.raises(ContradictoryEvidenceError) as error:
        belief.update(1, 0, _certain(1, 0.0))
    assert error.value.junctions == [(0, 0), (1, 0)]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((2, 0, np.ones(16)), r"junction: found \[2,0\], expected one on the grid of 2 by 3"),
        ((0, -1, np.ones(16)), r"found \[0,-1\]"),
        ((0, 0, np.ones(15)), r"likelihood: found shape \(15,\), expected \(16,\)"),
        ((0, 0, np.full(16, np.nan)), r"likelihood\[0\]: found nan"),
        ((0, 0, -np.ones(16)), r"likelihood\[0\]: found -1.0"),
    ],
)
def test_updates_that_are_none(arguments: tuple[int, int, Floats], said: str) -> None:
    belief = ConnectedMaps(2, 3).posterior(np.ones((3, 2, 16)))
    with pytest.raises(EvidenceError, match=said):
        belief.update(*arguments)


# Expected values.


def test_expected_values_and_their_error() -> None:
    maps = ConnectedMaps(4, 4)
    belief = maps.posterior(np.random.default_rng(1).random((4, 4, 16)))
    found = belief.expect(lambda drawn: drawn.sum(axis=1), 4000, np.random.default_rng(2))
    exact = belief.corridors.sum()
    assert abs(found.mean - exact) < 4 * found.standard_error
    counts = np.arange(25)
    variance = belief.corridor_counts @ (counts - exact) ** 2
    assert_allclose(found.standard_error, np.sqrt(variance / 4000), rtol=0.05)
    assert found.n == 4000
    again = belief.expect(lambda drawn: drawn.sum(axis=1), 4000, np.random.default_rng(2))
    assert found == again


def test_standard_errors_cover_the_truth_as_often_as_they_should() -> None:
    # Two standard errors are 95.4 %: of 200 estimates fewer than 180 or all 200 would be odd.
    belief = ConnectedMaps(3, 3).posterior(np.random.default_rng(3).random((3, 3, 16)))
    rng = np.random.default_rng(4)
    inside = 0
    for _ in range(200):
        found = belief.expect(lambda drawn: drawn[:, 5], 400, rng)
        inside += abs(found.mean - belief.corridors[5]) < 2 * found.standard_error
    assert 180 <= inside < 200


def test_functions_and_draws_that_do_not_fit() -> None:
    belief = ConnectedMaps(2, 2).posterior(np.ones((2, 2, 16)))
    rng = np.random.default_rng(0)
    with pytest.raises(ValueError, match=r"n: found 1, expected at least 2"):
        belief.expect(lambda drawn: drawn.sum(axis=1), 1, rng)
    with pytest.raises(ValueError, match=r"values of shape \(\), expected \(10,\)"):
        belief.expect(lambda drawn: drawn.sum(), 10, rng)
