"""The contingent choice of the next detector, against a slow one written from the definition."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from bus.features import USUAL
from bus.grid import DIRECTIONS, NORTH, SOUTH, WEST
from modules.classifier.choose import (
    STOP,
    Choice,
    CostError,
    PriorError,
    cells_before,
    choose,
    flat_cost_s,
    look_ahead_within,
)
from modules.classifier.geometry import HeadingError, enterable
from modules.classifier.likelihood import Reading, ReadingError, junction_likelihood
from modules.classifier.sensor_model import SensorModel, load_sensor_model, shape_of
from modules.classifier.worth import worth

SHAPE, DETECTORS = shape_of(USUAL), USUAL.detectors
RNG = np.random.default_rng(3)
MODEL = SensorModel(RNG.integers(0, 300, SHAPE), RNG.uniform(30.0, 60.0, SHAPE[:2]), {}, "a test")
SHIPPED = load_sensor_model()
UNIFORM = np.full(16, 1 / 16)
FLAT_S = flat_cost_s(3600.0)
INFORMATIVE = MODEL.informative[0][0].tolist()

headings = st.sampled_from(DIRECTIONS)
priors = st.lists(st.floats(1e-6, 1.0), min_size=16, max_size=16).map(
    lambda weights: np.array(weights) / sum(weights)
)
costs = st.integers(0, 10**6).map(
    lambda seed: np.random.default_rng(seed).uniform(-500.0, 5000.0, (16, 16))
)
visits = st.lists(
    st.builds(Reading, st.integers(0, DETECTORS - 1), st.integers(0, 3)),
    max_size=6,
    unique_by=lambda reading: reading.detector,
)


def _concluding_s(joint: NDArray[np.float64], cost_s: NDArray[np.float64], heading: int) -> float:
    """Expected cost of the best conclusion among the types that can be, for weights of types."""
    return min(float(cost_s[a] @ joint) for a in np.flatnonzero(enterable(heading)))


def _slow_s(
    prior: NDArray[np.float64],
    readings: list[Reading],
    heading: int,
    cost_s: NDArray[np.float64],
    ahead: int,
) -> tuple[float, int]:
    """Least expected cost with so many more tests, and the first of them: by the definition.

    Over the detectors that tell enough to be searched.
    """
    joint = prior * junction_likelihood(readings, heading, MODEL)
    best = _concluding_s(joint, cost_s, heading), STOP
    if ahead == 0:
        return best
    used = [reading.detector for reading in readings]
    for d in MODEL.informative[DIRECTIONS.index(heading)][0].tolist():
        if d not in used:
            after = (
                _slow_s(prior, [*readings, Reading(d, c)], heading, cost_s, ahead - 1)[0]
                for c in range(4)
            )
            cost = float(MODEL.duration_by_detector_s[d] * joint.sum()) + sum(after)
            best = min(best, (cost, d), key=lambda pair: pair[0])
    return best


def _agrees_with_the_definition(
    prior: NDArray[np.float64],
    readings: list[Reading],
    heading: int,
    cost_s: NDArray[np.float64],
    ahead: int,
) -> None:
    choice = choose(prior, readings, None, heading, MODEL, cost_s, ahead)
    joint = prior * junction_likelihood(readings, heading, MODEL)
    slow_s, first = _slow_s(prior, readings, heading, cost_s, ahead)
    saved_s = (_concluding_s(joint, cost_s, heading) - slow_s) / joint.sum()
    assert choice.worth_s[0] == pytest.approx(saved_s, abs=1e-7)
    if saved_s > 1e-6:
        assert choice.next_detector[0] == first


@given(priors, visits, headings, costs)
@settings(max_examples=25, deadline=None)
def test_one_step_saves_what_the_definition_says(
    prior: NDArray[np.float64], readings: list[Reading], heading: int, cost_s: NDArray[np.float64]
) -> None:
    _agrees_with_the_definition(prior, readings, heading, cost_s, 1)


@pytest.mark.parametrize("ahead", [2, 3])
@pytest.mark.parametrize("dear_s", [120.0, 250.0, 5000.0])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_longer_plans_save_what_the_definition_says(ahead: int, dear_s: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    prior, cost_s = rng.dirichlet(np.ones(16)), rng.uniform(-2.0, -1.0, (16, 16)) * dear_s
    # All but five detectors, some of which tell something, have read.
    free = [*rng.permutation(INFORMATIVE)[:4].tolist(), 3]
    readings = [Reading(d, int(rng.integers(4))) for d in range(DETECTORS) if d not in free]
    _agrees_with_the_definition(prior, readings, NORTH, cost_s, ahead)


@given(priors, visits, headings, costs)
@settings(max_examples=40, deadline=None)
def test_information_never_costs_and_looking_farther_never_saves_less(
    prior: NDArray[np.float64], readings: list[Reading], heading: int, cost_s: NDArray[np.float64]
) -> None:
    # Detectors that take no time: all of what they save is information.
    instant = SensorModel(MODEL.counts, np.full(SHAPE[:2], 1e-12), {}, "a test")
    _, detectors = instant.informative[DIRECTIONS.index(heading)]
    regret_s = _regret_s(cost_s, heading)
    choices = [choose(prior, readings, None, heading, MODEL, cost_s, ahead) for ahead in (1, 2)]
    belief = choices[0].belief[0, enterable(heading)]
    saved = [worth(belief, regret_s, detectors, 0, ahead).saved_s for ahead in (1, 2)]
    # Whatever the detector, whatever the costs.
    assert (saved[0] >= -1e-8).all()
    assert (saved[1] >= saved[0] - 1e-8).all()
    assert 0.0 <= choices[0].worth_s[0] <= choices[1].worth_s[0] + 1e-8


def _regret_s(cost_s: NDArray[np.float64], heading: int) -> NDArray[np.float64]:
    entered = enterable(heading)
    among_s = cost_s[np.ix_(entered, entered)]
    regret: NDArray[np.float64] = among_s - among_s.min(axis=0)
    return regret


def test_a_test_is_worth_nothing_where_one_reading_cannot_overturn_the_conclusion() -> None:
    # 0.9 for one type. Readings of accuracy 0.7: one against it leaves it the most probable
    # (0.9 * 0.3 > 0.1 * 0.7), so one test saves nothing, but two of them may overturn it.
    counts = np.broadcast_to(np.array([(7000, 0, 0, 3000), (3000, 0, 0, 7000)]), SHAPE)
    model = SensorModel(counts, np.ones(SHAPE[:2]), {}, "a test", astray=0.0)
    prior = np.zeros(16)
    # Openings and walls, ahead and to the left: four detectors tell them apart for sure.
    prior[[SOUTH, SOUTH | NORTH | WEST]] = 0.1, 0.9
    cost_s = flat_cost_s(1000.0)
    ahead = {n: choose(prior, [], None, NORTH, model, cost_s, n) for n in (1, 2, 3)}
    assert ahead[1].next_detector.tolist() == [STOP]
    assert ahead[1].worth_s.tolist() == [0.0]
    # Both against: 0.1 * 0.49 - 0.9 * 0.09 < 0, still not. Three: 0.1 * 0.343 > 0.9 * 0.027.
    assert ahead[2].next_detector.tolist() == [STOP]
    assert ahead[3].next_detector[0] != STOP
    # Saved: 1000 s * (0.0343 - 0.0243) less 2 s and a third where the first two agree against.
    agree = 0.1 * 0.49 + 0.9 * 0.09
    second = 0.1 * 0.7 + 0.9 * 0.3
    assert ahead[3].worth_s[0] == pytest.approx(10.0 - 1.0 - second - agree, abs=0.02)


@given(priors, visits, headings, st.integers(0, DETECTORS - 1), st.sampled_from([1, 2]))
@settings(max_examples=40, deadline=None)
def test_the_choice_for_an_outcome_is_the_plain_choice_after_it(
    prior: NDArray[np.float64], readings: list[Reading], heading: int, running: int, ahead: int
) -> None:
    readings = [reading for reading in readings if reading.detector != running]
    contingent = choose(prior, readings, running, heading, MODEL, FLAT_S, ahead)
    assert contingent.next_detector.shape == (4,)
    for outcome in range(4):
        after = [*readings, Reading(running, outcome)]
        plain = choose(prior, after, None, heading, MODEL, FLAT_S, ahead)
        assert contingent.next_detector[outcome] == plain.next_detector[0]
        assert contingent.concluded_type[outcome] == plain.concluded_type[0]
        assert np.allclose(contingent.belief[outcome], plain.belief[0], rtol=1e-12, atol=0.0)
        assert contingent.worth_s[outcome] == pytest.approx(plain.worth_s[0], abs=1e-7)


@given(priors, headings, costs)
@settings(max_examples=40, deadline=None)
def test_the_conclusion_is_that_of_least_expected_cost(
    prior: NDArray[np.float64], heading: int, cost_s: NDArray[np.float64]
) -> None:
    choice = choose(prior, [], None, heading, MODEL, cost_s, 1)
    expected_s = cost_s @ choice.belief[0]
    concluded = int(choice.concluded_type[0])
    assert enterable(heading)[concluded]
    assert expected_s[concluded] <= expected_s[enterable(heading)].min() + 1e-8
    flat = choose(prior, [], None, heading, MODEL, FLAT_S, 1)
    # What differs by less than the rounding of costs is a tie.
    assert choice.belief[0, int(flat.concluded_type[0])] >= choice.belief[0].max() - 1e-12


@pytest.mark.parametrize("ahead", [1, 2, 3])
def test_a_certain_prior_stops_at_once(ahead: int) -> None:
    certain = np.zeros(16)
    certain[NORTH | SOUTH] = 1.0
    choice = choose(certain, [], None, NORTH, MODEL, flat_cost_s(1e9), ahead)
    assert choice.next_detector.tolist() == [STOP]
    assert choice.concluded_type.tolist() == [NORTH | SOUTH]
    assert choice.worth_s.tolist() == [0.0]


def test_stops_where_no_detector_is_worth_its_time() -> None:
    # 0.5 for a dead end, 0.5 for a corridor: perfect readings save half the cost of a mistake.
    counts = np.broadcast_to(np.array([(10**9, 0, 0, 0), (0, 0, 0, 10**9)]), SHAPE)
    model = SensorModel(counts, np.full(SHAPE[:2], 40.0), {}, "a test", astray=0.0)
    prior = np.zeros(16)
    prior[[SOUTH, NORTH | SOUTH]] = 0.5
    tests, stops = (
        choose(prior, [], None, NORTH, model, flat_cost_s(wrong_s), 3) for wrong_s in (80.1, 79.9)
    )
    assert tests.next_detector.tolist() == [0]
    assert tests.worth_s[0] == pytest.approx(0.05, abs=1e-6)
    assert stops.next_detector.tolist() == [STOP]


def test_two_tests_may_be_worth_what_neither_is_alone() -> None:
    # Ahead and left open or not, each at even odds. Concluding now costs 0.75 * 120 = 90 s, after
    # one perfect test 40 + 0.5 * 120 = 100 s, after two 80 s.
    counts = np.broadcast_to(np.array([(10**9, 0, 0, 0), (0, 0, 0, 10**9)]), SHAPE)
    model = SensorModel(counts, np.full(SHAPE[:2], 40.0), {}, "a test", astray=0.0)
    prior = np.zeros(16)
    prior[[SOUTH, NORTH | SOUTH, SOUTH | WEST, NORTH | SOUTH | WEST]] = 0.25
    worth_s = [
        choose(prior, [], None, NORTH, model, flat_cost_s(120.0), n).worth_s[0] for n in (1, 2, 3)
    ]
    assert worth_s == pytest.approx([0.0, 10.0, 10.0], abs=1e-6)


def test_stops_when_nothing_is_left() -> None:
    readings = [Reading(d, 1) for d in range(DETECTORS)]
    choice = choose(UNIFORM, readings, None, NORTH, MODEL, flat_cost_s(1e9), 2)
    assert choice.next_detector.tolist() == [STOP]
    last = choose(UNIFORM, readings[:-1], DETECTORS - 1, NORTH, MODEL, flat_cost_s(1e9), 2)
    assert last.next_detector.tolist() == [STOP] * 4


@pytest.mark.parametrize("ahead", [1, 2, 3])
def test_equal_detectors_are_chosen_by_lowest_code(ahead: int) -> None:
    same = np.broadcast_to(np.array([(90, 8, 1, 1), (1, 1, 8, 90)]), SHAPE)
    model = SensorModel(same, np.full(SHAPE[:2], 40.0), {}, "a test")
    choice = choose(UNIFORM, [], None, NORTH, model, flat_cost_s(), ahead)
    # Openings 0, 1 and 7 part the eight types into halves, as do walls and near corners.
    assert choice.next_detector.tolist() == [0]
    left_or_right = choose(UNIFORM, [Reading(0, 3)], None, NORTH, model, flat_cost_s(), 1)
    assert left_or_right.next_detector.tolist() == [1]


def test_bits_repeat_and_do_not_depend_on_the_priors_scale_for_the_choice() -> None:
    prior = np.random.default_rng(5).dirichlet(np.ones(16))
    one, two = (choose(prior, [Reading(0, 2)], 9, SOUTH, MODEL, FLAT_S, 2) for _ in range(2))
    assert one.belief.tobytes() == two.belief.tobytes()
    assert one.worth_s.tobytes() == two.worth_s.tobytes()
    assert one.cells == two.cells
    scaled = choose(prior * 8.0, [Reading(0, 2)], 9, SOUTH, MODEL, FLAT_S, 2)
    assert scaled.next_detector.tolist() == one.next_detector.tolist()


def test_the_most_cells_are_known_before() -> None:
    # Fourteen detectors are searched. A belief costs its 8 types and astray, and 8 conclusions by
    # each of these nine; to find it, 27 layouts and astray for each reading, and for each outcome
    # once and for each class of each detector that is searched.
    belief, told = 9 + 72, 14 * 4
    assert len(SHIPPED.informative[0][0]) == 14
    assert cells_before([], None, NORTH, SHIPPED, 1) == 28 * (1 + told) + belief * (1 + told)
    readings, running = [Reading(0, 1), Reading(3, 1)], 9  # 3 tells nothing: twelve are free
    plans = 1 + 12 * 4 * (1 + 11 * 4)
    found = cells_before(readings, running, NORTH, SHIPPED, 2)
    assert found == 28 * (2 + 4 * (1 + told)) + 4 * belief * plans


@given(priors, visits, headings, st.integers(0, DETECTORS - 1), st.sampled_from([1, 2]))
@settings(max_examples=40, deadline=None)
def test_a_choice_touches_no_more_cells_than_were_known(
    prior: NDArray[np.float64], readings: list[Reading], heading: int, running: int, ahead: int
) -> None:
    readings = [reading for reading in readings if reading.detector != running]
    most = cells_before(readings, running, heading, MODEL, ahead)
    assert 0 < choose(prior, readings, running, heading, MODEL, FLAT_S, ahead).cells <= most
    # Where mistakes cost more than any test, every plan is weighed.
    dear = flat_cost_s(1e9)
    assert choose(prior, readings, running, heading, MODEL, dear, ahead).cells == most


def test_plans_are_as_long_as_the_cells_allow() -> None:
    known = [cells_before([], 0, NORTH, MODEL, ahead) for ahead in (1, 2, 3)]
    assert known == sorted(known)

    def within(cells: int, most: int = 3) -> int:
        return look_ahead_within(cells, most, [], 0, NORTH, MODEL)

    assert [within(cells) for cells in known] == [1, 2, 3]
    assert [within(cells - 1) for cells in known] == [1, 1, 2]
    assert within(known[2], most=2) == 2
    assert within(-1) == 1  # late whatever it does: by the least


def test_refuses_what_cannot_be() -> None:
    with pytest.raises(ReadingError, match="detector 3 runs again"):
        choose(UNIFORM, [Reading(3, 1)], 3, NORTH, MODEL, FLAT_S, 1)
    with pytest.raises(ReadingError, match=r"0\.\.39, got 40"):
        choose(UNIFORM, [], 40, NORTH, MODEL, FLAT_S, 1)
    with pytest.raises(HeadingError):
        choose(UNIFORM, [], None, 16, MODEL, FLAT_S, 1)
    with pytest.raises(PriorError, match="16 finite numbers"):
        choose(np.full(15, 1 / 15), [], None, NORTH, MODEL, FLAT_S, 1)
    with pytest.raises(PriorError, match="16 finite numbers"):
        choose(np.full(16, np.nan), [], None, NORTH, MODEL, FLAT_S, 1)
    not_behind = (~enterable(NORTH)).astype(float)
    with pytest.raises(PriorError, match="entered with heading 1"):
        choose(not_behind, [], None, NORTH, MODEL, FLAT_S, 1)
    with pytest.raises(CostError, match="16 conclusions by 16 types"):
        choose(UNIFORM, [], None, NORTH, MODEL, FLAT_S[:8], 1)
    with pytest.raises(CostError, match="finite seconds"):
        choose(UNIFORM, [], None, NORTH, MODEL, FLAT_S + np.inf, 1)
    with pytest.raises(CostError, match="got 4"):
        choose(UNIFORM, [], None, NORTH, MODEL, FLAT_S, 4)


def _visit(junction_type: int, rng: np.random.Generator) -> Choice:
    """A visit with readings drawn from the model, the choices followed to the end."""
    readings: list[Reading] = []
    choice = choose(UNIFORM, readings, None, NORTH, SHIPPED, flat_cost_s(), 2)
    while (running := int(choice.next_detector[0])) != STOP:
        given_type = SHIPPED.class_given_type[0, running, junction_type]
        readings.append(Reading(running, int(rng.choice(4, p=given_type))))
        choice = choose(UNIFORM, readings, None, NORTH, SHIPPED, flat_cost_s(), 2)
    return choice


def test_visits_with_the_shipped_model_end_with_the_true_type() -> None:
    rng = np.random.default_rng(11)
    right = sum(
        int(_visit(int(j), rng).concluded_type[0]) == int(j)
        for j in np.flatnonzero(enterable(NORTH))
        for _ in range(12)
    )
    assert right >= 94  # of 96
