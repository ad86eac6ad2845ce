"""Random connected maps to run errands in, and robots that do not know them.

A map is drawn exactly from all connected maps in which the places of the errands exist. Arriving
at an intersection shows which corridors it has, and nothing else does; only driving takes time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bus.grid import DIRECTIONS, Maps
from modules.decider import Situation, decide
from modules.decider.roads import Roads, roads_of
from modules.decider.traveller import (
    BLOCKED,
    FREE,
    UNKNOWN,
    Errands,
    independent_worlds,
    least_cells,
    look_ahead_over,
)
from modules.decider.traveller.errand_kernels import drive_on
from modules.decider.traveller.way_kernels import learn, moves, set_prices
from modules.decider.traveller.world_kernels import clairvoyant
from modules.geographer import ConnectedMaps

SIZES = (3, 4, 5, 6, 7, 8)
ODDS = (0.5, 1.0, 2.0, 4.0)
DRAWN = 1024
"""Maps drawn from the exact belief at once. Those that agree with what is learnt later are exact
samples still, until fewer than FEWEST are left."""

FEWEST = 64
WORLDS = 64
"""Maps that a decision rests on."""

NEVER = 1e3
"""What an unknown corridor costs more than its length to a robot that avoids it, in corridors."""

Known = NDArray[np.uint8]


@lru_cache(maxsize=len(SIZES))
def all_maps(size: int) -> ConnectedMaps:
    """All connected maps of a square grid."""
    return ConnectedMaps(size, size)


@dataclass(frozen=True)
class World:
    """One building, its corridors' lengths, and places to visit in turn from a start."""

    seed: int
    size: int
    odds: float
    roads: Roads
    start: int
    goals: NDArray[np.int64]
    truth: NDArray[np.uint8]

    @classmethod
    def drawn(cls, seed: int, size: int, errands: int) -> World:
        """The world of a seed; its places are drawn first, then a map that has them all."""
        rng = np.random.default_rng([12, seed])
        maps = all_maps(size)
        odds = ODDS[int(rng.integers(len(ODDS)))]
        roads = roads_of(maps.grid, rng.uniform(0.5, 1.5, maps.grid.corridors))
        places = [int(rng.integers(maps.grid.intersections))]
        while len(places) <= errands:
            place = int(rng.integers(maps.grid.intersections))
            if place != places[-1]:
                places.append(place)
        goals = np.array(places[1:], np.int64)
        blank = np.full(maps.grid.corridors, UNKNOWN, np.uint8)
        truth = sample(size, odds, places, blank, 1, rng)[0]
        return cls(seed, size, odds, roads, places[0], goals, truth)

    @property
    def places(self) -> list[int]:
        """Start and goals."""
        return [self.start, *self.goals.tolist()]


def sample(
    size: int, odds: float, places: list[int], known: Known, count: int, rng: np.random.Generator
) -> Maps:
    """Exact samples of the connected maps with these places, given what is known."""
    there = np.ones((size * size, 16))
    there[places, 0] = 0.0
    seen = np.ones((len(known), 2))
    seen[known == FREE, 0] = 0.0
    seen[known == BLOCKED, 1] = 0.0
    belief = all_maps(size).posterior(there.reshape(size, size, 16), odds, seen)
    return belief.sample(count, rng)


@dataclass
class Belief:
    """Exact samples given what is known, drawn anew when too few are left."""

    world: World
    _left: Maps = field(init=False)

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng([13, self.world.seed])
        self._left = np.empty((0, len(self.world.truth)), np.uint8)

    def maps(self, known: Known) -> Maps:
        """At least :data:`FEWEST` maps that agree with what is known."""
        agree = ((self._left == (known == FREE)) | (known == UNKNOWN)).all(axis=1)
        self._left = self._left[agree]
        if len(self._left) < FEWEST:
            w = self.world
            self._left = sample(w.size, w.odds, w.places, known, DRAWN, self._rng)
        return self._left


@dataclass
class Robot:
    """A robot on its errands: where it is, what it knows, what it drove."""

    world: World
    belief: Belief
    place: int
    stage: int
    known: Known
    driven: float = 0.0

    @classmethod
    def at_start(cls, world: World) -> Robot:
        """Before the first errand; it knows the corridors of where it stands."""
        known = np.full(len(world.truth), UNKNOWN, np.uint8)
        learn(world.roads, known, world.truth, world.start)
        return cls(world, Belief(world), world.start, 0, known)

    @property
    def left(self) -> NDArray[np.int64]:
        """Goals still to visit."""
        return self.world.goals[self.stage :]

    def reachable(self, goal: int) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Where known corridors lead to news or ``goal`` (-1 for none), and the way to each."""
        count = len(self.world.roads.corridor)
        way, queue = np.empty(count), np.empty(count, np.int64)
        found = np.empty(count, np.int64)
        k = moves(self.world.roads, self.known, self.place, goal, way, queue, found)
        return found[:k], way[found[:k]]

    def go(self, vertex: int, cost: float) -> None:
        """Drive to a place and learn its corridors; a goal that is reached is done."""
        self.driven += cost
        self.place = vertex
        learn(self.world.roads, self.known, self.world.truth, vertex)
        while self.stage < len(self.world.goals) and self.world.goals[self.stage] == vertex:
            self.stage += 1


def by_policy(world: World, hope: NDArray[np.float64], robot: Robot | None = None) -> float:
    """Driven by the way of least price, unknown corridors at ``hope``."""
    robot = robot or Robot.at_start(world)
    price = np.empty(len(world.truth))
    count = len(world.roads.corridor)
    set_prices(world.roads, robot.known, hope, price)
    errands = Errands(robot.left, np.ones(len(robot.left)), 0.0)
    arrays = robot.known, price, np.empty(count), np.empty(count, np.int64)
    return robot.driven + drive_on(world.roads, errands, world.truth, 0, robot.place, *arrays)


def known_ways(world: World) -> float:
    """Known corridors wherever they lead to the goal, else as few unknown ones as may be."""
    return by_policy(world, world.roads.seconds + NEVER)


def optimist(world: World) -> float:
    """The shortest way that may exist."""
    return by_policy(world, world.roads.seconds)


def explorer(world: World) -> float:
    """The nearest place with anything to learn, until there is none; then the errands."""
    robot = Robot.at_start(world)
    while True:
        found, way = robot.reachable(-1)
        if not len(found):
            robot.stage = 0
            return by_policy(world, world.roads.seconds, robot)
        robot.go(int(found[0]), float(way[0]))


def seer(world: World) -> float:
    """The shortest way of each errand in the true map."""
    total = 0.0
    for start, goal in zip(world.places, world.goals.tolist(), strict=False):
        total += float(clairvoyant(world.roads, world.truth[None], goal)[0, start])
    return total


def by_paper(world: World) -> float:
    """P_K or P_U at every intersection (paper, section 3), Futures of all errands to come."""
    robot = Robot.at_start(world)
    grid = all_maps(world.size).grid
    while len(robot.left):
        maps = robot.belief.maps(robot.known)
        types = grid.junction_types(maps[:1])[0]
        later = robot.left
        marginal = maps.mean(axis=0)
        found = decide(
            Situation(
                grid=grid,
                place=robot.place,
                came_from=0,
                waypoints=(int(later[0]),),
                tasks=np.stack([later[:-1], later[1:]], axis=1),
                expected=np.ones(len(later) - 1),
                maps=maps[:WORLDS],
                weights=np.full(len(maps[:WORLDS]), 1 / len(maps[:WORLDS])),
                log_probability=world_log_odds(world, maps[:WORLDS]),
                corridor_probability=marginal,
                corridor_s=world.roads.seconds,
                sensing_s=0.0,
            )
        )
        direction = DIRECTIONS.index(int(found.direction[types[robot.place]]))
        corridor = world.roads.corridor[robot.place, direction]
        there = int(world.roads.neighbour[robot.place, direction])
        robot.go(there, float(world.roads.seconds[corridor]))
    return robot.driven


def world_log_odds(world: World, maps: Maps) -> NDArray[np.float64]:
    """Log posterior of maps that agree with all that is known, up to a constant."""
    corridors: NDArray[np.float64] = maps.sum(axis=1, dtype=np.float64)
    return corridors * float(np.log(world.odds))


def by_plan(world: World, worlds_of: Callable[[Robot], Maps], worlds: int = WORLDS) -> float:
    """The decider's planner at every piece of news, over maps from ``worlds_of``."""
    robot = Robot.at_start(world)
    while len(robot.left):
        maps = worlds_of(robot)[:worlds]
        if not len(maps):
            return by_policy(world, world.roads.seconds, robot)
        distinct, counts = np.unique(maps, axis=0, return_counts=True)
        errands = Errands(robot.left, np.ones(len(robot.left)), 0.0)
        cells = least_cells(len(world.roads.corridor), worlds)
        plan = look_ahead_over(
            world.roads, robot.known, robot.place, errands, distinct, counts.astype(float), cells
        )
        robot.go(int(plan.to[plan.best]), float(plan.cost[plan.best]))
    return robot.driven


def jointly(world: World) -> float:
    """The planner over exact samples of the joint belief."""
    return by_plan(world, lambda robot: robot.belief.maps(robot.known))


def independently(world: World) -> float:
    """The planner with corridors independent of each other, of the exact marginals."""
    rng = np.random.default_rng([14, world.seed])

    def worlds_of(robot: Robot) -> Maps:
        p = robot.belief.maps(robot.known).mean(axis=0)
        goals = robot.left
        drawn = independent_worlds(
            world.roads, p, robot.known, robot.place, int(goals[0]), 2 * WORLDS, rng
        )
        for goal in np.unique(goals).tolist():
            drawn = drawn[np.isfinite(clairvoyant(world.roads, drawn, goal)[:, robot.place])]
        return drawn

    return by_plan(world, worlds_of)


ROBOTS: dict[str, Callable[[World], float]] = {
    "sees the truth": seer,
    "known ways": known_ways,
    "optimist": optimist,
    "explores first": explorer,
    "P_K or P_U": by_paper,
    "independent corridors": independently,
    "least expected cost": jointly,
}
