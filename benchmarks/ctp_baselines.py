"""Other planners for the Canadian Traveller's Problem: numba kernels.

Each says which move to make next (see modules/decider/traveller/way_kernels.py), over the same
sampled worlds that the planner of the decider would be given. Eyerich, Keller and Helmert,
*High-Quality Policies for the Canadian Traveler's Problem* (AAAI-10), describe all of them: the
optimistic policy, hindsight optimisation, optimistic rollout and UCT with an optimistic base.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.decider.roads import Roads
from modules.decider.traveller.way_kernels import (
    UNKNOWN,
    follow,
    learn,
    moves,
    set_prices,
    shortest,
)

PRETENDED = 20
"""Rollouts that UCT takes each move to have had at the start, at the optimistic cost."""

Known = NDArray[np.uint8]
Worlds = NDArray[np.uint8]


@njit(cache=True)
def optimistic(roads: Roads, known: Known, place: int, goal: int) -> int:
    """The first news, or the goal, on the shortest way that may exist."""
    vertices = len(roads.corridor)
    hoped, way = np.empty(vertices), np.empty(vertices)
    queue, found = np.empty(vertices, np.int64), np.empty(vertices, np.int64)
    price = np.empty(len(known))
    set_prices(roads, known, roads.seconds, price)
    shortest(roads, price, goal, -1, hoped, queue)
    best, least = -1, np.inf
    for k in range(moves(roads, known, place, goal, way, queue, found)):
        if way[found[k]] + hoped[found[k]] < least:
            best, least = found[k], way[found[k]] + hoped[found[k]]
    return best


@njit(cache=True)
def by_samples(
    roads: Roads, known: Known, place: int, goal: int, worlds: Worlds, hindsight: bool
) -> int:
    """The move of least mean cost over worlds, each then known, or driven by the optimist."""
    vertices = len(roads.corridor)
    way, field = np.empty(vertices), np.empty(vertices)
    queue, found = np.empty(vertices, np.int64), np.empty(vertices, np.int64)
    start, price = np.empty(len(known)), np.empty(len(known))
    taught = np.empty_like(known)
    count = moves(roads, known, place, goal, way, queue, found)
    best, least = -1, np.inf
    for k in range(count):
        total = 0.0
        for world in worlds:
            taught[:] = known
            if hindsight:
                for edge in range(len(known)):
                    price[edge] = roads.seconds[edge] if world[edge] else np.inf
                shortest(roads, price, goal, found[k], field, queue)
                total += field[found[k]]
            else:
                learn(roads, taught, world, found[k])
                set_prices(roads, taught, roads.seconds, start)
                total += follow(roads, world, found[k], goal, taught, start, field, queue)[0]
        cost = way[found[k]] + total / len(worlds)
        if cost < least:
            best, least = found[k], cost
    return best


class _Search(NamedTuple):
    """UCT's tree; nodes (rollouts + 1,), actions (many,)."""

    first: NDArray[np.int64]
    """The first action of a node, -1 while it has none."""
    actions: NDArray[np.int64]
    code: NDArray[np.int64]
    """What was seen on arriving at a node."""
    sibling: NDArray[np.int64]
    """The next node below the same action, -1 at the last."""
    to: NDArray[np.int64]
    cost: NDArray[np.float64]
    child: NDArray[np.int64]
    visits: NDArray[np.float64]
    total: NDArray[np.float64]
    used: NDArray[np.int64]
    """(2,): nodes and actions."""


@njit(cache=True)
def _open_node(
    roads: Roads,
    search: _Search,
    node: int,
    known: Known,
    place: int,
    goal: int,
    arrays: tuple[
        NDArray[np.float64],
        NDArray[np.float64],
        NDArray[np.float64],
        NDArray[np.int64],
        NDArray[np.int64],
    ],
) -> None:
    """Give a node its actions, each with its pretended rollouts."""
    price, field, way, queue, found = arrays
    set_prices(roads, known, roads.seconds, price)
    shortest(roads, price, goal, -1, field, queue)
    search.first[node] = search.used[1]
    count = moves(roads, known, place, goal, way, queue, found)
    for k in range(count):
        action = search.used[1]
        search.used[1] += 1
        search.to[action] = found[k]
        search.cost[action] = way[found[k]]
        search.child[action] = -1
        search.visits[action] = PRETENDED
        search.total[action] = PRETENDED * (way[found[k]] + field[found[k]])
    search.actions[node] = count


@njit(cache=True)
def _select(search: _Search, node: int) -> int:
    """The action of least mean less its bonus, whose weight is the node's own mean cost."""
    first, end = search.first[node], search.first[node] + search.actions[node]
    visits, total = search.visits[first:end].sum(), search.total[first:end].sum()
    best, least = int(first), np.inf
    for action in range(first, end):
        n = search.visits[action]
        value = search.total[action] / n - total / visits * np.sqrt(np.log(visits) / n)
        if value < least:
            best, least = action, value
    return best


@njit(cache=True)
def _descend(roads: Roads, search: _Search, action: int, known: Known, world: Known) -> int:
    """Arrive at an action's end in a world, and learn: the node that this leads to."""
    vertex, code = search.to[action], 0
    for edge in roads.corridor[vertex]:
        if edge >= 0 and known[edge] == UNKNOWN:
            code = 2 * code + world[edge]
    learn(roads, known, world, vertex)
    node = int(search.child[action])
    while node >= 0:
        if search.code[node] == code:
            return node
        node = int(search.sibling[node])
    node = int(search.used[0])
    search.used[0] += 1
    search.code[node] = code
    search.first[node] = -1
    search.sibling[node] = search.child[action]
    search.child[action] = node
    return node


@njit(cache=True)
def _grow(
    roads: Roads, search: _Search, known: Known, place: int, goal: int, worlds: Worlds
) -> None:
    vertices, edges = len(roads.corridor), len(known)
    price, field, way = np.empty(edges), np.empty(vertices), np.empty(vertices)
    queue, found = np.empty(vertices, np.int64), np.empty(vertices, np.int64)
    arrays = (price, field, way, queue, found)
    taught, taken = np.empty_like(known), np.empty(vertices + 1, np.int64)
    _open_node(roads, search, 0, known, place, goal, arrays)
    for world in worlds:
        taught[:] = known
        node, at, depth = 0, place, 0
        while at != goal:
            if search.first[node] < 0:
                _open_node(roads, search, node, taught, at, goal, arrays)
            taken[depth] = _select(search, node)
            at = search.to[taken[depth]]
            depth += 1
            if at != goal:
                before = search.used[0]
                node = _descend(roads, search, taken[depth - 1], taught, world)
                if search.used[0] > before:
                    break
        set_prices(roads, taught, roads.seconds, price)
        spent = follow(roads, world, at, goal, taught, price, field, queue)[0]
        for k in range(depth - 1, -1, -1):
            spent += search.cost[taken[k]]
            search.visits[taken[k]] += 1
            search.total[taken[k]] += spent


@njit(cache=True)
def uct(roads: Roads, known: Known, place: int, goal: int, worlds: Worlds) -> int:
    """The move of least mean after one rollout a world, each begun by the tree's choices."""
    nodes = len(worlds) + 1
    most = nodes * len(roads.corridor)
    search = _Search(
        np.full(nodes, -1, np.int64),
        np.zeros(nodes, np.int64),
        np.empty(nodes, np.int64),
        np.full(nodes, -1, np.int64),
        np.empty(most, np.int64),
        np.empty(most),
        np.empty(most, np.int64),
        np.empty(most),
        np.empty(most),
        np.zeros(2, np.int64),
    )
    search.used[0] = 1
    _grow(roads, search, known, place, goal, worlds)
    best = 0
    for action in range(1, search.actions[0]):
        if search.total[action] * search.visits[best] < search.total[best] * search.visits[action]:
            best = action
    return int(search.to[best])
