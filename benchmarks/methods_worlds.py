"""Worlds in which methods of finding places are tried: exact beliefs, errands begun half-way."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bus.grid import Maps
from modules.decider.methods import METHODS, Outlook, drive, features
from modules.decider.roads import OPEN, PLANNED, SEEN_ABSENT, Roads, roads_of
from modules.decider.travel_kernels import learn
from modules.geographer import ConnectedMaps
from modules.geographer.map_belief import MapBelief

SIZES = (3, 4, 5, 6)
ODDS = (0.5, 1.0, 2.0, 4.0)
MAPS = 64
"""Hypotheses drawn from the exact belief at each step."""


@dataclass
class Beliefs:
    """Exact beliefs by what is known; the same question always has the same samples."""

    maps: ConnectedMaps
    odds: float
    seed: int
    _asked: dict[bytes, tuple[Maps, NDArray[np.float64]]] = field(default_factory=dict)

    def exact(self, levels: NDArray[np.uint8]) -> MapBelief:
        """The posterior over all connected maps given corridors seen to be there or not."""
        grid = self.maps.grid
        seen = np.ones((grid.corridors, 2))
        seen[levels == PLANNED, 0] = 0.0
        seen[levels == SEEN_ABSENT, 1] = 0.0
        anything = np.ones((grid.rows, grid.columns, 16))
        return self.maps.posterior(anything, self.odds, seen)

    def __call__(self, levels: NDArray[np.uint8]) -> tuple[Maps, NDArray[np.float64]]:
        """Hypotheses that fit what is known, and their probabilities."""
        key = levels.tobytes()
        if key not in self._asked:
            sample = self.exact(levels).sample(MAPS, np.random.default_rng(self.seed))
            self._asked[key] = sample, np.full(MAPS, 1 / MAPS)
        return self._asked[key]


@dataclass(frozen=True)
class Trial:
    """One errand in one world, by every method, in the order of METHODS; lengths in corridors."""

    size: int
    features: NDArray[np.float64]
    corridors: NDArray[np.float64]
    nats: NDArray[np.float64]
    later_corridors: NDArray[np.float64]


def trial(seed: int) -> Trial:
    """A random world, some of it known, an errand, and one later errand after each method."""
    rng = np.random.default_rng([4, seed])
    size, odds = SIZES[int(rng.integers(len(SIZES)))], ODDS[int(rng.integers(len(ODDS)))]
    maps = ConnectedMaps(size, size)
    beliefs = Beliefs(maps, odds, seed)
    blank = np.full(maps.grid.corridors, OPEN, dtype=np.uint8)
    truth = beliefs.exact(blank).sample(1, rng)[0]
    roads = roads_of(maps.grid, rng.uniform(0.5, 1.5, maps.grid.corridors))
    places = np.flatnonzero(maps.grid.junction_types(truth[None])[0])
    levels = _explored(roads, blank, truth, places, rng)
    start, goal, later_start, later_goal = _ends(places, rng)
    learn(roads, levels, truth, start)
    known, probability = beliefs(levels)
    x = features(roads, Outlook(levels, known, probability, start, goal))
    before = beliefs.exact(levels).entropy
    mean = float(roads.seconds.mean())
    found = []
    for number, method in enumerate(METHODS):
        own = np.random.default_rng([5, seed, number])
        first = drive(roads, method, levels, truth, (start, goal), beliefs, own)
        second = drive(
            roads, "section 4", first.levels, truth, (later_start, later_goal), beliefs, own
        )
        gained = before - beliefs.exact(first.levels).entropy
        found.append((first.seconds / mean, gained, second.seconds / mean))
    corridors, nats, later = np.array(found).T
    return Trial(size, x, corridors, nats, later)


def _explored(
    roads: Roads,
    levels: NDArray[np.uint8],
    truth: NDArray[np.uint8],
    places: NDArray[np.int64],
    rng: np.random.Generator,
) -> NDArray[np.uint8]:
    """What is known after a random walk of random length, which may be none."""
    levels = levels.copy()
    place = int(rng.choice(places))
    for _ in range(int(rng.integers(2 * len(roads.corridor)))):
        learn(roads, levels, truth, place)
        ways = [d for d in range(4) if roads.corridor[place, d] >= 0]
        ways = [d for d in ways if truth[roads.corridor[place, d]]]
        place = int(roads.neighbour[place, ways[int(rng.integers(len(ways)))]])
    return levels


def _ends(places: NDArray[np.int64], rng: np.random.Generator) -> tuple[int, int, int, int]:
    """Start and goal of two errands, each between two different places."""
    first, second = (rng.choice(places, size=2, replace=False) for _ in range(2))
    return int(first[0]), int(first[1]), int(second[0]), int(second[1])
