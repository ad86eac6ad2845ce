"""Small runs in which one thing is not as it was, for what must find it."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from bus.messages import Message
from bus.turns import Handler, Module, Turn
from scenarios.modules import build_module
from tests.scenarios.runs import LITTLE, log_in_process, scenario_of, script_of

Build = Callable[..., Module]


class _Changed:
    """A module with one of its handlers replaced."""

    def __init__(self, module: Module, topic: str, change: Callable[[Handler], Handler]) -> None:
        self.handlers = {
            name: change(handler) if name == topic else handler
            for name, handler in module.handlers.items()
        }


def mutated(process: str, topic: str, change: Callable[[Handler], Handler]) -> Build:
    """What builds a run's modules, one handler of one of them changed."""

    def build(name: str, *arguments: Any) -> Module:
        module = build_module(name, *arguments)
        return _Changed(module, topic, change) if name == process else module

    return build


def dearer(handler: Handler) -> Handler:
    """A tenth more cells for every piece of work."""

    def run(message: Message, turn: Turn) -> None:
        handler(message, turn)
        for kind, cells in tuple(turn.works):
            turn.work(kind, round(0.1 * cells))

    return run


def drops_one(handler: Handler) -> Handler:
    """The first thing that it says the second time it speaks is lost."""
    spoken = 0

    def run(message: Message, turn: Turn) -> None:
        nonlocal spoken
        handler(message, turn)
        spoken += bool(turn.said)
        if turn.said and spoken == 2:
            del turn.said[0]

    return run


def by_the_wall_clock(handler: Handler) -> Handler:
    """Work that depends on when it is done."""

    def run(message: Message, turn: Turn) -> None:
        turn.work("note", time.perf_counter_ns() % 1_000_003)
        handler(message, turn)

    return run


def little_log(path: Path, build: Build = build_module, **changes: Any) -> Path:
    """The log of a little run: a ring of four corridors, two errands, one person."""
    log_in_process(script_of(scenario_of(LITTLE, **changes)), path, build)
    return path
