"""The learned estimates: the file, what they say, and that they were fitted to what happens."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.methods import HELD_OUT, estimated, fit, fitted, of
from benchmarks.methods_worlds import trial
from bus.grid import Grid
from modules.decider import methods
from modules.decider.methods import (
    FEATURES,
    METHODS,
    Estimate,
    EstimatesError,
    Outlook,
    choose_method,
    features,
    shipped_estimates,
)
from modules.decider.methods.estimate import parse_estimates
from modules.decider.roads import OPEN, PLANNED, SEEN_ABSENT, roads_of

FILE = Path(methods.__file__).parent / "estimates.json"
SQUARE = roads_of(Grid(2, 2), np.full(4, 100.0))


def outlook(levels: list[int]) -> Outlook:
    maps = np.array([[1, 1, 1, 1], [1, 0, 1, 1], [0, 1, 1, 1]], dtype=np.uint8)
    return Outlook(np.array(levels, dtype=np.uint8), maps, np.full(3, 1 / 3), 0, 3)


def test_features_by_hand() -> None:
    # 0 -c0- 1 -c3- 3 is known; c1 (2-3) is in 2 of 3 maps; c2 (0-2) is known.
    x = dict(zip(FEATURES, features(SQUARE, outlook([3, OPEN, 3, 3])), strict=True))
    p = 3 / 4
    entropy = -p * np.log(p) - (1 - p) * np.log(1 - p)
    assert x["one"] == 1 and x["distance"] == 2 and x["surest length"] == 2
    assert x["surest doubt"] == 0 and x["known way"] == 1 and x["known detour"] == 0
    assert x["unknown corridors"] == 1 and x["density"] == pytest.approx(p)
    assert x["entropy"] == pytest.approx(entropy)
    assert x["distance x entropy"] == pytest.approx(2 * entropy)
    doubtful = dict(zip(FEATURES, features(SQUARE, outlook([0, OPEN, 3, 3])), strict=True))
    assert doubtful["known way"] == 0
    assert doubtful["surest doubt"] == pytest.approx(-np.log(p))
    assert doubtful["distance x doubt"] == pytest.approx(-2 * np.log(p))


def test_the_choice_is_the_least_total_and_ties_go_to_the_first() -> None:
    cheap = Estimate("shortest", 100, 0.5, 50)
    telling = Estimate("avoid known", 140, 2.0, 40)
    assert choose_method((cheap, telling), 3).method == "shortest"  # 250 against 260
    assert choose_method((cheap, telling), 5).method == "avoid known"  # 350 against 340
    assert choose_method((cheap, telling), 4).method == "shortest"  # 300 each


def test_no_errand_is_estimated_shorter_than_it_can_be() -> None:
    for levels in ([3, 3, 3, 3], [OPEN] * 4, [3, SEEN_ABSENT, OPEN, OPEN]):
        for estimate in shipped_estimates().of(SQUARE, outlook(levels)):
            assert estimate.seconds >= 200.0
            assert estimate.nats >= 0.0


def test_estimates_scale_with_the_corridors() -> None:
    slow = roads_of(Grid(2, 2), np.full(4, 300.0))
    here, there = (shipped_estimates().of(r, outlook([OPEN] * 4)) for r in (SQUARE, slow))
    for a, b in zip(here, there, strict=True):
        assert b.seconds == pytest.approx(3 * a.seconds)
        assert b.later_s == pytest.approx(3 * a.later_s)
        assert b.nats == pytest.approx(a.nats)


def test_a_regression_finds_a_line() -> None:
    rng = np.random.default_rng(0)
    x = np.concatenate([np.ones((5000, 1)), rng.normal(size=(5000, 2))], axis=1)
    assert fit(x, x @ [3.0, 2.0, -1.0]) == pytest.approx([3, 2, -1], abs=1e-3)


def test_a_trial_and_a_fit_repeat_bit_for_bit() -> None:
    first, again = ([trial(seed) for seed in range(12)] for _ in range(2))
    assert json.dumps(fitted(first)) == json.dumps(fitted(again))


def test_the_shipped_estimates_hold_in_worlds_they_were_not_fitted_on() -> None:
    found = [trial(HELD_OUT + seed) for seed in range(120)]
    for target in ("corridors", "nats"):
        error = of(found, target) - estimated(found, target)
        spread = error.std(axis=0, ddof=1) / len(found) ** 0.5
        assert (abs(error.mean(axis=0)) < 4 * spread).all()
    # They are worth more than one number for all: the error is less than the spread.
    for k in range(METHODS.index("random")):
        error = of(found, "corridors")[:, k] - estimated(found, "corridors")[:, k]
        assert error.std() < 0.8 * of(found, "corridors")[:, k].std()


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"version": 2}, "version: found 2, expected 1"),
        ({"features": ["one"]}, "features: found"),
        ({"methods": {}}, "methods: found"),
        ({"more": 1}, "more"),
    ],
)
def test_a_file_that_does_not_fit_is_refused(change: dict[str, object], says: str) -> None:
    text = json.dumps({**json.loads(FILE.read_text()), **change})
    with pytest.raises(EstimatesError, match=says):
        parse_estimates(text.encode(), "file.json")


def test_levels_of_known_corridors_need_no_hypotheses() -> None:
    nothing = Outlook(np.full(4, PLANNED, np.uint8), np.empty((0, 4), np.uint8), np.empty(0), 0, 3)
    x = dict(zip(FEATURES, features(SQUARE, nothing), strict=True))
    assert x["entropy"] == 0 and x["density"] == 0 and x["known way"] == 1
