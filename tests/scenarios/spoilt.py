"""Modules whose work depends on what must not matter. ``python -m tests.scenarios.spoilt HOW LOG``.

Writes the log of a little run in which one module is as HOW says, one of :data:`HOWS`.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from bus.messages import Message
from bus.topics import GEOGRAPHER
from bus.turns import Handler, Module, Turn
from scenarios.modules import build_module
from tests.scenarios.runs import LITTLE, log_in_process, scenario_of, script_of

ROOT = Path(__file__).resolve().parents[2]
DIRECTIONS = {"north", "east", "south", "west"}


def by_the_wall_clock() -> int:
    return time.perf_counter_ns() % 1_000_003


def by_the_order_of_a_set() -> int:
    order = 0
    for name in DIRECTIONS:  # differs from process to process unless PYTHONHASHSEED is set
        order = 10 * order + len(name) + ord(name[0])
    return order


def by_nothing() -> int:
    return 1


HOWS = {"wall clock": by_the_wall_clock, "set": by_the_order_of_a_set, "sound": by_nothing}


class Spoilt:
    """A module that does so many cells of work more with every message."""

    def __init__(self, module: Module, cells: Callable[[], int]) -> None:
        self._cells = cells
        self.handlers: Mapping[str, Handler] = {
            topic: self._spoilt(handler) for topic, handler in module.handlers.items()
        }

    def _spoilt(self, handler: Handler) -> Handler:
        def run(message: Message, turn: Turn) -> None:
            turn.work("note", self._cells())
            handler(message, turn)

        return run


def build(how: str) -> Callable[..., Module]:
    """What builds a run's modules, the geographer spoilt."""

    def built(name: str, *arguments: Any) -> Module:
        module = build_module(name, *arguments)
        return Spoilt(module, HOWS[how]) if name == GEOGRAPHER else module

    return built


def log_in_a_process(how: str, hash_seed: int, log: Path) -> bytes:
    """The bytes of the log of such a run, in a process in which sets have an order of their own."""
    environment = {**os.environ, "PYTHONHASHSEED": str(hash_seed)}
    command = [sys.executable, "-m", "tests.scenarios.spoilt", how, str(log)]
    subprocess.run(command, env=environment, cwd=ROOT, check=True)
    return log.read_bytes()


if __name__ == "__main__":
    log_in_process(script_of(scenario_of(LITTLE)), Path(sys.argv[2]), build(sys.argv[1]))
