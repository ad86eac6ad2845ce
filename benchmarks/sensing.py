"""Which detector next: look-ahead beside exhaustive testing, plain orders and the optimal policy.

    python -m benchmarks.sensing [--wrong-type-s SECONDS] [--runs SEEDS]

A visit to a junction of each of the 8 types that can be entered, all as probable
(:mod:`benchmarks.sensing_policies`). Nothing is drawn but the random orders. The optimal policy is
found by dynamic programming over the 3^14 states of the fourteen detectors that tell types apart;
orders that do not choose stop where the optimal policy would stop. Beside them the fewest tests
with which any policy is right almost as often as exhaustive testing. Then whole runs of ``aces``:
conclusions against true types.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.sensing_policies import LESS, Visits, least_tests, policies, problem
from bus.features import USUAL
from bus.grid import NORTH, Grid, type_name
from bus.messages import (
    Arrival,
    DeadlineMissed,
    Reading,
    SensingDecision,
    TrueBuilding,
    TruePose,
)
from modules.classifier.choose import STOP, WRONG_TYPE_S
from modules.classifier.geometry import enterable
from tests.scenarios.runs import everything_said, of_kind, shipped

ACCURACIES = (0.6, 0.7, 0.8, 0.9, 0.95, 0.99)
SHOWN_BY_TYPE = 0.9


@dataclass(frozen=True, eq=False)
class Found:
    """All policies with detectors of one accuracy, the optimal one first, exhaustive last.

    ``least`` is the fewest tests of any policy that is right but for LESS as often as the last.
    """

    named: list[tuple[str, Visits]]
    least: float


def of_accuracy(accuracy: float, wrong_s: float) -> Found:
    """What every policy does with detectors of one accuracy."""
    given = problem(accuracy, wrong_s)
    named = list(policies(given))
    return Found(named, least_tests(given, float(named[-1][1].right.mean()) - LESS))


@dataclass(frozen=True)
class Run:
    """Conclusions of a whole run, and how many were right."""

    visits: int
    right: int
    tests: int
    late: int


def run(seed: int) -> Run:
    """One run of ``aces``: what was concluded at each visit against the true type."""
    said = everything_said(shipped("aces", seed=seed).scenario)
    (building,) = of_kind(said, TrueBuilding)
    grid = Grid(len(building.columns_m), len(building.rows_m))
    types = grid.junction_types(building.corridors[None, :])[0]
    evidence = {read.action: read.evidence for read in of_kind(said, Reading)}
    concluded = {}
    for decision in of_kind(said, SensingDecision):
        outcome = evidence.get(decision.action, 0)
        if decision.next_detector[outcome] == STOP:
            concluded[decision.visit] = int(decision.concluded[outcome])
    arrived = [arrival.visit for arrival in of_kind(said, Arrival)]
    places = [pose.place for pose in of_kind(said, TruePose)]
    right = sum(concluded.get(v) == types[at] for v, at in zip(arrived, places, strict=True))
    late = len(of_kind(said, DeadlineMissed))
    return Run(len(arrived), right, len(evidence), late)


def show_accuracies(console: Console, found: list[Found], wrong_s: float) -> None:
    """A row for each policy, a column for each accuracy."""
    table = Table(
        title="share of right conclusions / tests / seconds a visit / cost against the optimal"
    )
    table.add_column("policy")
    for accuracy in ACCURACIES:
        table.add_column(f"{accuracy:g}", no_wrap=True)
    for k, (name, _) in enumerate(found[0].named):
        cells = []
        for column in found:
            this, least_s = column.named[k][1], column.named[0][1].cost_s(wrong_s)
            cells.append(
                f"{this.right.mean():.4f} / {this.tests.mean():.1f} / {this.seconds.mean():.0f}"
                f" / {this.cost_s(wrong_s) / least_s:.3f}"
            )
        table.add_row(name, *cells)
    console.print(table)


def show_tests(console: Console, found: list[Found]) -> None:
    """How many tests are needed at all, beside those of look-ahead."""
    table = Table(title="tests a visit, and share of the tests of exhaustive testing")
    table.add_column("")
    for accuracy in ACCURACIES:
        table.add_column(f"{accuracy:g}", no_wrap=True)
    every = [column.named[-1][1].tests.mean() for column in found]
    rows = {
        f"fewest of any policy, right at most {LESS:g} less": [c.least for c in found],
        "look-ahead 3": [c.named[1][1].tests.mean() for c in found],
    }
    for name, tests in rows.items():
        shares = (
            f"{n:.2f} / {n / of:.0%} ({n / USUAL.detectors:.0%})"
            for n, of in zip(tests, every, strict=True)
        )
        table.add_row(name, *shares)
    console.print(table)
    console.print(f"in brackets: of all {USUAL.detectors} detectors")


def show_types(console: Console, found: list[tuple[str, Visits]]) -> None:
    """A row for each true type: the optimal policy and the longest look-ahead."""
    table = Table(title=f"by true type, accuracy {SHOWN_BY_TYPE:g}: right / tests / seconds")
    for name in ("entered northward", *(name for name, _ in found[:2]), found[-1][0]):
        table.add_column(name)
    for row, junction_type in enumerate(np.flatnonzero(enterable(NORTH)).tolist()):
        shown = [found[0][1], found[1][1], found[-1][1]]
        cells = [f"{v.right[row]:.4f} / {v.tests[row]:.1f} / {v.seconds[row]:.0f}" for v in shown]
        table.add_row(type_name(junction_type), *cells)
    console.print(table)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--wrong-type-s", type=float, default=WRONG_TYPE_S)
    parser.add_argument("--runs", type=int, default=5, help="seeds of whole runs, 0 for none")
    given = parser.parse_args()
    console = Console(width=200)
    with ProcessPoolExecutor() as pool:
        found = list(pool.map(partial(of_accuracy, wrong_s=given.wrong_type_s), ACCURACIES))
        show_accuracies(console, found, given.wrong_type_s)
        show_tests(console, found)
        show_types(console, found[ACCURACIES.index(SHOWN_BY_TYPE)].named)
        runs = list(pool.map(run, range(1, given.runs + 1)))
    if runs:
        visited = sum(r.visits for r in runs)
        console.print(
            f"aces, {len(runs)} runs: {sum(r.right for r in runs)} of {visited} visits concluded "
            f"right, {sum(r.tests for r in runs) / visited:.2f} tests a visit, "
            f"{sum(r.late for r in runs)} decisions late"
        )


if __name__ == "__main__":
    main()
