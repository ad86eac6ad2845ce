"""A tree of moves and of what they may show, as the kernels see it.

A *node* is a place, the goal made for and what is known, with the worlds that agree with it. Its
*upper* is the mean cost over these worlds of a policy: the base policy from a leaf, the best move
elsewhere.
Its *lower* is a bound for every policy: the mean cost if the world were known. An *action* is a
move from a node; its *children* are one node for each thing that its worlds show where it ends.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from modules.decider.roads import Roads
from modules.decider.traveller.errand_kernels import Errands


class Problem(NamedTuple):
    """What does not change while the tree grows."""

    roads: Roads
    errands: Errands
    worlds: NDArray[np.uint8]
    """(n, edges): each has a way to all goals."""
    odds: NDArray[np.float64]
    """(n,): of each world, above 0."""
    clairvoyant: NDArray[np.float64]
    """(n, goals, vertices): cost of what is left, from this goal on, if the world were known."""
    hope: NDArray[np.float64]
    """(edges,): the price of an unknown edge to the base policy."""


class Nodes(NamedTuple):
    """(most,) each but ``known``: (most, edges)."""

    place: NDArray[np.int64]
    stage: NDArray[np.int64]
    """Which of the goals it makes for."""
    known: NDArray[np.uint8]
    first_world: NDArray[np.int64]
    """Where its worlds start in ``pool``."""
    worlds: NDArray[np.int64]
    """How many."""
    mass: NDArray[np.float64]
    """The sum of their odds."""
    parent: NDArray[np.int64]
    """The action that led here, -1 at the root."""
    first_action: NDArray[np.int64]
    actions: NDArray[np.int64]
    """How many; 0 at a leaf."""
    upper: NDArray[np.float64]
    lower: NDArray[np.float64]
    worth: NDArray[np.float64]
    """The most that looking into one leaf of the best plan below could bring, times mass."""
    doubt: NDArray[np.float64]
    """The same over the leaves of every plan below that may still be the best."""


class Actions(NamedTuple):
    """(most,) each."""

    node: NDArray[np.int64]
    to: NDArray[np.int64]
    cost: NDArray[np.float64]
    first_child: NDArray[np.int64]
    children: NDArray[np.int64]
    upper: NDArray[np.float64]
    lower: NDArray[np.float64]


class Tree(NamedTuple):
    """A tree and the room it may take."""

    nodes: Nodes
    actions: Actions
    pool: NDArray[np.int64]
    """(cells,): numbers of worlds, a stretch a node; each is one drive of the base policy."""
    used: NDArray[np.int64]
    """(3,): nodes, actions, cells in use."""


class Scratch(NamedTuple):
    """(vertices,) and (edges,)."""

    field: NDArray[np.float64]
    queue: NDArray[np.int64]
    found: NDArray[np.int64]
    way: NDArray[np.float64]
    price: NDArray[np.float64]
    driven: NDArray[np.float64]
    seen: NDArray[np.uint8]


def room(cells: int, edges: int, vertices: int) -> Tree:
    """An empty tree for ``cells`` drives: no node has fewer than one."""
    most = cells + vertices
    nodes = Nodes(
        place=_numbers(cells),
        stage=_numbers(cells),
        known=np.empty((cells, edges), np.uint8),
        first_world=_numbers(cells),
        worlds=_numbers(cells),
        mass=np.empty(cells),
        parent=_numbers(cells),
        first_action=_numbers(cells),
        actions=_numbers(cells),
        upper=np.empty(cells),
        lower=np.empty(cells),
        worth=np.empty(cells),
        doubt=np.empty(cells),
    )
    actions = Actions(
        node=_numbers(most),
        to=_numbers(most),
        cost=np.empty(most),
        first_child=_numbers(most),
        children=_numbers(most),
        upper=np.empty(most),
        lower=np.empty(most),
    )
    return Tree(nodes, actions, _numbers(cells), np.zeros(3, np.int64))


def _numbers(count: int) -> NDArray[np.int64]:
    return np.empty(count, np.int64)


def scratch_for(vertices: int, edges: int) -> Scratch:
    """Scratch of a graph's size."""
    return Scratch(
        np.empty(vertices),
        np.empty(vertices, np.int64),
        np.empty(vertices, np.int64),
        np.empty(vertices),
        np.empty(edges),
        np.empty(edges),
        np.empty(edges, np.uint8),
    )
