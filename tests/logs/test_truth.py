"""The truth that beliefs are scored against must be what the modules' own geometry says."""

from __future__ import annotations

import numpy as np

from bus import messages as m
from bus.grid import DIRECTIONS, JUNCTION_TYPES, OPPOSITE
from logs.calibration import Scores
from logs.truth import Truth, feature_is_there
from modules.classifier.geometry import JAMB_RATE, presence
from tests.logs.conftest import BUILDING


def test_features_are_where_the_classifier_puts_them() -> None:
    for heading in DIRECTIONS:
        for junction_type in range(JUNCTION_TYPES):
            if not junction_type & OPPOSITE[heading]:
                continue  # nobody can come in there
            expected = presence(junction_type, heading)
            for feature, wedge in np.ndindex(expected.shape):
                there = feature_is_there(junction_type, heading, feature, wedge)
                chance = JAMB_RATE if there is None else float(there)
                assert chance == expected[feature, wedge], (heading, junction_type, feature, wedge)


def test_a_visit_is_placed_by_the_pose_that_follows_its_arrival() -> None:
    truth = Truth()
    truth.hear(BUILDING)  # 0-1 and no 2-3; 0-2 and 1-3
    assert truth.hear(m.TruePose(0.0, 0.0, 0.0, 3)) is None  # nobody arrived
    truth.hear(m.Arrival(1, 1, 240.0))
    assert truth.place(1) is None
    assert truth.hear(m.TruePose(0.0, 30.0, 0.0, 2)) == 1
    assert (truth.place(1), truth.junction_type(1)) == (2, 4)  # the south only
    # entered northward: a wall ahead
    assert truth.feature(m.Reading(1, 1, 1, 0, 0.9, 3, 8)) is True
    assert truth.hear(m.Blocked(2, 2)) == 2
    assert truth.place(2) == 2
    assert truth.hear(m.AtErrand(2, 3, here=False)) is None
    assert truth.hear(m.AtErrand(3, 2, here=True)) == 3
    assert truth.place(3) == 2
    assert (
        truth.place(9),
        truth.junction_type(9),
        truth.feature(m.Reading(9, 1, 0, 0, 0.9, 3, 8)),
    ) == (None, None, None)


def test_scores_by_hand() -> None:
    scores = Scores("three values")
    scores.add(np.array([[0.7, 0.3, 0.0], [0.2, 0.0, 0.8]]), np.array([0, 1]))
    found = scores.calibration()
    assert (found.distributions, found.impossible) == (2, 1)
    assert found.brier is not None
    assert found.log_score is not None
    assert np.isclose(found.brier, ((0.09 + 0.09) + (0.04 + 1.0 + 0.64)) / 2)
    assert np.isclose(found.log_score, -np.log(0.7))
    lows = [(of.low, of.number, of.true) for of in found.bins]
    assert lows == [(0.0, 2, 0.5), (0.2, 1, 0.0), (0.3, 1, 0.0), (0.7, 1, 1.0), (0.8, 1, 0.0)]
