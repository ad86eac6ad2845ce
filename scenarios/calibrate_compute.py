"""What this machine takes for each kind of work: the compute profile ``host``.

Runs a scenario in one process with a stopwatch around every handler, and fits for each kind of
work so much to begin with and so much a cell, none of it negative. The result is committed as
numbers, so that runs repeat on any machine.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from bus.costs import KINDS
from bus.messages import Message
from bus.turns import Handler, Module, Turn
from scenarios.draw import draw
from scenarios.in_process import run_in_process
from scenarios.modules import build_module
from scenarios.scenario import Scenario


@dataclass(frozen=True)
class Timed:
    """One handler's wall time and the work it reported."""

    seconds: float
    work: tuple[tuple[str, int], ...]


class Stopwatch:
    """A module whose handlers are timed."""

    def __init__(self, module: Module, note: Callable[[Timed], None]) -> None:
        self._note = note
        self.handlers: Mapping[str, Handler] = {
            topic: self._timed(handler) for topic, handler in module.handlers.items()
        }

    def _timed(self, handler: Handler) -> Handler:
        def run(message: Message, turn: Turn) -> None:
            began = time.perf_counter()
            handler(message, turn)
            self._note(Timed(time.perf_counter() - began, tuple(turn.works)))

        return run


def calibrate_compute(scenario: Scenario, name: str) -> str:
    """The text of the profile's file, measured on this machine with a scenario."""
    timed: list[Timed] = []

    def build(module: str, *arguments: Any) -> Module:
        return Stopwatch(build_module(module, *arguments), timed.append)

    drawn = draw(scenario, name)
    run_in_process(scenario, drawn, lambda _: None, build)  # compiles what is compiled
    timed.clear()
    run_in_process(scenario, drawn, lambda _: None, build)
    rates = fitted(timed)
    whole = {"made_by": "waywiser calibrate compute", "handlers": len(timed), "rates": rates}
    return json.dumps(whole, indent=2) + "\n"


def fitted(timed: list[Timed]) -> dict[str, dict[str, float]]:
    """Least squares without negative prices: nanoseconds to begin and a cell, by kind."""
    design = np.zeros((len(timed), 2 * len(KINDS)))
    for row, one in enumerate(timed):
        for kind, cells in one.work:
            column = 2 * KINDS.index(kind)
            design[row, column] += 1.0
            design[row, column + 1] += cells
    seconds = np.array([one.seconds for one in timed])
    typical = _without_outliers(design, seconds)
    scale = np.maximum(design[typical].max(axis=0), 1.0)
    prices, _ = nnls(design[typical] / scale, seconds[typical] * 1e9)
    prices = prices / scale
    return {
        kind: {"fixed_ns": round(prices[2 * k]), "cell_ns": round(float(prices[2 * k + 1]), 2)}
        for k, kind in enumerate(KINDS)
    }


def _without_outliers(
    design: NDArray[np.float64], seconds: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Leaves out the slowest twentieth of each mix of work: the machine was busy elsewhere."""
    keep = np.ones(len(seconds), dtype=np.bool_)
    mixes, index = np.unique(design[:, ::2], axis=0, return_inverse=True)
    for mix in range(len(mixes)):
        of_mix = index == mix
        keep &= ~of_mix | (seconds <= np.quantile(seconds[of_mix], 0.95))
    return keep
