"""The Canadian Traveller's Problem solved exactly, by listing every weather; and small graphs.

Plain Python and networkx, nothing of the planner's: a state is where the traveller is and which
weathers agree with all he has seen.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import networkx as nx
import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from modules.decider.traveller import Instance

Worlds = NDArray[np.uint8]
Policy = Callable[[NDArray[np.uint8], int], int]


def exact_moves(instance: Instance, worlds: Worlds, place: int) -> dict[int, float]:
    """Least expected cost of beginning with an edge to each neighbour, all worlds equally likely.

    Dynamic programming over (place, vertices seen, worlds that agree), edge by edge.
    """
    value = _solver(instance, worlds)
    every = tuple(range(len(worlds)))
    return {
        to: cost + value(to, frozenset({place}), every)
        for to, cost in _steps(instance, worlds[0], place)
    }


def exact(instance: Instance, worlds: Worlds, place: int) -> float:
    """The least expected cost from ``place``, whose edges are the same in all worlds."""
    return min(exact_moves(instance, worlds, place).values())


def _steps(instance: Instance, world: NDArray[np.uint8], place: int) -> list[tuple[int, float]]:
    found = []
    for (a, b), free, cost in zip(instance.ends.tolist(), world, instance.cost, strict=True):
        if free and place in (a, b):
            found.append((b if place == a else a, float(cost)))
    return found


def _solver(
    instance: Instance, worlds: Worlds
) -> Callable[[int, frozenset[int], tuple[int, ...]], float]:
    @cache
    def arrive(place: int, seen: frozenset[int], agree: tuple[int, ...]) -> float:
        if place == instance.goal:
            return 0.0
        at = [k for k, ends in enumerate(instance.ends.tolist()) if place in ends]
        groups: dict[bytes, list[int]] = {}
        for j in agree:
            groups.setdefault(worlds[j, at].tobytes(), []).append(j)
        return sum(
            len(group) / len(agree) * best(place, seen | {place}, tuple(group))
            for group in groups.values()
        )

    @cache
    def best(place: int, seen: frozenset[int], agree: tuple[int, ...]) -> float:
        # over free edges between vertices seen nothing is learnt: the next step that counts
        # ends at a vertex not seen, or at the goal
        known = nx.Graph()
        known.add_node(place)
        for vertex in sorted(seen):
            for to, cost in _steps(instance, worlds[agree[0]], vertex):
                known.add_edge(vertex, to, weight=cost)
        inner = known.subgraph([v for v in known if v in seen and v != instance.goal])
        reach = nx.single_source_dijkstra_path_length(inner, place)
        values: list[float] = [
            length + known[v][to]["weight"] + arrive(to, seen, agree)
            for v, length in reach.items()
            for to in known[v]
            if to not in seen
        ]
        return min(values)

    return arrive


def all_weathers(instance: Instance, known: NDArray[np.uint8] | None = None) -> Worlds:
    """Every set of free edges that joins start and goal and agrees with ``known`` (1 unknown)."""
    count = len(instance.cost)
    rows = []
    for number in range(1 << count):
        world = [(number >> k) & 1 for k in range(count)]
        if known is not None and any(
            w != (s == 2) for w, s in zip(world, known.tolist(), strict=True) if s != 1
        ):
            continue
        free = nx.Graph()
        free.add_nodes_from(range(instance.vertices))
        free.add_edges_from(e for e, w in zip(instance.ends.tolist(), world, strict=True) if w)
        if nx.has_path(free, 0, instance.goal):
            rows.append(world)
    return np.array(rows, dtype=np.uint8)


@st.composite
def instances(draw: st.DrawFn, vertices: int = 5, edges: int = 7) -> Instance:
    """A connected graph of at most so many vertices and edges, whole costs, any probabilities."""
    n = draw(st.integers(3, vertices))
    pairs = {(draw(st.integers(0, b - 1)), b) for b in range(1, n)}
    every = [(a, b) for b in range(n) for a in range(b)]
    more = draw(st.lists(st.sampled_from(every), max_size=edges - n + 1))
    ends = np.array(sorted(pairs | set(more)), dtype=np.int64)
    cost = draw(st.lists(st.integers(1, 20), min_size=len(ends), max_size=len(ends)))
    p = draw(st.lists(st.floats(0.1, 0.9), min_size=len(ends), max_size=len(ends)))
    return Instance(n, ends, np.array(p), np.array(cost, dtype=np.float64))


def ladder(vertices: int, seed: int) -> Instance:
    """A graph of a given size: a ring with chords, costs and probabilities from a seed."""
    rng = np.random.default_rng([vertices, seed])
    ring = [(k, (k + 1) % vertices) for k in range(vertices)]
    chords = [(k, k + 3) for k in range(0, vertices - 3, 2)]
    ends = np.array(ring + chords, dtype=np.int64)
    cost = rng.integers(1, 51, len(ends)).astype(np.float64)
    return Instance(vertices, ends, rng.uniform(0.3, 0.95, len(ends)), cost)
