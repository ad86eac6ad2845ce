"""Shortest ways, what arriving teaches, and a cheap policy driven to its end: numba kernels.

What is known is one number an edge: :data:`BLOCKED`, :data:`UNKNOWN` or :data:`FREE`. A *price*
is what a planner takes an edge to cost: its own cost where free, infinite where blocked. Arriving
at a vertex teaches all its edges, so a vertex with an unknown edge is *news*, and between two
pieces of news nothing changes: a *move* goes over free edges to the next news or to the goal.
Ties go to the lower vertex or the earlier edge; every sum has a fixed order.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.decider.roads import Roads

BLOCKED, UNKNOWN, FREE = 0, 1, 2


@njit(cache=True)
def is_news(roads: Roads, known: NDArray[np.uint8], vertex: int) -> bool:
    """Whether arriving at ``vertex`` would teach anything."""
    for edge in roads.corridor[vertex]:  # noqa: SIM110, numba has no any() of a generator
        if edge >= 0 and known[edge] == UNKNOWN:
            return True
    return False


@njit(cache=True)
def learn(roads: Roads, known: NDArray[np.uint8], world: NDArray[np.uint8], vertex: int) -> None:
    """See which edges of ``vertex`` are free in ``world``."""
    for edge in roads.corridor[vertex]:
        if edge >= 0:
            known[edge] = FREE if world[edge] else BLOCKED


@njit(cache=True)
def set_prices(
    roads: Roads,
    known: NDArray[np.uint8],
    hope: NDArray[np.float64],
    price: NDArray[np.float64],
) -> None:
    """Fill ``price``: a free edge at its cost, an unknown one at ``hope``."""
    for edge in range(len(known)):
        if known[edge] == FREE:
            price[edge] = roads.seconds[edge]
        else:
            price[edge] = hope[edge] if known[edge] == UNKNOWN else np.inf


@njit(cache=True)
def shortest(
    roads: Roads,
    price: NDArray[np.float64],
    source: int,
    until: int,
    field: NDArray[np.float64],
    queue: NDArray[np.int64],
) -> None:
    """Fill ``field`` with distances from ``source``, final for all nearer than ``until``.

    Every vertex where ``until`` is -1. Dijkstra's method; ``queue`` is scratch, (vertices,).
    """
    field[:] = np.inf
    field[source] = 0.0
    queue[0] = source
    waiting = 1
    while waiting:
        first = 0
        for k in range(1, waiting):
            if field[queue[k]] < field[queue[first]]:
                first = k
        vertex = queue[first]
        if vertex == until:
            return
        waiting -= 1
        queue[first] = queue[waiting]
        for slot in range(roads.corridor.shape[1]):
            edge = roads.corridor[vertex, slot]
            if edge < 0:
                continue
            through = field[vertex] + price[edge]
            other = roads.neighbour[vertex, slot]
            if through < field[other]:
                if field[other] == np.inf:
                    queue[waiting] = other
                    waiting += 1
                field[other] = through


@njit(cache=True)
def moves(
    roads: Roads,
    known: NDArray[np.uint8],
    place: int,
    goal: int,
    field: NDArray[np.float64],
    queue: NDArray[np.int64],
    found: NDArray[np.int64],
) -> int:
    """Every move from ``place``: how many; ``found`` lists their ends, ``field`` has their costs.

    A way is not continued beyond news or the goal. ``found`` is (vertices,).
    """
    field[:] = np.inf
    field[place] = 0.0
    queue[0] = place
    waiting, count = 1, 0
    while waiting:
        first = 0
        for k in range(1, waiting):
            if field[queue[k]] < field[queue[first]]:
                first = k
        vertex = queue[first]
        waiting -= 1
        queue[first] = queue[waiting]
        if vertex == goal or (vertex != place and is_news(roads, known, vertex)):
            found[count] = vertex
            count += 1
            continue
        for slot in range(roads.corridor.shape[1]):
            edge = roads.corridor[vertex, slot]
            if edge >= 0 and known[edge] == FREE:
                through = field[vertex] + roads.seconds[edge]
                other = roads.neighbour[vertex, slot]
                if through < field[other]:
                    if field[other] == np.inf:
                        queue[waiting] = other
                        waiting += 1
                    field[other] = through
    return count


@njit(cache=True)
def cheapest_step(
    roads: Roads, price: NDArray[np.float64], field: NDArray[np.float64], place: int
) -> tuple[int, float]:
    """The slot of the edge of least price and way beyond it, and that sum; (-1, inf) for none."""
    chosen, least = -1, np.inf
    for slot in range(roads.corridor.shape[1]):
        edge = roads.corridor[place, slot]
        if edge >= 0:
            through = price[edge] + field[roads.neighbour[place, slot]]
            if through < least:
                chosen, least = slot, through
    return chosen, least


@njit(cache=True)
def follow(
    roads: Roads,
    world: NDArray[np.uint8],
    place: int,
    goal: int,
    seen: NDArray[np.uint8],
    price: NDArray[np.float64],
    field: NDArray[np.float64],
    queue: NDArray[np.int64],
) -> tuple[float, int]:
    """Always take the way of least price with all that is learnt: (cost, arrivals that taught).

    The edges of ``place`` are known; ``seen`` holds what is known and ``price`` what edges are
    taken to cost, both are changed. Infinite where the world has no way.
    """
    spent, lessons = 0.0, 0
    planned = False
    while place != goal:
        chosen, least = -1, np.inf
        if planned:
            chosen, least = cheapest_step(roads, price, field, place)
        # What was learnt is beside the way or behind it, where going back saves nothing: the
        # field holds until the way itself turns out to be blocked.
        if not planned or least > field[place]:
            shortest(roads, price, goal, place, field, queue)
            planned = True
            if field[place] == np.inf:
                return np.inf, lessons
            chosen, least = cheapest_step(roads, price, field, place)
        spent += roads.seconds[roads.corridor[place, chosen]]
        place = roads.neighbour[place, chosen]
        if is_news(roads, seen, place):
            lessons += 1
            learn(roads, seen, world, place)
            for edge in roads.corridor[place]:
                if edge >= 0:
                    price[edge] = roads.seconds[edge] if world[edge] else np.inf
    return spent, lessons
