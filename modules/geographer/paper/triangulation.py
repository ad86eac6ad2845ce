"""What a junction tree would cost, known before it is made: cells of the largest clique.

Table 1 of the paper gives "the product of the state spaces for the largest clique" of the
triangulated network. A fixed-time procedure must know it before it starts.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Hashable, Mapping
from itertools import combinations

from modules.geographer.paper.network import MAP, PaperNetwork

Graph = dict[Hashable, dict[Hashable, None]]
"""Neighbours of each node; dicts, since the order of a set may differ between runs."""


def largest_clique(network: PaperNetwork, instantiated: Collection[int]) -> int:
    """Cells of the largest clique after a minimum-weight triangulation of the moral graph.

    `instantiated` are the intersections whose junctions are known: they leave the graph. All
    features stay, sensed or not, as in a network that is made once. Readings S are left out:
    each has one parent and is in no larger clique than {X, S}.
    """
    sizes = _sizes(network, instantiated)
    return eliminate(_moral_graph(network, sizes), sizes)


def eliminate(graph: Graph, sizes: Mapping[Hashable, int]) -> int:
    """Cells of the largest clique when nodes are eliminated in turn, least clique first.

    Ties go to the node that comes first. The graph is used up.
    """
    largest = 1
    while graph:
        cells = {
            node: sizes[node] * math.prod(sizes[other] for other in neighbours)
            for node, neighbours in graph.items()
        }
        node = min(cells, key=cells.__getitem__)
        largest = max(largest, cells[node])
        neighbours = graph.pop(node)
        for other in neighbours:
            del graph[other][node]
        for a, b in combinations(neighbours, 2):
            graph[a][b] = graph[b][a] = None
    return largest


def _sizes(network: PaperNetwork, instantiated: Collection[int]) -> dict[Hashable, int]:
    hypotheses = network.hypotheses
    sizes: dict[Hashable, int] = {
        v: len(hypotheses.types_at(v))
        for v in range(hypotheses.grid.intersections)
        if v not in instantiated
    }
    sizes |= {feature.name: 2 for feature in network.features}
    sizes[MAP] = hypotheses.states
    return sizes


def _moral_graph(network: PaperNetwork, sizes: Mapping[Hashable, int]) -> Graph:
    graph: Graph = {node: {} for node in sizes}
    families: list[tuple[Hashable, ...]] = [
        (MAP, v) for v in range(network.hypotheses.grid.intersections)
    ]
    families += [(feature.name, *feature.junctions) for feature in network.features]
    for family in families:
        for a, b in combinations([node for node in family if node in sizes], 2):
            graph[a][b] = graph[b][a] = None
    return graph
