"""Kernels for ways and worlds, against networkx and by hand."""

from __future__ import annotations

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from modules.decider.traveller import FREE, UNKNOWN, Instance, independent_worlds
from modules.decider.traveller.way_kernels import follow, learn, moves, shortest
from modules.decider.traveller.world_kernels import clairvoyant
from tests.decider.traveller_reference import all_weathers, instances


def graph_of(instance: Instance, use: NDArray[np.bool_]) -> nx.Graph:
    graph = nx.Graph()
    graph.add_nodes_from(range(instance.vertices))
    for (a, b), cost, used in zip(instance.ends.tolist(), instance.cost, use, strict=True):
        if used:
            graph.add_edge(a, b, weight=float(cost))
    return graph


@settings(max_examples=150, deadline=None)
@given(instances(12, 24), st.data())
def test_distances_are_those_of_networkx(instance: Instance, data: st.DataObject) -> None:
    use = np.array([data.draw(st.booleans()) for _ in instance.cost])
    source = data.draw(st.integers(0, instance.vertices - 1))
    field = np.empty(instance.vertices)
    queue = np.empty(instance.vertices, dtype=np.int64)
    shortest(instance.roads(), np.where(use, instance.cost, np.inf), source, -1, field, queue)
    expected = nx.single_source_dijkstra_path_length(graph_of(instance, use), source)
    assert field.tolist() == [expected.get(v, np.inf) for v in range(instance.vertices)]


@settings(max_examples=150, deadline=None)
@given(instances(10, 18), st.data())
def test_moves_end_where_there_is_news_and_pass_none(
    instance: Instance, data: st.DataObject
) -> None:
    known = np.array([data.draw(st.integers(0, 2)) for _ in instance.cost], dtype=np.uint8)
    place = 0
    at = (instance.ends == place).any(axis=1)
    known[at & (known == UNKNOWN)] = FREE
    news = {v for k, e in enumerate(instance.ends.tolist()) if known[k] == UNKNOWN for v in e}
    stops = news | {instance.goal}
    way, queue, found = np.empty(10), np.empty(10, dtype=np.int64), np.empty(10, dtype=np.int64)
    n = instance.vertices
    count = moves(instance.roads(), known, place, instance.goal, way[:n], queue[:n], found[:n])
    graph = graph_of(instance, known == FREE)
    expected = {}
    for stop in stops:
        inner = graph.subgraph([v for v in graph if v not in stops or v in (place, stop)])
        if nx.has_path(inner, place, stop):
            expected[stop] = nx.dijkstra_path_length(inner, place, stop)
    assert {int(v): way[v] for v in found[:count]} == expected


@settings(max_examples=60, deadline=None)
@given(instances())
def test_the_clairvoyant_drives_the_shortest_way_of_each_world(instance: Instance) -> None:
    worlds = all_weathers(instance)
    fields = clairvoyant(instance.roads(), worlds, instance.goal)
    for world, field in zip(worlds, fields, strict=True):
        graph = graph_of(instance, world > 0)
        assert field[0] == nx.dijkstra_path_length(graph, 0, instance.goal)


def test_the_base_policy_goes_back_when_its_way_is_blocked() -> None:
    # 0 - 1 - 3 is shortest (2), but 1 - 3 is blocked; 0 - 2 - 3 costs 10: there, back, around
    ends = np.array([[0, 1], [1, 3], [0, 2], [2, 3]])
    instance = Instance(4, ends, np.full(4, 0.5), np.array([1.0, 1.0, 5.0, 5.0]))
    field, queue = np.empty(4), np.empty(4, dtype=np.int64)

    def cost(world: list[int], price: list[float]) -> float:
        true = np.array(world, dtype=np.uint8)
        known = np.array([FREE, UNKNOWN, FREE, UNKNOWN], dtype=np.uint8)
        roads = instance.roads()
        return float(follow(roads, true, 0, 3, known, np.array(price), field, queue)[0])

    assert cost([1, 1, 1, 1], [1.0, 1.0, 5.0, 5.0]) == 2.0
    assert cost([1, 0, 1, 1], [1.0, 1.0, 5.0, 5.0]) == 12.0
    assert cost([1, 0, 1, 1], [1.0, 20.0, 5.0, 5.0]) == 10.0  # a cautious one does not try
    assert cost([1, 0, 1, 0], [1.0, 1.0, 5.0, 5.0]) == np.inf


def test_sampled_worlds_agree_with_what_is_known_and_have_a_way() -> None:
    ends = np.array([[0, 1], [1, 3], [0, 2], [2, 3], [1, 2]])
    instance = Instance(4, ends, np.array([0.2, 0.5, 0.5, 0.5, 0.9]), np.ones(5))
    known = np.array([FREE, UNKNOWN, UNKNOWN, UNKNOWN, UNKNOWN], dtype=np.uint8)
    rng = np.random.default_rng(1)
    worlds = independent_worlds(instance.roads(), instance.probability, known, 0, 3, 40_000, rng)
    assert len(worlds) == 40_000
    listed = all_weathers(instance, known)
    p = instance.probability
    weight = np.where(listed, p, 1 - p)[:, 1:].prod(axis=1)
    expected = (weight[:, None] * listed).sum(axis=0) / weight.sum()
    # four standard errors
    assert np.abs(worlds.mean(axis=0) - expected).max() < 4 * 0.5 / 200
    assert {w.tobytes() for w in worlds} == {w.tobytes() for w in listed}


def test_a_goal_cut_off_has_no_worlds() -> None:
    instance = Instance(3, np.array([[0, 1], [1, 2]]), np.array([0.5, 0.5]), np.ones(2))
    known = np.array([0, UNKNOWN], dtype=np.uint8)
    worlds = independent_worlds(
        instance.roads(), instance.probability, known, 0, 2, 5, np.random.default_rng(1)
    )
    assert worlds.shape == (0, 2)


@settings(max_examples=60, deadline=None)
@given(instances(7, 12), st.integers(0, 10**6))
def test_the_base_policy_is_one_that_plans_anew_at_every_step(
    instance: Instance, seed: int
) -> None:
    # it plans anew only when its way is blocked; lengths without ties
    rng = np.random.default_rng(seed)
    cost = instance.cost + rng.uniform(0.0, 0.5, len(instance.cost))
    instance = Instance(instance.vertices, instance.ends, instance.probability, cost)
    world = rng.permutation(all_weathers(instance))[0]
    hope = cost * rng.uniform(1.0, 3.0, len(cost))
    roads, n = instance.roads(), instance.vertices
    seen = np.full(len(cost), UNKNOWN, dtype=np.uint8)
    learn(roads, seen, world, 0)
    price = np.where(seen == UNKNOWN, hope, np.where(seen == FREE, cost, np.inf))
    expected, place, taught = 0.0, 0, seen.copy()
    while place != instance.goal:
        graph = graph_of(instance, taught > 0)
        for k, (a, b) in enumerate(instance.ends.tolist()):
            if taught[k]:
                graph[a][b]["weight"] = hope[k] if taught[k] == UNKNOWN else cost[k]
        to = nx.dijkstra_path(graph, place, instance.goal)[1]
        expected += cost[(np.sort(instance.ends, axis=1) == sorted((place, to))).all(axis=1)][0]
        place = to
        learn(roads, taught, world, place)
    arrays = seen, price, np.empty(n), np.empty(n, dtype=np.int64)
    found, lessons = follow(roads, world, 0, instance.goal, *arrays)
    assert found == pytest.approx(expected)
    assert lessons < n
    assert seen.tolist() == taught.tolist()
