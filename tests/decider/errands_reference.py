"""Sequences of errands solved exactly by listing every world: plain Python."""

from __future__ import annotations

from functools import cache

import networkx as nx
import numpy as np
from numpy.typing import NDArray

from modules.decider.traveller import Errands, Instance

Worlds = NDArray[np.uint8]


def exact_errands(instance: Instance, worlds: Worlds, errands: Errands) -> float:
    """The least expected weighted cost from vertex 0, seen, all worlds equally likely."""
    goals, weight = errands.goals.tolist(), errands.weight.tolist()

    @cache
    def best(place: int, stage: int, seen: frozenset[int], agree: tuple[int, ...]) -> float:
        while stage < len(goals) and goals[stage] == place:
            stage += 1
        if stage == len(goals):
            return 0.0
        values: list[float] = []
        for stop, cost in _moves(instance, worlds[agree[0]], seen, place, goals[stage]).items():
            cost += errands.news_s * _news(instance, seen, stop)
            rest = sum(
                len(group) / len(agree) * best(stop, stage, seen | {stop}, group)
                for group in _split(instance, worlds, stop, agree)
            )
            values.append(weight[stage] * cost + rest)
        return min(values)

    return best(0, 0, frozenset({0}), tuple(range(len(worlds))))


def _at(instance: Instance, vertex: int) -> list[int]:
    return [k for k, pair in enumerate(instance.ends.tolist()) if vertex in pair]


def _news(instance: Instance, seen: frozenset[int], vertex: int) -> bool:
    return any(not seen & set(instance.ends[k].tolist()) for k in _at(instance, vertex))


def _split(
    instance: Instance, worlds: Worlds, vertex: int, agree: tuple[int, ...]
) -> list[tuple[int, ...]]:
    """The worlds that agree so far, by what ``vertex`` shows."""
    groups: dict[bytes, list[int]] = {}
    for j in agree:
        groups.setdefault(worlds[j, _at(instance, vertex)].tobytes(), []).append(j)
    return [tuple(group) for group in groups.values()]


def _moves(
    instance: Instance, world: NDArray[np.uint8], seen: frozenset[int], place: int, goal: int
) -> dict[int, float]:
    """Ways over known edges that pass neither news nor the goal, by where they end."""
    known = nx.Graph()
    known.add_node(place)
    for k, (a, b) in enumerate(instance.ends.tolist()):
        if world[k] and seen & {a, b}:
            known.add_edge(a, b, weight=float(instance.cost[k]))
    stops = {v for v in known if v == goal or _news(instance, seen, v)} - {place}
    found = {}
    for stop in sorted(stops):
        inner = known.subgraph([v for v in known if v not in stops or v == stop])
        if nx.has_path(inner, place, stop):
            found[stop] = float(nx.dijkstra_path_length(inner, place, stop))
    return found
