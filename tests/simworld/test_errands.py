"""The errand queue, and the shortest way against networkx."""

from __future__ import annotations

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.grid import Grid
from simworld.building import Building, build, random_connected
from simworld.errands import DoneErrand, Errand, ErrandQueue, shortest_s

WIDTH_M = 2.0


@st.composite
def buildings(draw: st.DrawFn) -> Building:
    columns, rows = draw(st.sampled_from([(1, 2), (2, 2), (4, 3), (3, 5), (6, 6)]))
    gaps = st.floats(2.5, 40.0)
    columns_m = np.cumsum(draw(st.lists(gaps, min_size=columns, max_size=columns)))
    rows_m = np.cumsum(draw(st.lists(gaps, min_size=rows, max_size=rows)))
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    corridors = random_connected(Grid(columns, rows), draw(st.floats(0.1, 1.0)), rng)
    return build(columns_m.tolist(), rows_m.tolist(), corridors, WIDTH_M)


def graph(building: Building) -> nx.Graph:
    found = nx.Graph()
    for corridor in range(building.grid.corridors):
        if building.corridors[corridor]:
            a, b = building.grid.ends(corridor)
            (xa, ya), (xb, yb) = (
                building.position_m(*building.grid.place(place)) for place in (a, b)
            )
            found.add_edge(a, b, m=abs(xb - xa) + abs(yb - ya))
    return found


@given(buildings(), st.floats(0.01, 2.0), st.data())
@settings(max_examples=100, deadline=None)
def test_the_shortest_way_is_that_of_dijkstra(
    building: Building, speed_m_s: float, data: st.DataObject
) -> None:
    ways = graph(building)
    start, goal = (data.draw(st.sampled_from(sorted(ways))) for _ in range(2))
    expected = nx.dijkstra_path_length(ways, start, goal, weight="m") / speed_m_s
    assert shortest_s(building, speed_m_s, start, goal) == pytest.approx(expected, rel=1e-12)


def test_where_there_is_no_way() -> None:
    building = build([0, 10], [0, 10], np.array([1, 0, 0, 0], np.uint8), WIDTH_M)
    with pytest.raises(ValueError, match=r"no way from \(0, 0\) to \(1, 1\)"):
        shortest_s(building, 1.0, 0, 3)
    assert shortest_s(building, 1.0, 2, 2) == 0.0


def errands(*pairs: tuple[int, int]) -> ErrandQueue:
    return ErrandQueue(tuple(Errand(a, b, 0.5 * k) for k, (a, b) in enumerate(pairs)), began_at=9)


def test_waypoints_are_starts_and_goals_in_turn_no_one_twice_in_a_row() -> None:
    queue = errands((1, 2), (2, 3), (1, 3))
    assert queue.waypoints().tolist() == [1, 2, 3, 1, 3]
    assert queue.waypoints().dtype == np.int64
    queue.reached(1, 0)
    assert queue.waypoints().tolist() == [2, 3, 1, 3]


def test_an_errand_is_done_when_its_goal_is_reached_after_its_start() -> None:
    queue = errands((1, 2))
    assert queue.reached(2, 10) == [], "nothing was fetched yet"
    assert queue.reached(5, 20) == []
    assert queue.reached(1, 30) == []
    assert queue.reached(1, 40) == []
    assert (queue.left, queue.done) == (1, 0)
    assert queue.reached(2, 50) == [DoneErrand(0, 1, 2, 0, 9)]
    assert (queue.left, queue.done) == (0, 1)
    assert queue.reached(2, 60) == []
    assert queue.waypoints().tolist() == []


def test_the_next_errand_begins_where_and_when_the_last_one_ended() -> None:
    queue = errands((1, 2), (4, 5))
    queue.reached(1, 30)
    queue.reached(2, 50)
    queue.reached(4, 70)
    assert queue.reached(5, 80) == [DoneErrand(1, 4, 5, 50, 2)]


def test_one_stop_may_end_an_errand_and_begin_the_next() -> None:
    queue = errands((1, 2), (2, 2), (2, 7))
    queue.reached(1, 30)
    assert [done.number for done in queue.reached(2, 50)] == [0, 1]
    assert queue.waypoints().tolist() == [7], "the third is fetched already"


def test_what_waits_counts_once_more_than_what_is_to_come() -> None:
    queue = errands((1, 2), (4, 5), (6, 7))
    tasks, expected = queue.expected()
    assert tasks.tolist() == [[1, 2], [4, 5], [6, 7]]
    assert expected.tolist() == [0.0, 1.5, 2.0]
    for place in (1, 2):
        queue.reached(place, 0)
    assert queue.expected()[1].tolist() == [0.0, 0.5, 2.0]


def test_the_next_waypoint_and_when_it_is_due() -> None:
    queue = ErrandQueue((Errand(1, 2, 0.0, due_s=1.5, late_price=3.0), Errand(2, 3, 0.0)), 9)
    assert (queue.waypoint, queue.due) == (1, None), "its goal is due, not its start"
    queue.reached(1, 5)
    assert (queue.waypoint, queue.due) == (2, (1_500_000_000, 3.0))
    queue.reached(2, 6)
    assert (queue.waypoint, queue.due) == (3, None), "no time is set for this one"
    queue.reached(3, 7)
    assert (queue.waypoint, queue.due) == (None, None)


def test_no_errands() -> None:
    tasks, expected = errands().expected()
    assert tasks.shape == (0, 2)
    assert expected.shape == (0,)


@given(st.lists(st.tuples(st.integers(0, 4), st.integers(0, 4)), max_size=5), st.data())
def test_who_follows_the_waypoints_does_every_errand_in_order(
    pairs: list[tuple[int, int]], data: st.DataObject
) -> None:
    queue = errands(*pairs)
    done: list[int] = []
    while queue.left:
        elsewhere = data.draw(st.lists(st.integers(5, 8), max_size=2))
        for place in (*elsewhere, int(queue.waypoints()[0])):
            done += [d.number for d in queue.reached(place, 0)]
    assert done == list(range(len(pairs)))
