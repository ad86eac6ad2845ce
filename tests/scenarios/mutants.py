"""More that may be wrong in a little run: whole modules, the order of things, deliveries."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import msgspec
import pytest

from bus.coordinator import Coordinator, Grant, Said
from bus.messages import Message, PathDecision
from bus.topics import CLASSIFIER, PRIORITY, REACTOR, SENSOR
from bus.turns import Handler, Module, Turn
from scenarios import in_process
from scenarios.modules import build_module

AfterTurn = Callable[[Turn], None]
"""What a mutant does when a handler has done its work."""


class _Mutant:
    def __init__(self, module: Module, after: AfterTurn) -> None:
        self.handlers: Mapping[str, Handler] = {
            topic: _mutated(handler, after) for topic, handler in module.handlers.items()
        }


def _mutated(handler: Handler, after: AfterTurn) -> Handler:
    def run(message: Message, turn: Turn) -> None:
        handler(message, turn)
        after(turn)

    return run


def mutant(which: str, after: Callable[[], AfterTurn]) -> Callable[..., Module]:
    """What builds a run's modules, one of them mutated; ``after`` makes its state."""

    def built(name: str, *arguments: Any) -> Module:
        module = build_module(name, *arguments)
        return _Mutant(module, after()) if name == which else module

    return built


def costlier() -> AfterTurn:
    """Every handler costs 10 % more."""

    def after(turn: Turn) -> None:
        turn.cost_ns += turn.cost_ns // 10

    return after


def dropping(number: int) -> Callable[[], AfterTurn]:
    """Of all that would be said, one message is not."""

    def made() -> AfterTurn:
        count = 0

        def after(turn: Turn) -> None:
            nonlocal count
            before, count = count, count + len(turn.said)
            if before <= number < count:
                del turn.said[number - before]

        return after

    return made


def repeating(number: int) -> Callable[[], AfterTurn]:
    """One message is said twice."""

    def made() -> AfterTurn:
        count = 0

        def after(turn: Turn) -> None:
            nonlocal count
            before, count = count, count + len(turn.said)
            if before <= number < count:
                turn.said.insert(number - before, turn.said[number - before])

        return after

    return made


def contrary() -> AfterTurn:
    """The decider takes the other way where a junction has all four."""

    def after(turn: Turn) -> None:
        for k, (message, parents) in enumerate(turn.said):
            if isinstance(message, PathDecision):
                direction = message.direction.copy()
                direction[15] = {1: 2, 2: 4, 4: 8, 8: 1}.get(int(direction[15]), 1)
                turn.said[k] = (msgspec.structs.replace(message, direction=direction), parents)

    return after


def talkative() -> AfterTurn:
    """Every handler prints something."""

    def after(_turn: Turn) -> None:
        print("here I am")

    return after


def failing(number: int) -> Callable[[], AfterTurn]:
    """A handler raises an exception."""

    def made() -> AfterTurn:
        count = 0

        def after(turn: Turn) -> None:
            nonlocal count
            count += 1
            if count == number:
                raise RuntimeError(f"no more at {turn.start_ns}")

        return after

    return made


class SwappedCoordinator(Coordinator):
    """The sensor comes before the reactor where they must queue."""

    def __init__(self, priority: Mapping[str, int], *rest: Any, **named: Any) -> None:
        swapped = {**priority, SENSOR: priority[REACTOR], REACTOR: priority[SENSOR]}
        super().__init__(swapped, *rest, **named)

    def living(self) -> list[str]:
        return [name for name in PRIORITY if self.alive(name)]


class DeafCoordinator(Coordinator):
    """One message, the third of its topic, is not delivered to anybody."""

    lost_topic = "prior/junction"
    count = 0

    def said(self, said: Said) -> None:
        if said.topic == self.lost_topic:
            self.count += 1
            if self.count == 3:
                said = replace(said, topic="truth/pose")  # which nobody hears
        super().said(said)


class ContraryCoordinator(Coordinator):
    """The first turn of the classifier with several messages is handled in the opposite order."""

    turns = 0

    def grants(self, now_ns: int) -> list[Grant]:
        return [self._turned(grant) for grant in super().grants(now_ns)]

    def _turned(self, grant: Grant) -> Grant:
        if grant.process != CLASSIFIER or len(grant.messages) < 2:
            return grant
        self.turns += 1
        if self.turns != 1:
            return grant
        turned = replace(grant, messages=grant.messages[::-1])
        self._processes[CLASSIFIER].granted = turned
        return turned


def coordinated_by(monkeypatch: pytest.MonkeyPatch, kind: type[Coordinator]) -> None:
    """Runs in this process have another coordinator from now on."""
    monkeypatch.setattr(in_process, "Coordinator", kind)
