"""An errand by one method: a step along its best way, learn, and again (paper, section 4)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bus.grid import Maps
from modules.decider.methods.ways import Method, best_way, corridor_weights
from modules.decider.roads import PLANNED, Roads
from modules.decider.travel_kernels import learn

Believe: TypeAlias = Callable[[NDArray[np.uint8]], tuple[Maps, NDArray[np.float64]]]
"""From what is known, (corridors,), to maps that fit it and their probabilities: the same ones
whenever the same is known, or the robot might change its mind without end."""


class MethodError(ValueError):
    """A goal that the true map does not join to the start."""


@dataclass(frozen=True)
class Journey:
    """An errand driven to its goal."""

    seconds: float
    places: tuple[int, ...]
    """Every intersection in turn, the start and the goal included."""
    levels: NDArray[np.uint8]
    """What is known afterwards, (corridors,), see roads.py."""


def drive(
    roads: Roads,
    method: Method,
    levels: NDArray[np.uint8],
    truth: NDArray[np.uint8],
    errand: tuple[int, int],
    believe: Believe,
    rng: np.random.Generator,
) -> Journey:
    """Drive an errand (start, goal) in a world of known ``truth``, (corridors,) of 0 and 1.

    Arriving shows the true corridors of an intersection, at the start too: classification is
    perfect. It ends: as long as a step teaches nothing, what is left of the way gets shorter by
    it, and each corridor is learnt only once; ``random`` ends with probability 1. ``rng`` serves
    ``random`` alone. Raises MethodError where the true map has no way.
    """
    place, goal = errand
    known = np.array(levels, dtype=np.uint8)
    learn(roads, known, truth, place)
    places, seconds, back = [place], 0.0, -1
    if best_way(roads, "shortest", _only(truth), truth.astype(float), place, goal).first == np.inf:
        raise MethodError(f"errand: found {errand}, expected places that the true map joins")
    while place != goal:
        if method == "random":
            step = random_step(roads, known, place, back, rng)
        else:
            weights = corridor_weights(known, *believe(known))
            step = best_way(roads, method, known, weights, place, goal).steps[0]
        seconds += float(roads.seconds[roads.corridor[place, step]])
        place, back = int(roads.neighbour[place, step]), (step + 2) % 4
        learn(roads, known, truth, place)
        places.append(place)
    return Journey(seconds, tuple(places), known)


def random_step(
    roads: Roads, levels: NDArray[np.uint8], place: int, back: int, rng: np.random.Generator
) -> int:
    """Any corridor known to be at ``place``, equally likely, but ``back`` only from a dead end.

    -1 where none is known.
    """
    there = [d for d in range(4) if _known(roads, levels, place, d)]
    onward = [d for d in there if d != back] or there
    return onward[int(rng.integers(len(onward)))] if onward else -1


def _known(roads: Roads, levels: NDArray[np.uint8], place: int, d: int) -> bool:
    corridor = roads.corridor[place, d]
    return bool(corridor >= 0 and levels[corridor] == PLANNED)


def _only(truth: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return np.where(truth > 0, PLANNED, 0).astype(np.uint8)
