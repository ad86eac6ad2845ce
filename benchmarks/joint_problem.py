"""The whole decision problem of a tiny world, by dynamic programming over what can be known.

What is known (:class:`Info`) only ever grows, so the states form layers: within one, the robot
moves over known corridors, which is a shortest-path problem; testing, trying a corridor, arriving
where there is something to see, reaching a goal and meeting somebody lead to the layers below. The
solution is exact: the least expected seconds to visit all goals.

Some :class:`Rules` narrow what may be done, to a module's own decisions: then the same recursion
gives the exact expected cost of those rules, with everything that is left free done at best.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from benchmarks.tiny_world import NO, PRESENT, UNKNOWN, UNREAD, YES, Info, TinyWorld, learnt

Sensing = Callable[[TinyWorld, Info, int], int]
"""(world, info, place) to the number of the detector to run now, or -1 to go on."""
Leaving = Callable[[TinyWorld, Info, int], int]
"""(world, info, place) to the corridor to take."""
Reacting = Callable[[float, float], bool]
"""(seconds to stand aside, seconds of the corridor) to whether to drive back."""

STOP = -1


@dataclass(frozen=True)
class Rules:
    """What is decided by rule; None where the joint problem decides."""

    sensing: Sensing | None = None
    leaving: Leaving | None = None
    reacting: Reacting | None = None


class EndlessError(RuntimeError):
    """Rules that may lead round in circles, and the world where they do."""


@dataclass
class JointProblem:
    """A tiny world under some rules, and the values found so far."""

    world: TinyWorld
    rules: Rules = field(default_factory=Rules)
    _layers: dict[tuple[Info, tuple[int, ...]], dict[int, float]] = field(default_factory=dict)

    def cost_s(self) -> float:
        """Least expected seconds from the start to the last goal under the rules.

        Raises EndlessError where the rules may go round in circles.
        """
        found = self.value(self.world.nothing, self.world.start)
        if found == np.inf:
            raise EndlessError(f"{self.world}: the rules may never get to the goals")
        return found

    @property
    def states(self) -> int:
        """How many states were solved: what is known, and where."""
        return sum(len(layer) for layer in self._layers.values())

    def value(self, info: Info, place: int) -> float:
        """Least expected seconds still to come; infinite where rules go round in circles."""
        if info.leg == len(self.world.goals):
            return 0.0
        places = self.world.reachable(info, place)
        key = (info, places)
        if key not in self._layers:
            self._layers[key] = self._solve(info, places)
        return self._layers[key][place]

    def _solve(self, info: Info, places: tuple[int, ...]) -> dict[int, float]:
        """Values of one layer: exits first, then the moves between its intersections."""
        exits = {p: self._exit(info, p) for p in places}
        values = {p: value for p, (value, _) in exits.items()}
        steps = {p: self._steps(info, p) for p, (_, forced) in exits.items() if not forced}
        for _ in places:
            for p, corridors in steps.items():
                for corridor, other in corridors:
                    through = self._drive(info, p, corridor, other, values[other])
                    values[p] = min(values[p], through)
        return values

    def _exit(self, info: Info, place: int) -> tuple[float, bool]:
        """The best value of what can be done on the spot, and whether nothing else may be."""
        world = self.world
        if place not in world.noisy and world.unseen(info, place):
            return self._look(info, place), True
        if place == world.goals[info.leg]:
            return self.value(info._replace(leg=info.leg + 1), place), True
        rule = self.rules.sensing
        if rule is not None and place in world.noisy:
            detector = rule(world, info, place)
            if detector != STOP:
                return self._test(info, place, detector), True
        best = np.inf
        if rule is None:
            tests = [self._test(info, place, d) for d in self._free(info, place)]
            best = min(tests, default=np.inf)
        tries = [self._try(info, place, c, o) for c, o in self._unknown_steps(info, place)]
        return min([best, *tries]), False

    def _free(self, info: Info, place: int) -> list[int]:
        detectors = enumerate(self.world.detectors)
        return [k for k, d in detectors if d.place == place and info.readings[k] == UNREAD]

    def _allowed(self, info: Info, place: int) -> list[tuple[int, int]]:
        moves = self.world.moves(place)
        if self.rules.leaving is None:
            return moves
        chosen = self.rules.leaving(self.world, info, place)
        return [(c, other) for c, other in moves if c == chosen]

    def _steps(self, info: Info, place: int) -> list[tuple[int, int]]:
        return [m for m in self._allowed(info, place) if info.levels[m[0]] == PRESENT]

    def _unknown_steps(self, info: Info, place: int) -> list[tuple[int, int]]:
        return [m for m in self._allowed(info, place) if info.levels[m[0]] == UNKNOWN]

    def _look(self, info: Info, place: int) -> float:
        """Arrive where the corridors can be seen."""
        world = self.world
        corridors = world.unseen(info, place)
        weights, total = world.weights(info), 0.0
        seen, which = np.unique(world.maps[:, corridors], axis=0, return_inverse=True)
        for k in range(len(seen)):
            chance = float(weights[which == k].sum())
            if chance > 0.0:
                row = world.maps[int(np.flatnonzero(which == k)[0])]
                total += chance * self.value(learnt(info, corridors, row), place)
        return total

    def _test(self, info: Info, place: int, number: int) -> float:
        detector = self.world.detectors[number]
        present = self.world.maps[:, self.world.corridor_of(detector)] == 1
        there = float(self.world.weights(info)[present].sum())
        yes = there * detector.right + (1.0 - there) * (1.0 - detector.right)
        total = detector.seconds
        for reading, chance in ((NO, 1.0 - yes), (YES, yes)):
            readings = list(info.readings)
            readings[number] = reading
            if chance > 0.0:
                total += chance * self.value(info._replace(readings=tuple(readings)), place)
        return total

    def _try(self, info: Info, place: int, corridor: int, other: int) -> float:
        """Drive into a corridor that may not be there."""
        world = self.world
        there = float(world.weights(info)[world.maps[:, corridor] == 1].sum())
        total = 0.0
        for level, chance in ((0, 1.0 - there), (PRESENT, there)):
            if chance <= 1e-12:
                continue
            levels = list(info.levels)
            levels[corridor] = level
            after = info._replace(levels=tuple(levels))
            if level == PRESENT:
                beyond = self.value(after, other)
                total += chance * self._drive(after, place, corridor, other, beyond)
            else:
                total += chance * (world.wall_s + self.value(after, place))
        return total

    def _drive(self, info: Info, place: int, corridor: int, other: int, beyond_s: float) -> float:
        """Seconds through a corridor that is there and on, ``beyond_s`` if nobody is met."""
        drive_s, people = float(self.world.corridor_s[corridor]), self.world.encounter
        on_s = drive_s + beyond_s
        if info.met or not people.probability or beyond_s == np.inf:
            return on_s
        met = info._replace(met=True)
        back_s = drive_s + self.value(met, place)
        past_s = drive_s + self.value(met, other)
        total = 0.0
        for aside_s in people.aside_s:
            total += self._react(aside_s, drive_s, past_s + aside_s, back_s)
        q = people.probability
        return (1.0 - q) * on_s + q * total / len(people.aside_s)

    def _react(self, aside_s: float, drive_s: float, past_s: float, back_s: float) -> float:
        if self.rules.reacting is None:
            return min(past_s, back_s)
        return back_s if self.rules.reacting(aside_s, drive_s) else past_s
