"""The next feature refined until stopped: what it has by then, and why it stopped."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.features import USUAL
from bus.grid import NORTH
from modules.classifier.anytime import refine
from modules.classifier.choose import STOP, Problem, choose, flat_cost_s, problem_of
from modules.classifier.likelihood import Reading
from modules.classifier.sensor_model import SensorModel, shape_of
from modules.classifier.worth import most_cells

SHAPE = shape_of(USUAL)
RNG = np.random.default_rng(3)
MODEL = SensorModel(RNG.integers(0, 300, SHAPE), RNG.uniform(30.0, 60.0, SHAPE[:2]), {}, "a test")
FIRST, SECOND, THIRD = MODEL.informative[0][0].tolist()[:3]
UNIFORM = np.full(16, 1 / 16)
COST_S = flat_cost_s(3600.0)
UNLIMITED = 10**12


def problem(running: int | None = FIRST, wrong_s: float = 3600.0) -> Problem:
    readings = [Reading(SECOND, 1)]
    return problem_of(UNIFORM, readings, running, NORTH, MODEL, flat_cost_s(wrong_s))


def step_cells(p: Problem, ahead: int) -> int:
    types = int(p.entered.sum())
    return most_cells(int(p.free.sum()), ahead, 4, types + 1, types)


def test_it_stops_with_nothing_left_when_all_plans_were_weighed() -> None:
    refined = refine(problem(), UNLIMITED, most=2)
    assert refined.stopped == "nothing left"
    assert refined.look_ahead.tolist() == [2, 2, 2, 2]
    whole = choose(UNIFORM, [Reading(SECOND, 1)], FIRST, NORTH, MODEL, COST_S, 2)
    assert refined.choice.next_detector.tolist() == whole.next_detector.tolist()
    assert refined.choice.worth_s.tolist() == whole.worth_s.tolist()
    assert refined.choice.concluded_type.tolist() == whole.concluded_type.tolist()


def test_it_stops_out_of_cells_with_the_most_probable_outcome_looked_at_furthest() -> None:
    p = problem()
    ones = refine(p, UNLIMITED, most=1).choice.cells
    refined = refine(p, ones + step_cells(p, 2), most=2)
    assert refined.stopped == "out of cells"
    likeliest = int(p.chance.argmax())
    assert refined.look_ahead[likeliest] == 2
    assert np.delete(refined.look_ahead, likeliest).tolist() == [1, 1, 1]
    assert refine(p, ones + step_cells(p, 2) - 1, most=2).look_ahead.tolist() == [1, 1, 1, 1]


def test_it_is_settled_when_not_even_the_truth_is_worth_a_test() -> None:
    p = problem(wrong_s=20.0)  # the quickest test takes 30 s
    refined = refine(p, UNLIMITED)
    assert refined.stopped == "settled"
    assert refined.choice.cells == p.cells_of_beliefs
    assert (refined.choice.next_detector == STOP).all()
    whole = choose(UNIFORM, [Reading(SECOND, 1)], FIRST, NORTH, MODEL, flat_cost_s(20.0), 3)
    assert (whole.next_detector == STOP).all()


def test_to_begin_with_it_concludes_at_least_cost() -> None:
    refined = refine(problem(), 0)
    assert refined.stopped == "out of cells"
    assert (refined.choice.next_detector == STOP).all()
    whole = choose(UNIFORM, [Reading(SECOND, 1)], FIRST, NORTH, MODEL, COST_S, 1)
    assert refined.choice.concluded_type.tolist() == whole.concluded_type.tolist()


def test_the_chances_of_the_outcomes_are_those_of_the_readings() -> None:
    p, before = problem(), problem(running=None)
    (belief,) = before.belief
    expected = belief @ MODEL.class_given_type[0, FIRST]
    np.testing.assert_allclose(p.chance, expected, rtol=1e-12)
    assert before.chance.tolist() == [1.0]


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 400_000), st.sampled_from([None, FIRST, THIRD]), st.floats(0.0, 9000.0))
def test_it_never_touches_more_cells_than_it_was_given(
    cells: int, running: int | None, wrong_s: float
) -> None:
    p = problem(running, wrong_s)
    refined = refine(p, cells, most=2)
    assert refined.choice.cells <= max(cells, p.cells_of_beliefs)
    for outcome, ahead in enumerate(refined.look_ahead.tolist()):
        best = p.best(outcome, ahead) if ahead else None
        expected = STOP if best is None or best.row < 0 else int(p.codes[best.row])
        assert refined.choice.next_detector[outcome] == expected
    if refined.stopped != "out of cells":
        best_of_all = [p.best(outcome, 2).saved_s for outcome in range(len(p.belief))]
        assert refined.choice.worth_s.tolist() == best_of_all
