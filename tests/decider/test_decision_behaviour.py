from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.grid import DIRECTIONS, EAST, JUNCTION_TYPES, NORTH, WEST, Grid, Maps
from modules.decider import Decision, Situation, SituationError, decide
from tests.decider.path_reference import all_maps, junction, shortest

GRID = Grid(3, 3)
every_map = functools.cache(all_maps)


def situation_of(maps: Maps, place: int, waypoints: tuple[int, ...], seed: int = 0) -> Situation:
    """Equally likely maps, marginals that agree with them, a few expected tasks."""
    rng = np.random.default_rng(seed)
    n = len(maps)
    return Situation(
        grid=GRID,
        place=place,
        came_from=0,
        waypoints=waypoints,
        tasks=rng.integers(0, 9, (4, 2)),
        expected=rng.uniform(0, 10, 4),
        maps=maps,
        weights=np.full(n, 1 / n),
        log_probability=np.zeros(n),
        corridor_probability=maps.mean(axis=0),
        corridor_s=rng.uniform(100, 400, GRID.corridors),
        sensing_s=60.0,
    )


@st.composite
def situations(draw: st.DrawFn) -> Situation:
    """A handful of maps, marginals that need not agree with them, any place and errand."""
    rows = draw(st.lists(st.integers(0, 1758), min_size=1, max_size=12))
    places = st.integers(0, 8)
    s = situation_of(
        every_map(GRID)[rows],
        draw(places),
        tuple(draw(st.lists(places, max_size=3))),
        draw(st.integers(0, 2**32)),
    )
    here = s.grid.place(s.place)
    behind = [0] + [d for d in DIRECTIONS if s.grid.corridor(*here, d) >= 0]
    marginals = draw(st.lists(st.sampled_from([0.0, 0.3, 0.7, 1.0]), min_size=12, max_size=12))
    return replace(
        s, came_from=draw(st.sampled_from(behind)), corridor_probability=np.array(marginals)
    )


@settings(max_examples=200, deadline=None)
@given(situations())
def test_the_direction_is_one_of_the_types_own_and_never_stays_on_an_errand(s: Situation) -> None:
    decision = decide(s)
    fits = sum(d for d in DIRECTIONS if s.grid.corridor(*s.grid.place(s.place), d) >= 0)
    for junction_type in range(JUNCTION_TYPES):
        direction = int(decision.direction[junction_type])
        assert direction in (0, *DIRECTIONS)
        assert direction & junction_type & fits == direction
        if s.goals and junction_type & fits:
            assert direction


@pytest.mark.parametrize("seed", range(20))
def test_a_map_known_for_certain_is_driven_by_its_shortest_path(seed: int) -> None:
    rng = np.random.default_rng(seed)
    truth = every_map(GRID)[rng.integers(1759)]
    place, goal = (int(v) for v in rng.choice(np.flatnonzero(GRID.junction_types(truth[None])), 2))
    s = situation_of(truth[np.newaxis], place, (goal,), seed)
    s = replace(s, tasks=np.array([[place, goal]]), expected=np.ones(1))
    junction_type = junction(GRID, truth, place)
    decision = decide(s)
    path = shortest(GRID, s.corridor_s.tolist(), set(np.flatnonzero(truth)), place, goal)
    assert path is not None
    assert decision.direction[junction_type] == (DIRECTIONS[path[0]] if path else 0)
    assert not decision.explores[junction_type]
    assert decision.unknown_s[junction_type] == np.inf
    assert decision.hypotheses == 1


def same(a: Decision, b: Decision) -> None:
    np.testing.assert_array_equal(a.direction, b.direction)
    np.testing.assert_allclose(a.known_s, b.known_s, rtol=1e-12)
    np.testing.assert_allclose(a.unknown_s, b.unknown_s, rtol=1e-12)
    np.testing.assert_array_equal(a.explores, b.explores)


def test_equal_maps_count_as_one_of_their_weight() -> None:
    maps = every_map(GRID)[[5, 700, 5, 1200, 700, 5]]
    repeated = situation_of(maps, 4, (8,))
    once = replace(
        repeated,
        maps=maps[[0, 1, 3]],
        weights=np.array([3, 2, 1]) / 6,
        log_probability=np.zeros(3),
    )
    same(decide(repeated), decide(once))
    assert decide(repeated).hypotheses == decide(once).hypotheses == 3


def test_the_first_maps_of_each_type_are_used() -> None:
    whole = every_map(GRID)[(GRID.junction_types(every_map(GRID)) > 0).all(axis=1)]
    s = situation_of(np.random.default_rng(3).permutation(whole)[:300], 4, (8,))
    types = s.grid.junction_types(s.maps)[:, 4]
    rows = np.sort(np.concatenate([np.flatnonzero(types == t)[:4] for t in range(16)]))
    cut = replace(
        s,
        maps=s.maps[rows],
        weights=np.full(len(rows), 1 / len(rows)),
        log_probability=np.zeros(len(rows)),
    )
    same(decide(s, hypotheses_per_type=4), decide(cut))
    assert decide(s, 4).hypotheses < decide(s).hypotheses
    assert not np.allclose(decide(s, 4).unknown_s[1:], decide(s).unknown_s[1:])


def test_an_errand_tells_that_its_goals_can_be_reached() -> None:
    # From 0 to 2 on a grid of 3 x 1, when the far corridor may be missing: the errand says it
    # is not, so nothing is left to learn.
    s = Situation(
        grid=Grid(3, 1),
        place=0,
        came_from=0,
        waypoints=(2,),
        tasks=np.empty((0, 2), dtype=np.int64),
        expected=np.empty(0),
        maps=np.array([[1, 0], [1, 1]], dtype=np.uint8),
        weights=np.array([0.9, 0.1]),
        log_probability=np.log([0.9, 0.1]),
        corridor_probability=np.array([1.0, 0.1]),
        corridor_s=np.array([10.0, 20.0]),
        sensing_s=5.0,
    )
    decision = decide(s)
    assert decision.hypotheses == 1
    assert decision.unknown_s[EAST] == 30.0  # 10 + 20, without sensing
    assert decision.direction[EAST] == EAST
    # In spare time both maps are possible.
    assert decide(replace(s, waypoints=())).hypotheses == 2


@pytest.mark.parametrize("maps", [[[1, 0], [1, 1]], [[1, 1]]])
def test_where_the_goal_is_cut_off_it_goes_back_rather_than_stay(maps: list[list[int]]) -> None:
    # In the middle of a line of three, with no corridor east and the goal there: whether a map
    # has that type or none does, the robot leaves by the one corridor it has.
    s = Situation(
        grid=Grid(3, 1),
        place=1,
        came_from=WEST,
        waypoints=(2,),
        tasks=np.empty((0, 2), dtype=np.int64),
        expected=np.empty(0),
        maps=np.array(maps, dtype=np.uint8),
        weights=np.full(len(maps), 1 / len(maps)),
        log_probability=np.zeros(len(maps)),
        corridor_probability=np.array([1.0, 0.5]),
        corridor_s=np.array([10.0, 20.0]),
        sensing_s=5.0,
    )
    assert decide(s).direction[WEST] == WEST
    assert decide(s).direction[WEST | EAST] == EAST


def test_the_same_situation_gives_the_same_bits() -> None:
    s = situation_of(every_map(GRID), 4, (8, 0))
    first, second = decide(s, 16), decide(s, 16)
    for name in ("direction", "known_s", "unknown_s", "explores"):
        assert getattr(first, name).tobytes() == getattr(second, name).tobytes()


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"place": 9}, r"place: \[9\] expected to lie in 0\.\.8"),
        ({"waypoints": (1, -1)}, r"waypoints: \[-1\]"),
        ({"came_from": NORTH, "place": 8}, r"came_from is 1, expected 0 or the bit of a corridor"),
        ({"came_from": 3}, "came_from is 3"),
        ({"corridor_s": np.zeros(12)}, r"corridor_s has 0\.0, expected above 0"),
        ({"corridor_s": np.ones(11)}, r"corridor_s has shape \(11,\), expected \(12,\)"),
        ({"weights": np.array([0.5, 0.4])}, r"weights sum to 0\.9, expected 1"),
        ({"weights": np.array([np.nan, 1.0])}, "weights has nan"),
        ({"expected": np.full(4, -1.0)}, r"expected has -1\.0, expected at least 0"),
        ({"sensing_s": -1.0}, r"sensing_s is -1\.0"),
        ({"known_at": 0.5}, r"known_at is 0\.5, expected in \(0\.5, 1\]"),
    ],
)
def test_bad_situations_are_told_with_their_facts(change: dict[str, object], says: str) -> None:
    s = situation_of(every_map(GRID)[:2], 4, (8,))
    with pytest.raises(SituationError, match=says):
        replace(s, **change)  # type: ignore[arg-type]


def test_at_least_one_hypothesis_must_be_allowed() -> None:
    with pytest.raises(ValueError, match="hypotheses_per_type is 0, expected at least 1"):
        decide(situation_of(every_map(GRID)[:2], 4, (8,)), 0)
