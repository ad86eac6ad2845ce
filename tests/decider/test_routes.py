"""Ways to candidates, against all simple paths of the grid."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from bus.grid import Grid
from modules.decider.roads import IMPROBABLE, OPEN, PLANNED, roads_of
from modules.decider.route_kernels import way_to_goal, ways_to
from tests.decider.path_reference import Path, beyond, corridors_on, simple_paths

GRID = Grid(3, 3)
levels = st.lists(st.sampled_from([0, 1, 2, 3]), min_size=12, max_size=12)
# no two sums of different powers of two are equal: the shortest way is unique
times = st.permutations([2.0**k for k in range(12)])


def steps(way: NDArray[np.int64]) -> Path:
    return tuple(way[way >= 0].tolist())


def best_way(
    seconds: list[float], usable: set[int], surely: set[int], place: int, goal: int
) -> Path | None:
    """The shortest simple path with at most one corridor that is usable but not sure."""
    paths = [
        (sum(seconds[c] for c in on), path)
        for path in simple_paths(GRID, usable, place, goal)
        if len(set(on := corridors_on(GRID, place, path)) - surely) <= 1
    ]
    return min(paths)[1] if paths else None


@settings(max_examples=150, deadline=None)
@given(levels, times, st.sampled_from([PLANNED, OPEN, IMPROBABLE]), st.integers(0, 8))
def test_ways_take_at_most_one_unknown_step_and_are_the_shortest_such(
    belief: list[int], seconds: list[float], level: int, place: int
) -> None:
    others = np.array([v for v in range(9) if v != place])
    roads = roads_of(GRID, np.array(seconds))
    ways = ways_to(roads, np.array(belief, dtype=np.uint8), level, place, others)
    surely = {c for c in range(12) if belief[c] >= level}
    usable = surely | {c for c in range(12) if belief[c] >= OPEN}
    for goal, way in zip(others.tolist(), ways, strict=True):
        best = best_way(seconds, usable, surely, place, goal)
        assert steps(way) == (best or ())


def test_of_equally_long_ways_the_known_one_is_taken() -> None:
    # 2 -- 3    From 0 to 3: east then north is known, north then east has an unknown step.
    # 0 -- 1    North would come first were both known.
    square = Grid(2, 2)
    roads = roads_of(square, np.full(4, 5.0))
    belief = np.array([PLANNED, OPEN, PLANNED, PLANNED], dtype=np.uint8)
    ways = ways_to(roads, belief, PLANNED, 0, np.array([3]))
    assert steps(ways[0]) == (1, 0)
    ways = ways_to(roads, np.full(4, PLANNED, dtype=np.uint8), PLANNED, 0, np.array([3]))
    assert steps(ways[0]) == (0, 1)


@settings(max_examples=100, deadline=None)
@given(levels, times, st.integers(0, 8), st.integers(0, 8), st.sets(st.integers(0, 8)))
def test_the_way_to_the_goal_is_cut_at_the_first_unsettled_place(
    belief: list[int], seconds: list[float], place: int, goal: int, unsettled: set[int]
) -> None:
    roads = roads_of(GRID, np.array(seconds))
    flags = np.array([v in unsettled for v in range(9)])
    way, length, level = way_to_goal(roads, np.array(belief, dtype=np.uint8), place, goal, flags)
    for wanted in (PLANNED, OPEN, IMPROBABLE):
        usable = {c for c in range(12) if belief[c] >= wanted}
        best = best_way(seconds, usable, usable, place, goal)
        if best is not None:
            break
    else:
        assert (level, length, steps(way)) == (0, np.inf, ())
        return
    assert level == wanted
    assert length == sum(seconds[c] for c in corridors_on(GRID, place, best))
    cut, at = [], place
    for number in best:
        cut.append(number)
        at = beyond(GRID, at, number)
        if at in unsettled:
            break
    assert steps(way) == tuple(cut)
