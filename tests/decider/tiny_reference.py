"""The joint problem of a tiny world in other ways: step by step, and as an influence diagram."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator
from itertools import product
from typing import Any

import numpy as np

from benchmarks.tiny_world import ABSENT, PRESENT, UNKNOWN, UNREAD, Detector, Info, TinyWorld
from bus.grid import Grid

State = tuple[Info, int]
Outcome = list[tuple[float, State]]
Action = tuple[float, Outcome]
"""Seconds, and where it may lead with which probability."""


def value_iteration(world: TinyWorld) -> float:
    """Least expected seconds, over single steps from one intersection to the next."""
    start = settled(world, world.nothing, world.start)
    actions: dict[State, list[Action]] = {}
    waiting = [s for _, s in start]
    while waiting:
        state = waiting.pop()
        if state not in actions and state[0].leg < len(world.goals):
            actions[state] = list(choices(world, state))
            waiting += [s for _, outcome in actions[state] for _, s in outcome]
    values = dict.fromkeys(actions, 0.0)
    change = 1.0
    while change > 1e-11:
        change = 0.0
        for state, able in actions.items():
            best = min(s + sum(p * values.get(o, 0.0) for p, o in after) for s, after in able)
            change, values[state] = max(change, abs(best - values[state])), best
    return sum(p * values[s] for p, s in start)


def chances(world: TinyWorld, info: Info) -> dict[tuple[int, ...], float]:
    """P(map | what is known), map by map."""
    found = {}
    for row in world.maps.tolist():
        weight = float(
            all(v == UNKNOWN or row[c] == (v == PRESENT) for c, v in enumerate(info.levels))
        )
        for detector, reading in zip(world.detectors, info.readings, strict=True):
            if reading != UNREAD:
                same = row[world.corridor_of(detector)] == reading
                weight *= detector.right if same else 1 - detector.right
        found[tuple(row)] = weight
    total = sum(found.values())
    return {row: weight / total for row, weight in found.items()}


def settled(world: TinyWorld, info: Info, place: int) -> Outcome:
    """Be at a place: see what can be seen, and if it is the goal, turn to the next."""
    outcomes: dict[State, float] = {}
    for row, p in chances(world, info).items():
        levels = list(info.levels)
        if place not in world.noisy:
            for c, _ in world.moves(place):
                levels[c] = PRESENT if row[c] else ABSENT
        leg = info.leg
        while leg < len(world.goals) and world.goals[leg] == place:
            leg += 1
        state = (info._replace(levels=tuple(levels), leg=leg), place)
        outcomes[state] = outcomes.get(state, 0.0) + p
    return [(p, s) for s, p in outcomes.items() if p > 0]


def choices(world: TinyWorld, state: State) -> Iterator[Action]:
    """Every test that may be run and every corridor that may be driven into."""
    info, place = state
    for k, detector in enumerate(world.detectors):
        if detector.place == place and info.readings[k] == UNREAD:
            yield detector.seconds, tested(world, state, k)
    for corridor, other in world.moves(place):
        if info.levels[corridor] != ABSENT:
            yield driven(world, state, corridor, other)


def tested(world: TinyWorld, state: State, k: int) -> Outcome:
    info, place = state
    detector, yes = world.detectors[k], 0.0
    for row, p in chances(world, info).items():
        there = row[world.corridor_of(detector)]
        yes += p * (detector.right if there else 1 - detector.right)
    after = []
    for reading, p in ((0, 1 - yes), (1, yes)):
        readings = (*info.readings[:k], reading, *info.readings[k + 1 :])
        after.append((p, (info._replace(readings=readings), place)))
    return after


def driven(world: TinyWorld, state: State, corridor: int, other: int) -> Action:
    """Nobody is met here: worlds with people are checked by other tests."""
    info, place = state
    there = sum(p for row, p in chances(world, info).items() if row[corridor])
    levels = list(info.levels)
    levels[corridor] = PRESENT
    outcome = []
    if there > 0.0:
        onward = settled(world, info._replace(levels=tuple(levels)), other)
        outcome = [(there * p, s) for p, s in onward]
    seconds = there * float(world.corridor_s[corridor])
    if there < 1.0 - 1e-12:
        levels[corridor] = ABSENT
        outcome.append((1 - there, (info._replace(levels=tuple(levels)), place)))
        seconds += (1 - there) * world.wall_s
    return seconds, outcome


def first_way_s(world: TinyWorld, row: list[int], north_first: bool) -> float:
    """Seconds from 0 to 3 on a 2 x 2 grid by one way first and the other if that fails."""
    n, e = (2, 1), (0, 3)  # the corridors of the two ways
    seconds = 0.0
    for first, second in (n, e) if north_first else (e, n):
        if not row[first]:
            seconds += world.wall_s
        elif not row[second]:
            seconds += 2 * float(world.corridor_s[first])
        else:
            return seconds + float(world.corridor_s[first] + world.corridor_s[second])
    raise AssertionError("no way")


def policies(world: TinyWorld) -> Iterator[Callable[[list[int], tuple[int, ...]], float]]:
    """Every plan of up to two tests and a way: seconds by map and by what each test would say."""
    for first in (-1, 0, 1):
        for seconds in product((-1, 0, 1), repeat=2):
            if first >= 0 and first in seconds:
                continue
            for ways in product((True, False), repeat=4):
                yield policy(world, first, seconds, ways)


def policy(
    world: TinyWorld, first: int, seconds: tuple[int, ...], ways: tuple[bool, ...]
) -> Callable[[list[int], tuple[int, ...]], float]:
    def cost(row: list[int], says: tuple[int, ...]) -> float:
        heard = says[first] if first >= 0 else 0
        second = seconds[heard]
        again = says[second] if second >= 0 else 0
        spent = sum(world.detectors[k].seconds for k in (first, second) if k >= 0)
        return spent + first_way_s(world, row, ways[2 * heard + again])

    return cost


def best_policy_s(world: TinyWorld) -> float:
    """The least expected seconds of any of the policies, one after the other."""

    def expected(cost: Callable[[list[int], tuple[int, ...]], float]) -> float:
        total = 0.0
        for row in world.maps.tolist():
            for says in product((0, 1), repeat=2):
                p = 1 / len(world.maps)
                for detector, said in zip(world.detectors, says, strict=True):
                    same = row[world.corridor_of(detector)] == said
                    p *= detector.right if same else 1 - detector.right
                total += p * cost(row, says)
        return total

    return min(expected(cost) for cost in policies(world))


def influence_diagram_s(world: TinyWorld) -> float:
    """The same problem as an influence diagram, solved by pyAgrum."""
    gum: Any = importlib.import_module("pyagrum")
    diagram = gum.InfluenceDiagram()
    diagram.addChanceNode(gum.LabelizedVariable("map", "", len(world.maps)))
    for name, labels in (("test1", 3), ("test2", 3), ("way", 2)):
        diagram.addDecisionNode(gum.LabelizedVariable(name, "", labels))
    for name in ("heard1", "heard2"):
        diagram.addChanceNode(gum.LabelizedVariable(name, "", 3))
    for name in ("time1", "time2", "drive"):
        diagram.addUtilityNode(gum.LabelizedVariable(name, "", 1))
    for parent, child in (
        ("map", "heard1"), ("test1", "heard1"), ("map", "heard2"), ("test2", "heard2"),
        ("heard1", "test2"), ("test1", "test2"), ("heard1", "way"), ("heard2", "way"),
        ("test1", "way"), ("test2", "way"), ("test1", "time1"), ("test1", "time2"),
        ("test2", "time2"), ("map", "drive"), ("way", "drive"),
    ):  # fmt: skip
        diagram.addArc(parent, child)
    fill_chances(diagram, world)
    fill_times(diagram, world)
    solver = gum.ShaferShenoyLIMIDInference(diagram)
    solver.addNoForgettingAssumption(["test1", "test2", "way"])
    solver.makeInference()
    return -float(solver.MEU()["mean"])


def fill_chances(diagram: Any, world: TinyWorld) -> None:
    """P(map), and what a test says: 0 for none run, 1 for no, 2 for yes."""
    diagram.cpt("map").fillWith([1 / len(world.maps)] * len(world.maps))
    for k, (j, row), test in product("12", enumerate(world.maps.tolist()), range(3)):
        told = [1.0, 0.0, 0.0]
        if test:
            detector = world.detectors[test - 1]
            there = row[world.corridor_of(detector)]
            yes = detector.right if there else 1 - detector.right
            told = [0.0, 1 - yes, yes]
        diagram.cpt("heard" + k)[{"map": j, "test" + k: test}] = told


def fill_times(diagram: Any, world: TinyWorld) -> None:
    """Minus the seconds; no test twice."""
    times = [0.0] + [d.seconds for d in world.detectors]
    for a, b in product(range(3), repeat=2):
        diagram.utility("time1")[{"test1": a}] = [-times[a]]
        again = 1e6 if a == b and a else times[b]
        diagram.utility("time2")[{"test1": a, "test2": b}] = [-again]
    for (j, row), way in product(enumerate(world.maps.tolist()), range(2)):
        diagram.utility("drive")[{"map": j, "way": way}] = [-first_way_s(world, row, way == 0)]


def tiny(seed: int, goals: tuple[int, ...], wall_s: float = 60.0) -> TinyWorld:
    """A 2 x 2 world that starts at a junction with two cheap tests."""
    corridor_s = np.random.default_rng(seed).uniform(100, 300, 4)
    tests = (Detector(0, 0, 8.0, 0.8), Detector(0, 1, 11.0, 0.9))
    return TinyWorld(Grid(2, 2), corridor_s, 0, goals, tests, wall_s)
