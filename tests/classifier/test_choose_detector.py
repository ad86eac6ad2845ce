"""The contingent choice of the next detector, against a slow one written from the definition."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from bus.grid import DIRECTIONS, NORTH, SOUTH
from modules.classifier.choose import (
    STOP,
    Choice,
    ChoiceSettings,
    PriorError,
    cells_before,
    choose,
)
from modules.classifier.geometry import DETECTORS, HeadingError, enterable
from modules.classifier.likelihood import Reading, ReadingError, junction_likelihood
from modules.classifier.sensor_model import SHAPE, SensorModel, load_sensor_model

RNG = np.random.default_rng(3)
MODEL = SensorModel(RNG.integers(0, 300, SHAPE), RNG.uniform(30.0, 60.0, SHAPE[:2]), {}, "a test")
UNIFORM = np.full(16, 1 / 16)

headings = st.sampled_from(DIRECTIONS)
priors = st.lists(st.floats(1e-6, 1.0), min_size=16, max_size=16).map(
    lambda weights: np.array(weights) / sum(weights)
)
visits = st.lists(
    st.builds(Reading, st.integers(0, DETECTORS - 1), st.integers(0, 3)),
    max_size=6,
    unique_by=lambda reading: reading.detector,
)


def _entropy(belief: NDArray[np.float64]) -> float:
    return -math.fsum(p * math.log(p) for p in belief.tolist() if p > 0)


def _slow_information(
    prior: NDArray[np.float64], readings: list[Reading], detector: int, heading: int
) -> float:
    """H(J) less the expected H(J|S), each posterior worked out in full."""
    before = prior * junction_likelihood(readings, heading, MODEL)
    expected = 0.0
    total = float(before.sum())
    for c in range(4):
        after = prior * junction_likelihood([*readings, Reading(detector, c)], heading, MODEL)
        expected += float(after.sum()) / total * _entropy(after / after.sum())
    return _entropy(before / total) - expected


@given(priors, visits, headings)
@settings(max_examples=25, deadline=None)
def test_the_choice_is_the_most_informative_per_second(
    prior: NDArray[np.float64], readings: list[Reading], heading: int
) -> None:
    choice = choose(prior, readings, None, heading, MODEL, ChoiceSettings(0.0))
    used = [reading.detector for reading in readings]
    slow = {
        d: _slow_information(prior, readings, d, heading) for d in range(DETECTORS) if d not in used
    }
    rates = {d: nats / MODEL.duration_by_detector_s[d] for d, nats in slow.items()}
    chosen = int(choice.next_detector[0])
    if chosen == STOP:
        assert max(rates.values()) < 1e-12
    else:
        assert rates[chosen] >= max(rates.values()) - 1e-11
        assert choice.information_nats[0] == pytest.approx(slow[chosen], abs=1e-11)


@given(priors, visits, headings, st.integers(0, DETECTORS - 1))
@settings(max_examples=60, deadline=None)
def test_information_is_never_negative_and_never_more_than_there_is(
    prior: NDArray[np.float64], readings: list[Reading], heading: int, running: int
) -> None:
    readings = [reading for reading in readings if reading.detector != running]
    choice = choose(prior, readings, running, heading, MODEL)
    for belief, nats in zip(choice.belief, choice.information_nats, strict=True):
        assert 0.0 <= nats <= _entropy(belief) + 1e-11


@given(priors, visits, headings, st.integers(0, DETECTORS - 1))
@settings(max_examples=60, deadline=None)
def test_the_choice_for_an_outcome_is_the_plain_choice_after_it(
    prior: NDArray[np.float64], readings: list[Reading], heading: int, running: int
) -> None:
    readings = [reading for reading in readings if reading.detector != running]
    contingent = choose(prior, readings, running, heading, MODEL)
    assert contingent.next_detector.shape == (4,)
    for outcome in range(4):
        plain = choose(prior, [*readings, Reading(running, outcome)], None, heading, MODEL)
        assert contingent.next_detector[outcome] == plain.next_detector[0]
        assert contingent.concluded_type[outcome] == plain.concluded_type[0]
        assert np.allclose(contingent.belief[outcome], plain.belief[0], rtol=1e-12, atol=0.0)
        assert contingent.information_nats[outcome] == pytest.approx(
            plain.information_nats[0], abs=1e-11
        )


@pytest.mark.parametrize("worth", [0.0, 0.0002])
def test_a_certain_prior_stops_at_once(worth: float) -> None:
    certain = np.zeros(16)
    certain[NORTH | SOUTH] = 1.0
    choice = choose(certain, [], None, NORTH, MODEL, ChoiceSettings(worth))
    assert choice.next_detector.tolist() == [STOP]
    assert choice.concluded_type.tolist() == [NORTH | SOUTH]
    assert choice.information_nats.tolist() == [0.0]


def test_stops_where_no_detector_is_worth_its_time() -> None:
    choice = choose(UNIFORM, [], None, NORTH, MODEL)
    best = int(choice.next_detector[0])
    rate = float(choice.information_nats[0] / MODEL.duration_by_detector_s[best])
    at = choose(UNIFORM, [], None, NORTH, MODEL, ChoiceSettings(rate))
    above = choose(UNIFORM, [], None, NORTH, MODEL, ChoiceSettings(rate * (1 + 1e-9)))
    assert at.next_detector.tolist() == [best]
    assert above.next_detector.tolist() == [STOP]


def test_stops_when_nothing_is_left() -> None:
    readings = [Reading(d, 1) for d in range(DETECTORS)]
    choice = choose(UNIFORM, readings, None, NORTH, MODEL, ChoiceSettings(0.0))
    assert choice.next_detector.tolist() == [STOP]
    running = choose(UNIFORM, readings[:-1], DETECTORS - 1, NORTH, MODEL, ChoiceSettings(0.0))
    assert running.next_detector.tolist() == [STOP] * 4


def test_equal_detectors_are_chosen_by_lowest_code() -> None:
    same = np.broadcast_to(np.array([(90, 8, 1, 1), (1, 1, 8, 90)]), SHAPE)
    model = SensorModel(same, np.full(SHAPE[:2], 40.0), {}, "a test")
    used: list[Reading] = []
    # Openings 0, 1 and 7 part the eight types into halves. So do the walls there (8, 9, 15), the
    # walls in 2 and 6 (10, 14) and the near corners (18, 22), each told by one bit of the type.
    for expected in (0, 1, 7):
        choice = choose(UNIFORM, used, None, NORTH, model)
        assert choice.next_detector.tolist() == [expected]
        used.append(Reading(expected, 3))


def test_bits_repeat_and_do_not_depend_on_the_priors_scale_for_the_choice() -> None:
    prior = np.random.default_rng(5).dirichlet(np.ones(16))
    one, two = (choose(prior, [Reading(0, 2)], 9, SOUTH, MODEL) for _ in range(2))
    assert one.belief.tobytes() == two.belief.tobytes()
    assert one.information_nats.tobytes() == two.information_nats.tobytes()
    scaled = choose(prior * 8.0, [Reading(0, 2)], 9, SOUTH, MODEL)
    assert scaled.next_detector.tolist() == one.next_detector.tolist()


def test_cells_are_known_before() -> None:
    # 16 types * (2 readings + 4 outcomes) + 4 outcomes * 21 free * 16 types * 4 classes.
    assert cells_before(readings=2, running=True) == 16 * 6 + 4 * 21 * 64
    # 16 * (0 + 1) + 1 * 24 * 64
    assert cells_before(readings=0, running=False) == 16 + 24 * 64
    choice = choose(UNIFORM, [Reading(3, 1), Reading(4, 1)], 5, NORTH, MODEL)
    assert choice.cells == cells_before(readings=2, running=True)


def test_refuses_what_cannot_be() -> None:
    with pytest.raises(ReadingError, match="detector 3 runs again"):
        choose(UNIFORM, [Reading(3, 1)], 3, NORTH, MODEL)
    with pytest.raises(ReadingError, match="got 24 running"):
        choose(UNIFORM, [], 24, NORTH, MODEL)
    with pytest.raises(HeadingError):
        choose(UNIFORM, [], None, 16, MODEL)
    with pytest.raises(PriorError, match="16 finite numbers"):
        choose(np.full(15, 1 / 15), [], None, NORTH, MODEL)
    with pytest.raises(PriorError, match="16 finite numbers"):
        choose(np.full(16, np.nan), [], None, NORTH, MODEL)
    not_behind = (~enterable(NORTH)).astype(float)
    with pytest.raises(PriorError, match="entered with heading 1"):
        choose(not_behind, [], None, NORTH, MODEL)


def _visit(junction_type: int, model: SensorModel, rng: np.random.Generator) -> Choice:
    """A visit with readings drawn from the model, the choices followed to the end."""
    readings: list[Reading] = []
    choice = choose(UNIFORM, readings, None, NORTH, model)
    while (running := int(choice.next_detector[0])) != STOP:
        given_type = model.class_given_type[0, running, junction_type]
        readings.append(Reading(running, int(rng.choice(4, p=given_type))))
        choice = choose(UNIFORM, readings, None, NORTH, model)
    return choice


def test_visits_with_the_shipped_model_end_with_the_true_type() -> None:
    model, rng = load_sensor_model(), np.random.default_rng(11)
    types = np.flatnonzero(enterable(NORTH))
    right = sum(
        int(_visit(int(j), model, rng).concluded_type[0]) == int(j)
        for j in types
        for _ in range(12)
    )
    assert right >= 90  # of 96
