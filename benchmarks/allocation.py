"""One processor for all: shared by fixed priorities, or given to decisions by marginal value.

    python -m benchmarks.allocation [--seeds 1:6] [--most 40]

Whole runs of the shipped scenarios with the profile ``huey-1990`` and one processor, which is not
taken from a handler that has begun. Under fixed priorities every decision takes the largest problem
that fits the time until its deadline. By value (Boddy and Dean, IJCAI 1989) it takes what its
performance profile, measured as by ``benchmarks.quality_by_time``, makes it worth, the decisions
that are open together sharing the time. The third way knows what else the processor is for: while
the robot drives each second that it computes is one in which somebody who comes is not reacted to.
The last rows bound what any allocation could gain: a processor for each module, and computing that
costs nothing. Everything is simulated time: the numbers repeat anywhere.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from benchmarks.days import Day, Progress, day, scenario_of, seeds_of
from benchmarks.deliberation import Profile, Wanted, allotted, convex
from benchmarks.quality_by_time import JUDGES, curve
from benchmarks.questions import Questions, asked_in_runs, spread
from benchmarks.shared_processors import HEADER, SCENARIOS, row
from bus.costs import CostModel
from bus.facts import Facts
from bus.messages import AskedPath, AskedSensing
from bus.topics import CLASSIFIER, DECIDER
from bus.turns import Handler, Module, Turn
from modules.reactor.diagram import Settings as Reacting
from scenarios.costs import cost_model
from scenarios.modules import build_module
from scenarios.scenario import Compute

PATH, FIRST, NEXT = "path", "first feature", "next feature"
"""What competes: the first two on the way, the third alone while a detector runs."""

PRICE = 3 / 5782 * Reacting().collision
"""What a second of computing on the way costs: as often as somebody comes in ``aces``, 3 in 5782 s,
times what a collision costs. That an unanswered encounter ends in one is an assumption."""

Profiles = Mapping[str, Profile]


@dataclass(frozen=True)
class Capped(CostModel):
    """The prices of a profile, with at most so many cells for a decision."""

    most: int = 0

    def cells_within(self, kind: str, time_ns: int) -> int:
        """As ever, but no more than the decision was given."""
        return min(super().cells_within(kind, time_ns), self.most)


@dataclass
class ByValue:
    """A module whose decisions take no more than they are given by marginal value."""

    inner: Module
    kind: str
    profiles: Profiles
    price: float
    _until_ns: int = 0
    _wants: str = field(default=PATH)

    @property
    def handlers(self) -> Mapping[str, Handler]:
        """The inner module's, with fewer cells to spend."""
        return {t: partial(self._handle, handler) for t, handler in self.inner.handlers.items()}

    def _handle(self, handler: Handler, said: Any, turn: Turn) -> None:
        if isinstance(said, AskedPath | AskedSensing):
            self._until_ns = said.until_ns
            first = isinstance(said, AskedSensing) and said.action == 0
            self._wants = PATH if isinstance(said, AskedPath) else FIRST if first else NEXT
        given_s = self._given_s((self._until_ns - turn.start_ns) / 1e9)
        cells = turn.costs.cells_within(self.kind, round(given_s * 1e9))
        turn.costs = Capped(turn.costs.profile, turn.costs.rates, turn.costs.extra_ns, cells)
        handler(said, turn)

    def _given_s(self, left_s: float) -> float:
        open_now = (FIRST, PATH) if self._wants == FIRST else (self._wants,)
        wanted = {name: Wanted(self.profiles[name], left_s) for name in open_now}
        return allotted(wanted, 0.0 if self._wants == NEXT else self.price)[self._wants]


def building_by_value(profiles: Profiles, price: float) -> Callable[..., Module]:
    """Builds a run's modules, two of them on an allowance."""
    kinds = {CLASSIFIER: "sensing", DECIDER: "path"}

    def build(name: str, facts: Facts, settings: Mapping[str, Any], seed: int) -> Module:
        module = build_module(name, facts, settings, seed)
        if name not in kinds:
            return module
        return ByValue(module, kinds[name], profiles, price)

    return build


def profiles_of(questions: Questions, most: int) -> dict[str, Profile]:
    """The performance profile of each decision, from questions of whole runs."""
    costs, host = cost_model(Compute(profile="huey-1990")), cost_model(Compute(profile="host"))
    kinds: dict[str, tuple[str, list[Any]]] = {
        PATH: ("path", list(questions.path)),
        FIRST: ("sensing", [one for one in questions.sensing if len(one.belief) == 1]),
        NEXT: ("sensing", [one for one in questions.sensing if len(one.belief) > 1]),
    }
    profiles = {}
    for name, (kind, asked) in kinds.items():
        judges = [JUDGES[kind](one) for one in spread(asked, most)]
        nothing = sum(judge.fixed(0)[1] for judge in judges) / len(judges)
        points = curve(kind, judges, costs, host)
        seconds = [0.0, *(point.seconds for point in points)]
        profiles[name] = convex(seconds, [nothing, *(point.excess_s for point in points)])
    return profiles


@dataclass(frozen=True)
class Way:
    """A way to run: what it is called, its changes, how modules are built."""

    name: str
    changes: tuple[str, ...] = ()
    build: Callable[..., Module] = build_module


def ways(profiles: Profiles) -> list[Way]:
    """The ways that are compared."""
    paper = "modules.decider.model=paper"  # its anytime procedure is what is stopped
    one = ("compute.profile=huey-1990", "compute.processors=1", paper)
    smallest = ("modules.decider.hypotheses=1", "modules.classifier.look_ahead=1")
    return [
        Way("fixed priorities", one),
        Way("smallest problems", (*one, *smallest)),
        Way("by value", one, building_by_value(profiles, 0.0)),
        Way("by value and price", one, building_by_value(profiles, PRICE)),
        Way("one each", ("compute.profile=huey-1990", paper)),
        Way("computing is free", ("compute.profile=free", paper)),
    ]


def days_of(way: Way, scenario: str, seeds: Sequence[int]) -> list[Day]:
    """A run for each seed."""
    return [day(scenario_of(scenario, way.changes, seed), way.build) for seed in seeds]


def print_profiles(profiles: Profiles) -> None:
    print("performance profiles: expected seconds lost by seconds of the computer of 1990")
    for name, profile in profiles.items():
        points = zip(profile.seconds, profile.excess_s, strict=True)
        print(f"{name:>14}: " + ", ".join(f"{s:g} s {e:.4g}" for s, e in points))
    print(f"a second of computing on the way is priced at {PRICE:.2f} s\n")


def main() -> None:
    parser = argparse.ArgumentParser(
        description="One processor shared by fixed priorities or by marginal value.",
        epilog="Example: python -m benchmarks.allocation --seeds 1:6",
    )
    parser.add_argument("--seeds", default="1:6", help="seeds of the runs, A:B (1:6)")
    parser.add_argument("--most", type=int, default=40, help="questions a profile (40)")
    arguments = parser.parse_args()
    seeds = seeds_of(arguments.seeds)
    profiles = profiles_of(asked_in_runs(range(101, 103)), arguments.most)
    print_profiles(profiles)
    compared = ways(profiles)
    progress = Progress(len(SCENARIOS) * len(compared))
    print(HEADER)
    for scenario in SCENARIOS:
        for way in compared:
            found = days_of(way, scenario, seeds)
            print(f"{scenario:>11} {way.name:>21} | {row(found)}", flush=True)
            progress.step(f"{scenario}, {way.name}")


if __name__ == "__main__":
    main()
