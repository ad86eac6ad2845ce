"""The calibration repeats, whoever shares the work, and the shipped model comes from it."""

import re

import numpy as np
import pytest

from bus.features import DOOR_JAMB, FLAT_WALL, OPENING, Wedges
from modules.classifier.geometry import JAMB_RATE
from modules.classifier.sensor_model import load_sensor_model
from scenarios.calibrate_detectors import (
    RING,
    CalibrationError,
    calibrate,
    durations_s,
    share_right,
    trial,
)
from scenarios.trial_junction import OPEN_SHARE
from simworld.sonar import SonarRing


def test_counts_depend_on_the_seed_not_on_the_workers() -> None:
    done: list[int] = []
    alone = calibrate(30, seed=5, progress=done.append)
    shared = calibrate(30, seed=5, workers=2)
    assert done == [25, 30]
    assert np.array_equal(alone.counts, shared.counts)
    assert alone.as_json() == shared.as_json()
    assert not np.array_equal(alone.counts, calibrate(30, seed=6).counts)
    assert (alone.counts.sum(axis=(2, 3)) == 30).all()


def test_a_trial_depends_on_the_seed_and_its_number_alone() -> None:
    one_by_one = [trial(np.random.default_rng([5, number]), RING).counts for number in range(30)]
    assert np.array_equal(calibrate(30, seed=5).counts, sum(one_by_one))
    assert np.array_equal(calibrate(7, seed=5).counts, sum(one_by_one[:7]))


def test_the_shipped_model_comes_from_its_command() -> None:
    shipped = load_sensor_model()
    command = r"waywiser calibrate detectors --trials (\d+) --seed (\d+)"
    made = re.fullmatch(command, shipped.made_by)
    assert made is not None
    trials, seed = (int(number) for number in made.groups())
    assert (shipped.counts.sum(axis=(2, 3)) == trials).all()
    assert np.array_equal(shipped.durations_s, durations_s())
    # Trials have their own seeds, so the first few are among the shipped ones.
    first = calibrate(40, seed)
    assert (first.counts <= shipped.counts).all()
    assert first.ring == shipped.ring


def test_other_trials_agree_with_the_shipped_model() -> None:
    shipped, other = load_sensor_model(), calibrate(80, seed=99)
    n = other.counts.sum(axis=-1, keepdims=True)
    p = shipped.probability
    # Five standard deviations of a binomial, and two trials for the rare classes.
    allowed = 5 * np.sqrt(n * p * (1 - p)) + 2
    assert (np.abs(other.counts - n * p) <= allowed).all()


def test_every_detector_is_right_in_most_trials() -> None:
    right = share_right(load_sensor_model())
    # A wall beside has a door at a rate of 0.2, and a tenth of doors stand open: the detectors
    # take those for corridors, and no more than a hundredth besides.
    assert np.nanmin(right[:DOOR_JAMB]) > 1 - JAMB_RATE * OPEN_SHARE - 0.01
    assert np.nanmin(right[[OPENING, FLAT_WALL], 0]) > 0.99
    # From 0.55 half widths away the jambs of a wide door are beside the view.
    assert np.nanmin(right[DOOR_JAMB, [3, 5]]) > 0.9
    assert np.nanmin(right[DOOR_JAMB, [1, 7]]) > 0.72


def test_a_worse_ring_gives_a_worse_model() -> None:
    poor = calibrate(25, seed=1, ring=SonarRing(dropout=0.6, cross_talk=0.2))
    good = calibrate(25, seed=1)
    assert poor.ring["dropout"] == 0.6
    assert np.nansum(1 - share_right(poor)) > 3 * np.nansum(1 - share_right(good))


@pytest.mark.parametrize("count", [4, 12])
def test_other_wedges_make_models_of_their_own(count: int) -> None:
    wedges = Wedges(count)
    model = calibrate(20, seed=3, wedges=wedges)
    assert model.wedges == wedges
    assert (model.counts.sum(axis=(2, 3)) == 20).all()
    assert np.array_equal(model.durations_s, durations_s(wedges))
    for number in range(4):
        codes, _ = model.informative[number]
        features, at = np.divmod(codes, count)
        assert (share_right(model)[features, at] > 0.8).all()


def test_refuses_no_trials() -> None:
    with pytest.raises(CalibrationError, match="got 0 and 1"):
        calibrate(0, seed=1)
    with pytest.raises(CalibrationError, match="got 5 and 0"):
        calibrate(5, seed=1, workers=0)
