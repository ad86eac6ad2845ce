"""Worlds: which edges are free, sampled or given; numba kernels."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.decider.roads import Roads
from modules.decider.traveller.way_kernels import FREE, UNKNOWN, shortest


@njit(cache=True)
def joined(
    roads: Roads, world: NDArray[np.uint8], place: int, goal: int, reached: NDArray[np.bool_]
) -> bool:
    """Whether ``world`` has a way from ``place`` to ``goal``. ``reached`` is scratch."""
    reached[:] = False
    reached[place] = True
    queue = np.empty(len(reached), dtype=np.int64)
    queue[0] = place
    waiting = 1
    while waiting:
        waiting -= 1
        vertex = queue[waiting]
        if vertex == goal:
            return True
        for slot in range(roads.corridor.shape[1]):
            edge = roads.corridor[vertex, slot]
            if edge >= 0 and world[edge] and not reached[roads.neighbour[vertex, slot]]:
                reached[roads.neighbour[vertex, slot]] = True
                queue[waiting] = roads.neighbour[vertex, slot]
                waiting += 1
    return False


@njit(cache=True)
def draw_worlds(
    roads: Roads,
    probability: NDArray[np.float64],
    known: NDArray[np.uint8],
    place: int,
    goal: int,
    rng: np.random.Generator,
    tries: int,
    worlds: NDArray[np.uint8],
) -> int:
    """Fill ``worlds`` (n, edges) with samples that have a way to the goal: how many were found.

    Edges are free independently with ``probability``, but for the known ones; at most ``tries``
    samples are drawn.
    """
    reached = np.empty(len(roads.corridor), dtype=np.bool_)
    count = 0
    for _ in range(tries):
        if count == len(worlds):
            break
        world = worlds[count]
        for edge in range(len(known)):
            if known[edge] == UNKNOWN:
                world[edge] = rng.random() < probability[edge]
            else:
                world[edge] = known[edge] == FREE
        if joined(roads, world, place, goal, reached):
            count += 1
    return count


@njit(cache=True)
def clairvoyant(roads: Roads, worlds: NDArray[np.uint8], goal: int) -> NDArray[np.float64]:
    """Cost from every vertex to the goal in each world, if it were known: (n, vertices)."""
    fields = np.empty((len(worlds), len(roads.corridor)))
    price = np.empty(worlds.shape[1])
    queue = np.empty(len(roads.corridor), dtype=np.int64)
    for j in range(len(worlds)):
        for edge in range(len(price)):
            price[edge] = roads.seconds[edge] if worlds[j, edge] else np.inf
        shortest(roads, price, goal, -1, fields[j], queue)
    return fields
