"""How whole runs of a shipped scenario end, for many seeds at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from bus.messages import (
    LedgerEntry,
    MapBelief,
    Message,
    RunEnded,
    TrueBuilding,
    TrueEncounter,
    TrueErrand,
)
from bus.topics import REACTOR, heard_by
from bus.turns import Module, Turn
from scenarios.modules import build_module
from tests.scenarios.runs import everything_said, of_kind, shipped


@dataclass(frozen=True)
class Outcome:
    """The end of one run. ``true_map`` is the last belief's probability of the true map."""

    seed: int
    reason: str
    errands: int
    true_map: float
    most_probable: bool
    late: tuple[str, ...]
    collisions: int


class Unmoved:
    """A reactor that hears everything and lets the robot drive on."""

    def __init__(self) -> None:
        self.handlers = {topic.name: self._hear for topic in heard_by(REACTOR)}

    def _hear(self, _said: Message, turn: Turn) -> None:
        turn.work("note", 1)


def unmoved(name: str, *arguments: Any) -> Module:
    """What builds a run's modules, with a reactor that never reacts."""
    return Unmoved() if name == REACTOR else build_module(name, *arguments)


def probability_of_truth(belief: MapBelief, building: TrueBuilding) -> float:
    """The true map's probability; 0 where it is not among the maps that the belief lists."""
    rows = np.flatnonzero((belief.maps == building.corridors).all(axis=1))
    return float(np.exp(belief.log_probability[rows[0]])) if len(rows) else 0.0


def outcome(
    name: str, changes: tuple[str, ...], build: Callable[..., Module], seed: int
) -> Outcome:
    """Run a shipped scenario with a seed and say how it ended."""
    said = everything_said(shipped(name, *changes, seed=seed).scenario, build)
    belief, (building,) = of_kind(said, MapBelief)[-1], of_kind(said, TrueBuilding)
    true_map = probability_of_truth(belief, building)
    return Outcome(
        seed,
        of_kind(said, RunEnded)[-1].reason,
        len(of_kind(said, TrueErrand)),
        true_map,
        bool(true_map == np.exp(belief.log_probability.max())),
        tuple(f"{e.kind} {e.visit}: {e.cause}" for e in of_kind(said, LedgerEntry) if e.cause),
        sum(e.collided for e in of_kind(said, TrueEncounter)),
    )


def outcomes(
    name: str,
    seeds: Iterable[int],
    *changes: str,
    build: Callable[..., Module] = build_module,
) -> list[Outcome]:
    """The outcome for each seed, in order, found by two processes."""
    with ProcessPoolExecutor(2) as pool:
        return list(pool.map(partial(outcome, name, changes, build), seeds))
