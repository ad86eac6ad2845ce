"""Planning a whole sequence of errands: against dynamic programming, and what learning is worth."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from modules.decider.traveller import (
    FREE,
    UNKNOWN,
    Errands,
    Instance,
    Moves,
    PlanError,
    least_cells,
    look_ahead,
    look_ahead_over,
)
from modules.decider.traveller.way_kernels import learn
from tests.decider.errands_reference import exact_errands
from tests.decider.traveller_reference import all_weathers, instances

slow = settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.filter_too_much])


def errands(goals: list[int], weight: list[float] | None = None, news_s: float = 0.0) -> Errands:
    weights = np.ones(len(goals)) if weight is None else np.array(weight)
    return Errands(np.array(goals, np.int64), weights, news_s)


def plan(
    instance: Instance,
    known: NDArray[np.uint8],
    worlds: NDArray[np.uint8],
    asked: Errands,
    odds: NDArray[np.float64] | None = None,
) -> Moves:
    """With room enough to look into every leaf: eight of each world."""
    many = np.repeat(worlds, 8, axis=0)
    weights = np.ones(len(many)) if odds is None else np.repeat(odds, 8)
    cells = 400 * least_cells(instance.vertices, len(many))
    return look_ahead_over(instance.roads(), known, 0, asked, many, weights, cells)


@st.composite
def questions(draw: st.DrawFn) -> tuple[Instance, NDArray[np.uint8], NDArray[np.uint8], Errands]:
    """A small graph, what is known at its start, a few worlds that join all, and errands."""
    instance = draw(instances(5, 7))
    every = all_weathers(instance)
    every = every[[_joined(instance, world) for world in every]]
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    known = np.full(len(instance.cost), UNKNOWN, dtype=np.uint8)
    learn(instance.roads(), known, every[rng.integers(len(every))], 0)
    fits = every[((every == (known == FREE)) | (known == UNKNOWN)).all(axis=1)]
    goals = draw(st.lists(st.integers(0, instance.vertices - 1), min_size=1, max_size=3))
    weight = draw(st.lists(st.floats(0.25, 4.0), min_size=len(goals), max_size=len(goals)))
    asked = errands([*goals, instance.goal], [*weight, 1.0], draw(st.sampled_from([0.0, 3.0])))
    return instance, known, fits[rng.permutation(len(fits))[:6]], asked


def _joined(instance: Instance, world: NDArray[np.uint8]) -> bool:
    reached = {0}
    for _ in range(instance.vertices):
        for (a, b), free in zip(instance.ends.tolist(), world, strict=True):
            if free and (a in reached or b in reached):
                reached |= {a, b}
    return len(reached) == instance.vertices


@slow
@given(questions())
def test_with_room_enough_it_is_the_exact_optimum_of_the_whole_sequence(
    question: tuple[Instance, NDArray[np.uint8], NDArray[np.uint8], Errands],
) -> None:
    instance, known, worlds, asked = question
    found = plan(instance, known, worlds, asked)
    best = exact_errands(instance, worlds, asked)
    assert found.expected.min() == pytest.approx(best, rel=1e-8)
    assert (found.bound <= found.expected + 1e-9).all()


@slow
@given(questions(), st.integers(0, 6))
def test_information_never_hurts(
    question: tuple[Instance, NDArray[np.uint8], NDArray[np.uint8], Errands], edge: int
) -> None:
    instance, known, worlds, asked = question
    edge %= len(known)
    without = plan(instance, known, worlds, asked).expected.min()
    told = 0.0
    for free in (0, 1):
        part = worlds[worlds[:, edge] == free]
        if len(part):
            more = known.copy()
            more[edge] = FREE if free else 0
            told += len(part) / len(worlds) * plan(instance, more, part, asked).expected.min()
    assert told <= without * (1 + 1e-9)


def test_a_way_is_tried_when_enough_errands_come_after() -> None:
    # 0 - 2 is sure and takes 10; by 1 and 3 it takes 8 with probability 1/4, or 2 + 2 + 10.
    # Only at 1 or 3 can it be seen whether 1 - 3 is free.
    ends = np.array([[0, 1], [1, 3], [2, 3], [0, 2]])
    instance = Instance(4, ends, np.ones(4), np.array([2.0, 4.0, 2.0, 10.0]))
    known = np.array([FREE, UNKNOWN, FREE, FREE], dtype=np.uint8)
    worlds = np.array([[1, k == 0, 1, 1] for k in range(4)], dtype=np.uint8)

    def first(later: int) -> tuple[int, float]:
        found = plan(instance, known, worlds, errands([2, 0] * later + [2]))
        return int(found.to[found.best]), float(found.expected.min())

    assert first(0) == (2, 10.0)
    assert first(1) == (2, 30.0)  # trying: 0.25 * 24 + 0.75 * 34 = 31.5
    assert first(3) == (1, 69.5)  # 0.25 * 56 + 0.75 * 74; not trying: 70


def test_weights_stand_for_repeated_worlds() -> None:
    ends = np.array([[0, 1], [1, 2], [0, 2]])
    instance = Instance(3, ends, np.ones(3), np.array([2.0, 6.0, 10.0]))
    known = np.array([FREE, UNKNOWN, FREE], dtype=np.uint8)
    both = np.array([[1, 1, 1], [1, 0, 1]], dtype=np.uint8)
    asked = errands([2, 0, 2])
    weighed = plan(instance, known, both, asked, np.array([1.0, 3.0]))
    repeated = plan(instance, known, both[[0, 1, 1, 1]], asked)
    assert weighed.expected == pytest.approx(repeated.expected)
    assert weighed.bound == pytest.approx(repeated.bound)


def test_looking_takes_its_time_where_there_is_anything_to_learn() -> None:
    ends = np.array([[0, 1], [1, 2], [0, 2]])
    instance = Instance(3, ends, np.ones(3), np.array([1.0, 1.0, 10.0]))
    known = np.array([FREE, UNKNOWN, FREE], dtype=np.uint8)
    sure = np.ones((1, 3), dtype=np.uint8)
    # 1 and 2 are the ends of one unknown edge: once at 1, nothing is left to learn at 2
    assert plan(instance, known, sure, errands([2], news_s=3.0)).expected.min() == 5.0
    assert plan(instance, known, sure, errands([2], news_s=9.0)).expected.min() == 11.0


def test_one_goal_is_the_plain_traveller() -> None:
    ends = np.array([[0, 1], [1, 2], [0, 2]])
    instance = Instance(3, ends, np.ones(3), np.array([2.0, 6.0, 10.0]))
    known = np.array([FREE, UNKNOWN, FREE], dtype=np.uint8)
    worlds = np.array([[1, 1, 1], [1, 0, 1]] * 8, dtype=np.uint8)
    plain = look_ahead(instance.roads(), known, 0, 2, worlds, 2000)
    same = look_ahead_over(
        instance.roads(), known, 0, errands([0, 2, 2]), worlds, np.ones(16), 2000
    )
    assert plain.expected.tolist() == same.expected.tolist()
    with pytest.raises(PlanError, match=r"goals \[0\], expected one that is not 0"):
        look_ahead(instance.roads(), known, 0, 0, worlds, 2000)
