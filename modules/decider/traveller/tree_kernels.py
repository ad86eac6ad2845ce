"""Looking ahead over worlds: growing a tree (see tree.py); numba kernels.

The leaf that is looked into next is the one in the best plan so far where a better plan could
save most: the odds of its worlds times the difference of its bounds; where none can save anything,
the one of any plan that may still be better. A leaf whose drives would not fit is left as it is. A
search that ends with room to spare has found the least expected cost over its worlds, but for
leaves with few of them.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.decider.traveller.errand_kernels import drive_on, next_stage
from modules.decider.traveller.tree import Problem, Scratch, Tree
from modules.decider.traveller.way_kernels import UNKNOWN, is_news, learn, moves, set_prices

FEWEST = 8
"""Leaves with fewer worlds are not looked into: what they would show is chance."""

ROUNDING = 1e-9
"""Relative difference below which two costs count as equal."""


@njit(cache=True)
def evaluate(problem: Problem, tree: Tree, scratch: Scratch, node: int) -> None:
    """Fill the values of a new leaf."""
    nodes = tree.nodes
    place, stage, count = nodes.place[node], nodes.stage[node], nodes.worlds[node]
    upper, lower, mass = 0.0, 0.0, 0.0
    set_prices(problem.roads, nodes.known[node], problem.hope, scratch.price)
    for k in range(nodes.first_world[node], nodes.first_world[node] + count):
        j = tree.pool[k]
        scratch.driven[:] = scratch.price
        scratch.seen[:] = nodes.known[node]
        upper += problem.odds[j] * drive_on(
            problem.roads,
            problem.errands,
            problem.worlds[j],
            stage,
            place,
            scratch.seen,
            scratch.driven,
            scratch.field,
            scratch.queue,
        )
        lower += problem.odds[j] * problem.clairvoyant[j, stage, place]
        mass += problem.odds[j]
    nodes.actions[node] = 0
    nodes.mass[node] = mass
    nodes.upper[node] = upper / mass
    nodes.lower[node] = lower / mass
    gain = upper - lower
    nodes.worth[node] = gain if count >= FEWEST and gain > ROUNDING * upper else 0.0
    nodes.doubt[node] = nodes.worth[node]


@njit(cache=True)
def split(problem: Problem, tree: Tree, node: int, vertex: int) -> tuple[int, int]:
    """Copy a node's worlds to the pool, those that look the same at ``vertex`` side by side.

    Returns the place in the pool and the number of edges to tell them apart by.
    """
    nodes = tree.nodes
    start, count = nodes.first_world[node], nodes.worlds[node]
    codes = np.zeros(count, dtype=np.int64)
    for edge in problem.roads.corridor[vertex]:
        if edge >= 0 and nodes.known[node, edge] == UNKNOWN:
            for k in range(count):
                codes[k] = 2 * codes[k] + problem.worlds[tree.pool[start + k], edge]
    order = np.argsort(codes, kind="mergesort")
    first = tree.used[2]
    here = tree.used[0]
    for k in range(count):
        tree.pool[first + k] = tree.pool[start + order[k]]
        if k == 0 or codes[order[k]] != codes[order[k - 1]]:
            nodes.first_world[here] = first + k
            nodes.worlds[here] = 0
            here += 1
        nodes.worlds[here - 1] += 1
    tree.used[2] += count
    return tree.used[0], here - tree.used[0]


@njit(cache=True)
def add_action(
    problem: Problem, tree: Tree, scratch: Scratch, node: int, vertex: int, cost: float
) -> None:
    """One move from ``node`` with a leaf for everything that may be seen at its end."""
    nodes, actions = tree.nodes, tree.actions
    errands, stage = problem.errands, nodes.stage[node]
    if is_news(problem.roads, nodes.known[node], vertex):
        cost += errands.news_s
    action = tree.used[1]
    tree.used[1] += 1
    nodes.actions[node] += 1
    actions.node[action] = node
    actions.to[action] = vertex
    actions.cost[action] = errands.weight[stage] * cost
    actions.first_child[action] = 0
    actions.children[action] = 0
    after = next_stage(errands, stage, vertex)
    if after < len(errands.goals):
        first, children = split(problem, tree, node, vertex)
        tree.used[0] += children
        actions.first_child[action] = first
        actions.children[action] = children
        for child in range(first, first + children):
            nodes.place[child] = vertex
            nodes.stage[child] = after
            nodes.parent[child] = action
            nodes.known[child] = nodes.known[node]
            world = problem.worlds[tree.pool[nodes.first_world[child]]]
            learn(problem.roads, nodes.known[child], world, vertex)
            evaluate(problem, tree, scratch, child)
    weigh_action(tree, action)


@njit(cache=True)
def weigh_action(tree: Tree, action: int) -> None:
    """An action's values from its children's."""
    nodes, actions = tree.nodes, tree.actions
    upper, lower, mass = 0.0, 0.0, 0.0
    for child in range(
        actions.first_child[action], actions.first_child[action] + actions.children[action]
    ):
        upper += nodes.mass[child] * nodes.upper[child]
        lower += nodes.mass[child] * nodes.lower[child]
        mass += nodes.mass[child]
    actions.upper[action] = actions.cost[action] + (upper / mass if mass else 0.0)
    actions.lower[action] = actions.cost[action] + (lower / mass if mass else 0.0)


@njit(cache=True)
def best_action(tree: Tree, node: int) -> int:
    """The action of least upper; ties to the first."""
    nodes, actions = tree.nodes, tree.actions
    best = int(nodes.first_action[node])
    for action in range(best + 1, best + nodes.actions[node]):
        if actions.upper[action] < actions.upper[best]:
            best = action
    return best


@njit(cache=True)
def weigh_node(tree: Tree, node: int) -> None:
    """A node's values from its actions'."""
    nodes, actions = tree.nodes, tree.actions
    first = nodes.first_action[node]
    end = first + nodes.actions[node]
    best = best_action(tree, node)
    nodes.upper[node] = actions.upper[best]
    nodes.lower[node] = actions.lower[first:end].min()
    nodes.worth[node] = most_below(tree, best, nodes.worth)
    nodes.doubt[node] = 0.0
    for action in range(first, end):
        if may_be_best(tree, action):
            below = most_below(tree, action, nodes.doubt)
            nodes.doubt[node] = max(nodes.doubt[node], below)


@njit(cache=True)
def may_be_best(tree: Tree, action: int) -> bool:
    """Whether the bounds leave it open that an action is better than the best one seems."""
    upper = tree.nodes.upper[tree.actions.node[action]]
    return bool(tree.actions.lower[action] < upper * (1.0 - ROUNDING))


@njit(cache=True)
def most_below(tree: Tree, action: int, gains: NDArray[np.float64]) -> float:
    """The most that any child of an action has of ``gains``."""
    most = 0.0
    first = tree.actions.first_child[action]
    for child in range(first, first + tree.actions.children[action]):
        most = max(most, gains[child])
    return most


@njit(cache=True)
def look_into(problem: Problem, tree: Tree, scratch: Scratch, node: int) -> bool:
    """Give a leaf its actions; False where there is no room for them."""
    nodes = tree.nodes
    roads = problem.roads
    start, count = nodes.first_world[node], nodes.worlds[node]
    stage = nodes.stage[node]
    n = moves(
        roads,
        nodes.known[node],
        nodes.place[node],
        problem.errands.goals[stage],
        scratch.way,
        scratch.queue,
        scratch.found,
    )
    kept = 0
    for k in range(n):
        vertex = scratch.found[k]
        lower = 0.0
        for w in range(start, start + count):
            j = tree.pool[w]
            lower += problem.odds[j] * problem.clairvoyant[j, stage, vertex]
        least = problem.errands.weight[stage] * scratch.way[vertex] + lower / nodes.mass[node]
        if least <= nodes.upper[node] * (1 + ROUNDING):
            scratch.found[kept] = vertex
            kept += 1
    if (
        tree.used[2] + kept * count > len(tree.pool)
        or tree.used[0] + kept * count > len(nodes.place)
        or tree.used[1] + kept > len(tree.actions.to)
    ):
        nodes.worth[node] = nodes.doubt[node] = 0.0
        return False
    nodes.first_action[node] = tree.used[1]
    for k in range(kept):
        vertex = scratch.found[k]
        add_action(problem, tree, scratch, node, vertex, scratch.way[vertex])
    weigh_node(tree, node)
    return True


@njit(cache=True)
def child_with(tree: Tree, node: int, gains: NDArray[np.float64], in_best: bool) -> int:
    """The first child that has what its parent has of ``gains``."""
    best = best_action(tree, node)
    first = tree.nodes.first_action[node]
    for action in range(first, first + tree.nodes.actions[node]):
        if action == best if in_best else may_be_best(tree, action):
            below = tree.actions.first_child[action]
            for child in range(below, below + tree.actions.children[action]):
                if gains[child] == gains[node]:
                    return child
    return -1


@njit(cache=True)
def grow(problem: Problem, tree: Tree, scratch: Scratch) -> None:
    """Look into one leaf after another, until there is no room or nothing left to gain."""
    nodes, actions = tree.nodes, tree.actions
    look_into(problem, tree, scratch, 0)
    while nodes.doubt[0] > 0.0:
        in_best = nodes.worth[0] > 0.0
        gains = nodes.worth if in_best else nodes.doubt
        node = 0
        while nodes.actions[node]:
            node = child_with(tree, node, gains, in_best)
        look_into(problem, tree, scratch, node)
        while nodes.parent[node] >= 0:
            action = nodes.parent[node]
            weigh_action(tree, action)
            node = actions.node[action]
            weigh_node(tree, node)


@njit(cache=True)
def plan_tree(
    problem: Problem, tree: Tree, scratch: Scratch, known: NDArray[np.uint8], place: int
) -> None:
    """Grow a tree from ``place``, whose edges are known. It needs a cell a world at least."""
    nodes = tree.nodes
    nodes.place[0] = place
    nodes.stage[0] = next_stage(problem.errands, 0, place)
    nodes.known[0] = known
    nodes.first_world[0] = 0
    nodes.worlds[0] = len(problem.worlds)
    nodes.parent[0] = -1
    for j in range(len(problem.worlds)):
        tree.pool[j] = j
    tree.used[0] = 1
    tree.used[1] = 0
    tree.used[2] = len(problem.worlds)
    evaluate(problem, tree, scratch, 0)
    grow(problem, tree, scratch)
