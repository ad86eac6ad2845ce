"""A step, learn, repeat: errands by each method, alone and as the decider drives them."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from bus.grid import OPPOSITE, STEP, Grid, Maps
from modules.decider import Situation
from modules.decider.methods import (
    METHODS,
    Choice,
    Journey,
    Method,
    MethodError,
    MethodInUse,
    drive,
)
from modules.decider.rehearsal import toy
from modules.decider.roads import OPEN, PLANNED, SEEN_ABSENT, roads_of
from modules.decider.settings import Settings
from tests.decider.path_reference import all_maps

GRID = Grid(3, 3)
MAPS = all_maps(GRID)
ROADS = roads_of(GRID, np.array([3.0, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8]))
BLANK = np.full(GRID.corridors, OPEN, dtype=np.uint8)


def consistent(levels: NDArray[np.uint8]) -> tuple[Maps, NDArray[np.float64]]:
    """All maps that fit what is known, equally likely."""
    fits = (MAPS[:, levels == PLANNED] == 1).all(axis=1)
    fits &= (MAPS[:, levels == SEEN_ABSENT] == 0).all(axis=1)
    maps = MAPS[fits]
    return maps, np.full(len(maps), 1 / len(maps))


def by(method: Method, truth: NDArray[np.uint8], errand: tuple[int, int], seed: int = 0) -> Journey:
    return drive(ROADS, method, BLANK, truth, errand, consistent, np.random.default_rng(seed))


@settings(max_examples=25, deadline=None)
@given(st.integers(0, len(MAPS) - 1), st.integers(0, 10**6), st.sampled_from(METHODS))
def test_every_method_gets_there_in_the_world_as_it_is_and_repeats(
    row: int, seed: int, method: Method
) -> None:
    truth = MAPS[row]
    places = np.flatnonzero(GRID.junction_types(truth[None])[0])
    start, goal = np.random.default_rng(seed).choice(places, 2, replace=False).tolist()
    found, again = (by(method, truth, (start, goal), seed) for _ in range(2))
    assert (found.seconds, found.places) == (again.seconds, again.places)
    assert found.levels.tobytes() == again.levels.tobytes()
    assert found.places[0] == start and found.places[-1] == goal
    driven = []
    for a, b in zip(found.places, found.places[1:], strict=False):
        (d,) = np.flatnonzero(ROADS.neighbour[a] == b)
        driven.append(int(ROADS.corridor[a, d]))
    assert truth[driven].all()
    assert found.seconds == pytest.approx(ROADS.seconds[driven].sum())
    seen = [int(c) for p in set(found.places) for c in ROADS.corridor[p] if c >= 0]
    assert (found.levels[seen] == np.where(truth[seen], PLANNED, SEEN_ABSENT)).all()
    assert (np.delete(found.levels, seen) == OPEN).all()


def test_a_known_goal_is_reached_by_the_shortest_way_at_once() -> None:
    truth = np.ones(GRID.corridors, dtype=np.uint8)
    known = np.full(GRID.corridors, PLANNED, dtype=np.uint8)
    rng = np.random.default_rng(0)
    for method in ("section 4", "shortest", "avoid known"):
        found = drive(ROADS, method, known, truth, (0, 8), consistent, rng)
        # 0-1-2-5-8 is 3 + 1 + 5 + 8, 0-3-4-5-8 is 2 + 4 + 1 + 8, 0-3-6-7-8 is 2 + 3 + 5 + 9.
        assert found.places == (0, 3, 4, 5, 8)
        assert found.seconds == 15


def test_a_goal_that_is_not_joined_is_refused() -> None:
    truth = np.zeros(GRID.corridors, dtype=np.uint8)
    truth[0] = 1
    with pytest.raises(MethodError, match=r"found \(0, 8\)"):
        by("section 4", truth, (0, 8))


@pytest.mark.parametrize("choice", [*METHODS, "by estimate"])
def test_the_decider_drives_errands_by_a_method_from_the_first_one(choice: Choice) -> None:
    for seed in range(4):
        rng = np.random.default_rng(seed)
        truth = MAPS[rng.integers(len(MAPS))]
        types = GRID.junction_types(truth[None])[0]
        start, *goals = rng.permutation(np.flatnonzero(types)).tolist()[:3]
        steps = driven_by_decisions(
            MethodInUse(choice, np.random.default_rng(seed)), truth, start, goals
        )
        assert steps <= (500 if choice == "random" else 40)


def driven_by_decisions(
    method: MethodInUse, truth: NDArray[np.uint8], start: int, goals: list[int]
) -> int:
    """Follow the decisions for the true types until all goals are visited: how many steps."""
    types = GRID.junction_types(truth[None])[0]
    levels, place, came_from, steps = BLANK.copy(), start, 0, 0
    while goals:
        decision = method.decide(situation(levels, place, came_from, goals))
        direction = int(decision.direction[types[place]])
        assert types[place] & direction, "left through a wall"
        levels[ROADS.corridor[place][ROADS.corridor[place] >= 0]] = SEEN_ABSENT
        levels[[c for c in ROADS.corridor[place] if c >= 0 and truth[c]]] = PLANNED
        x, y = GRID.place(place)
        dx, dy = STEP[direction]
        place, came_from, steps = GRID.intersection(x + dx, y + dy), OPPOSITE[direction], steps + 1
        goals = goals[1:] if place == goals[0] else goals
        assert steps < 500
    return steps


def situation(levels: NDArray[np.uint8], place: int, came_from: int, goals: list[int]) -> Situation:
    maps, weights = consistent(levels)
    return replace(
        toy(GRID),
        place=place,
        came_from=came_from,
        waypoints=tuple(goals),
        maps=maps,
        weights=weights,
        log_probability=np.zeros(len(maps)),
        corridor_probability=maps.mean(axis=0),
        corridor_s=ROADS.seconds,
    )


def test_in_spare_time_a_method_stays() -> None:
    decision = MethodInUse("section 4", np.random.default_rng(0)).decide(situation(BLANK, 4, 0, []))
    assert not decision.direction.any() and not decision.explores.any()


def test_an_estimated_method_is_kept_until_its_goal_is_reached() -> None:
    method = MethodInUse("by estimate", np.random.default_rng(0))
    method.decide(situation(BLANK, 0, 0, [8]))
    method.method = "avoid known"
    method.decide(situation(BLANK, 1, 0, [8]))
    assert method.method == "avoid known"
    known = np.full(GRID.corridors, PLANNED, dtype=np.uint8)
    method.decide(situation(known, 8, 0, [0]))
    assert method.method in ("section 4", "shortest")


@pytest.mark.parametrize("method", [*METHODS, "by estimate", "expected value"])
def test_a_scenario_may_set_the_method(method: str) -> None:
    assert msgspec.convert({"method": method}, Settings).method == method


def test_another_method_is_refused() -> None:
    with pytest.raises(msgspec.ValidationError, match="method"):
        msgspec.convert({"method": "by hope"}, Settings)
