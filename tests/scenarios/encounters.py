"""The shipped encounters, drawn anew for each seed, and simple policies to compare with."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable
from typing import Any

import numpy as np

from bus.facts import Facts
from bus.messages import Departure, Message, Ranges, ReactionDecision
from bus.topics import REACTOR, heard_by
from bus.turns import Module, Turn
from scenarios.modules import build_module
from scenarios.scenario import find
from simworld.people import ACTS

Draw = Callable[[dict[str, Any], np.random.Generator], None]


def _somebody(world: dict[str, Any], rng: np.random.Generator, low_m: float, high_m: float) -> None:
    """A person of any pace, on a line so far off the middle, on either side."""
    (person,) = world["person"]
    person["enters"]["ahead_m"] = float(rng.uniform(7.0, 10.0))
    person["walks_m_s"] = float(rng.uniform(0.8, 1.8))
    person["offset_m"] = float(rng.uniform(low_m, high_m) * rng.choice([-1.0, 1.0]))


def _walks_by(world: dict[str, Any], rng: np.random.Generator) -> None:
    _somebody(world, rng, 0.55, 0.75)


def _does_not_yield(world: dict[str, Any], rng: np.random.Generator) -> None:
    _somebody(world, rng, 0.0, 0.5)


def _two(world: dict[str, Any], rng: np.random.Generator, low_m: float, high_m: float) -> None:
    """Two of one pace, on both sides, one so far behind the other."""
    ahead_m, pace_m_s = float(rng.uniform(6.0, 8.0)), float(rng.uniform(0.8, 1.6))
    for k, person in enumerate(world["person"]):
        person["enters"]["ahead_m"] = ahead_m + k * float(rng.uniform(low_m, high_m))
        person["walks_m_s"] = pace_m_s
        person["offset_m"] = math.copysign(float(rng.uniform(0.55, 0.7)), person["offset_m"])


def _two_apart(world: dict[str, Any], rng: np.random.Generator) -> None:
    _two(world, rng, 1.0, 3.0)


def _two_abreast(world: dict[str, Any], rng: np.random.Generator) -> None:
    _two(world, rng, 0.0, 0.4)


def _box(world: dict[str, Any], rng: np.random.Generator) -> None:
    (box,) = world["person"]
    box["enters"]["ahead_m"] = float(rng.uniform(2.0, 6.0))
    box["offset_m"] = float(rng.uniform(-0.4, 0.4))
    box["radius_m"] = float(rng.uniform(0.15, 0.25))


def _door(world: dict[str, Any], rng: np.random.Generator) -> None:
    (door,) = world["door"]
    door["enters"]["ahead_m"] = float(rng.uniform(0.9, 2.0))
    door["side"] = str(rng.choice(["left", "right"]))
    door["stays_s"] = float(rng.uniform(5.0, 30.0))


def _echo(world: dict[str, Any], rng: np.random.Generator) -> None:
    (echo,) = world["false_echo"]
    echo["lasts_s"] = float(rng.uniform(4.0, 20.0))
    echo["share"] = float(rng.uniform(0.2, 0.9))


KINDS: dict[str, tuple[str, Draw]] = {
    "person walks by": ("person-walks-by", _walks_by),
    "person does not yield": ("person-does-not-yield", _does_not_yield),
    "two from both sides": ("two-from-both-sides", _two_apart),
    "the same, abreast": ("two-from-both-sides", _two_abreast),
    "box put down": ("box-put-down", _box),
    "door opens": ("door-opens", _door),
    "false echo": ("false-echo", _echo),
}
"""Kinds of encounter: the shipped scenario, and what varies in it."""


def drawn(kind: str, seed: int) -> dict[str, Any]:
    """The table of an encounter of a kind, drawn with a seed; it ends on arrival or stuck."""
    name, vary = KINDS[kind]
    table = tomllib.loads(find(name).read_text(encoding="utf-8"))
    world = table["world"]
    vary(world, np.random.default_rng([seed, 23]))
    world["patience_s"] = 120.0
    del table["errand"], table["expect"]
    return {**table, "seed": seed}


class Stops:
    """A reactor that halts while something ahead is nearer than it should be.

    That is within 4 m, and nearer by 0.3 m than what was heard at the ping before, less the way
    driven; or within 1 m. It goes on when that has not been so for three seconds.
    """

    NEAR_M, BEFORE_M, CLOSER_M, CLEAR_S = 1.0, 4.0, 0.3, 3.0

    def __init__(self, _facts: Facts) -> None:
        self.handlers = {topic.name: self._hear for topic in heard_by(REACTOR)}
        self._before_m = math.inf
        self._alarmed_s = -math.inf
        self._act = "continue"

    def _hear(self, said: Message, turn: Turn) -> None:
        turn.work("note", 1)
        if isinstance(said, Departure):
            self._act, self._before_m, self._alarmed_s = "continue", math.inf, -math.inf
        if isinstance(said, Ranges):
            self._ranges(said, turn)

    def _ranges(self, said: Ranges, turn: Turn) -> None:
        ahead_m = float(np.nan_to_num(said.mean_m[[0, 1, -1]], nan=math.inf).min())
        nearer = ahead_m < min(self.BEFORE_M, self._before_m - self.CLOSER_M)
        now_s = said.fired_ns / 1e9
        if nearer or ahead_m < self.NEAR_M:
            self._alarmed_s = now_s
        self._before_m = ahead_m
        act = "stop" if now_s - self._alarmed_s < self.CLEAR_S else "continue"
        if act != self._act:
            self._act = act
            turn.say(ReactionDecision(act, np.zeros(len(ACTS)), 0.0, said.fired_ns, 0.0))


def replacing(kind: Callable[[Facts], Module]) -> Callable[..., Module]:
    """What builds a run's modules, with another reactor."""
    return _Replacing(kind)


class _Replacing:
    """Can be sent to another process, as a closure cannot."""

    def __init__(self, kind: Callable[[Facts], Module]) -> None:
        self._kind = kind

    def __call__(self, name: str, facts: Facts, *arguments: Any) -> Module:
        return self._kind(facts) if name == REACTOR else build_module(name, facts, *arguments)
