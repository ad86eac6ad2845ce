"""What the modules decide in a tiny world: the classifier's stop rule, the decider's way."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from benchmarks.joint_problem import STOP
from benchmarks.tiny_world import UNREAD, Info, TinyWorld
from bus.grid import Maps
from modules.classifier.choose import WRONG_TYPE_S
from modules.classifier.worth import Detectors, best_test
from modules.decider.decision import decide
from modules.decider.outlook import decide_by_outlook
from modules.decider.situation import Situation
from modules.decider.stakes import regret_s, stakes_of

LOOK_AHEAD = 3


@dataclass
class ClassifierRule:
    """Test on as long as a plan of tests saves time against concluding (modules.classifier.worth).

    What it takes from the rest is pi(J) alone, and, where ``heeds_stakes``, what the decider says
    that a wrong type costs (modules.decider.stakes); else it does not know what the type is for.
    """

    wrong_type_s: float = WRONG_TYPE_S
    independent: bool = False
    heeds_stakes: bool = False

    def __call__(self, world: TinyWorld, info: Info, place: int) -> int:
        """The detector to run at ``place``, or STOP."""
        maps, weights = believed(world, info, self.independent)
        belief, types = types_at(world, maps, weights, place)
        numbers = [k for k, d in enumerate(world.detectors) if d.place == place]
        given = np.array(
            [
                [np.where(types >> d.direction & 1, s, 1.0 - s) for s in (1.0 - d.right, d.right)]
                for d in (world.detectors[k] for k in numbers)
            ]
        )
        seconds = np.array([world.detectors[k].seconds for k in numbers])
        used = sum(1 << row for row, k in enumerate(numbers) if info.readings[k] != UNREAD)
        cost_s = self.wrong_type_s * (1.0 - np.eye(len(types)))
        if self.heeds_stakes:
            cost_s = at_stake_s(situation_at(world, info, place, maps, weights), types)
        found = best_test(belief, cost_s, Detectors(given, seconds), used, LOOK_AHEAD)
        return STOP if found.row < 0 else numbers[found.row]


def at_stake_s(situation: Situation, types: NDArray[np.int64]) -> NDArray[np.float64]:
    """What the decider says that concluding one of these types costs where another is true."""
    outlook = decide_by_outlook(situation, len(situation.maps))
    stakes = stakes_of(situation, len(situation.maps))
    return regret_s(situation, stakes, outlook)[np.ix_(types, types)]


def situation_at(
    world: TinyWorld,
    info: Info,
    place: int,
    maps: Maps,
    weights: NDArray[np.float64],
    futures: float = 1.0,
) -> Situation:
    """What the decider is told: the next goal, the later ones as tasks, the maps that may be."""
    keep = weights > 0
    later = world.goals[info.leg :]
    tasks = np.array(list(pairwise(later)), dtype=np.int64).reshape(-1, 2)
    return Situation(
        grid=world.grid,
        place=place,
        came_from=0,
        waypoints=later[:1],
        tasks=tasks,
        expected=np.full(len(tasks), futures),
        maps=maps[keep],
        weights=weights[keep],
        log_probability=np.log(weights[keep]),
        corridor_probability=np.clip(weights @ maps, 0.0, 1.0),
        corridor_s=world.corridor_s,
        sensing_s=max((d.seconds for d in world.detectors), default=0.0),
    )


@dataclass
class DeciderRule:
    """P_K or P_U for the most probable junction type (modules.decider.decision).

    Conclusions stay: an intersection that was tested has its most probable type. ``futures``
    multiplies the later errands expected. Every decision is made once.
    """

    futures: float = 1.0
    independent: bool = False
    _made: dict[tuple[Info, int], int] = field(default_factory=dict)

    def __call__(self, world: TinyWorld, info: Info, place: int) -> int:
        """The corridor to take from ``place``."""
        key = (info._replace(met=False), place)
        if key not in self._made:
            self._made[key] = self._decide(world, info, place)
        return self._made[key]

    def _decide(self, world: TinyWorld, info: Info, place: int) -> int:
        maps, weights = believed(world, info, self.independent)
        for junction in classified(world, info, place):
            weights = weights * (
                types_of(world, maps, junction) == most(world, maps, weights, junction)
            )
        weights = weights / weights.sum()
        concluded = most(world, maps, weights, place)
        found = decide(situation_at(world, info, place, maps, weights, self.futures))
        direction = int(found.direction[concluded]).bit_length() - 1
        return int(world.roads.corridor[place, direction])


def stand_aside_unless_long(aside_s: float, drive_s: float) -> bool:
    """The reaction by itself: back and the same corridor again, or wait, whichever is shorter."""
    return aside_s > drive_s


def believed(world: TinyWorld, info: Info, independent: bool) -> tuple[Maps, NDArray[np.float64]]:
    """Maps and probabilities: the exact joint, or its corridors taken to be independent."""
    weights = world.weights(info)
    if not independent:
        return world.maps, weights
    p = np.clip(weights @ world.maps, 0.0, 1.0)
    count = world.grid.corridors
    maps = np.array(np.unravel_index(np.arange(2**count), (2,) * count), dtype=np.uint8).T
    product = np.where(maps, p, 1.0 - p).prod(axis=1)
    keep = product > 1e-12
    return maps[keep], product[keep] / product[keep].sum()


def classified(world: TinyWorld, info: Info, place: int) -> list[int]:
    """Intersections that the classifier has come to a conclusion about, the present one last."""
    read = {d.place for d, r in zip(world.detectors, info.readings, strict=True) if r != UNREAD}
    return [*sorted(read - {place}), place]


def types_of(world: TinyWorld, maps: Maps, place: int) -> NDArray[np.uint8]:
    """Junction type at ``place`` in each map."""
    types: NDArray[np.uint8] = world.grid.junction_types(maps)[:, place]
    return types


def most(world: TinyWorld, maps: Maps, weights: NDArray[np.float64], place: int) -> int:
    """The most probable junction type at ``place``; ties go to the lowest."""
    belief, types = types_at(world, maps, weights, place)
    return int(types[np.round(belief, 12).argmax()])


def types_at(
    world: TinyWorld, maps: Maps, weights: NDArray[np.float64], place: int
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """P(J) at ``place`` and which types these are; those of probability zero are left out."""
    types = types_of(world, maps, place)
    belief = np.bincount(types, weights=weights, minlength=16).astype(np.float64)
    there = np.flatnonzero(belief > 0)
    return belief[there], there
