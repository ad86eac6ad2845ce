"""Every simple path of a small grid, and what it is worth, in exact fractions."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from modules.decider.roads import Roads


def simple_paths(roads: Roads, place: int, goal: int) -> Iterator[tuple[int, ...]]:
    """Corridors of each path that visits no intersection twice."""
    yield from _onward(roads, place, goal, (place,), ())


def _onward(
    roads: Roads, place: int, goal: int, seen: tuple[int, ...], corridors: tuple[int, ...]
) -> Iterator[tuple[int, ...]]:
    if place == goal:
        yield corridors
        return
    for d in range(4):
        corridor, other = int(roads.corridor[place, d]), int(roads.neighbour[place, d])
        if corridor >= 0 and other not in seen:
            yield from _onward(roads, other, goal, (*seen, other), (*corridors, corridor))


def weight(level: int, present: NDArray[np.uint8]) -> Fraction:
    """Section 4's weight of one corridor; ``present`` has an entry a map."""
    if level == 3:
        return Fraction(1)
    if level < 2:
        return Fraction(0)
    return Fraction(int(present.sum()) + 1, len(present) + 1)


def product(path: tuple[int, ...], weights: list[Fraction]) -> Fraction:
    value = Fraction(1)
    for corridor in path:
        value *= weights[corridor]
    return value
