"""Collisions and seconds lost in encounters: the reactor, always-stop, and never-react.

    python -m benchmarks.encounters [--encounters N] [--policy NAME]... [--kind NAME]...

Each of the shipped encounter scenarios is run over and over, whole system, in one process: with
another line, speed, distance or side each time, drawn from a seed. ``always stops`` halts the
robot while any of the three transducers that look ahead hears something within 4 m that is nearer
than it should be, and for three seconds after; ``never reacts`` drives on. A run whose robot
comes no further for two minutes counts as stuck; seconds lost are those of the runs that are not.
Everything is simulated time, so the numbers repeat on any machine.

    python -m benchmarks.encounters --plan MAP.yaml [--seeds A:B]

runs ``aces``, with its people, among the echoes of the floor plan of the real building instead.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy import stats

from bus.messages import Arrival, LedgerEntry, RunEnded, TrueEncounter
from bus.turns import Module
from scenarios.modules import build_module
from scenarios.scenario import check
from tests.scenarios.encounters import KINDS, Stops, drawn, replacing
from tests.scenarios.outcomes import unmoved
from tests.scenarios.runs import everything_said, of_kind, shipped

POLICIES: dict[str, Callable[..., Module]] = {
    "the reactor": build_module,
    "always stops": replacing(Stops),
    "never reacts": unmoved,
}


@dataclass(frozen=True)
class Result:
    """One encounter: whether anybody was touched, seconds lost, whether the robot is stuck."""

    touched: bool
    lost_s: float
    stuck: bool


def run(kind: str, policy: str, seed: int) -> Result:
    """One encounter of a kind, by a policy."""
    table = drawn(kind, seed)
    said = everything_said(check(table, kind), POLICIES[policy])
    reason = of_kind(said, RunEnded)[-1].reason
    touched = any(met.collided for met in of_kind(said, TrueEncounter))
    arrivals = of_kind(said, Arrival)
    driven_s = table["world"]["start"]["ahead_m"] / table["world"]["speed_m_s"]
    lost_s = arrivals[0].drive_s - driven_s if arrivals else float("nan")
    return Result(touched, lost_s, reason == "stuck")


@dataclass(frozen=True)
class Day:
    """One run of ``aces`` on a floor plan."""

    seed: int
    reason: str
    ended_s: float
    met: int
    touched: int
    late: int


def day(plan: Path, seed: int) -> Day:
    """Run it."""
    said = everything_said(shipped("aces", f"world.floor_plan={plan}", seed=seed).scenario)
    met = of_kind(said, TrueEncounter)
    return Day(
        seed,
        of_kind(said, RunEnded)[-1].reason,
        said[-1].said_ns / 1e9,
        len(met),
        sum(one.collided for one in met),
        sum(bool(entry.cause) for entry in of_kind(said, LedgerEntry)),
    )


def days(plan: Path, seeds: Sequence[int], jobs: int | None) -> Table:
    """A row for each day."""
    table = Table("seed", "ends", "after s", "met", "touched", "decisions late", title=str(plan))
    with ProcessPoolExecutor(jobs) as pool:
        for one in pool.map(partial(day, plan), seeds):
            counts = (one.met, one.touched, one.late)
            table.add_row(str(one.seed), one.reason, f"{one.ended_s:.0f}", *map(str, counts))
    return table


def per_thousand(hits: int, of: int) -> str:
    """A rate with its 95 % interval (Clopper and Pearson)."""
    low, high = stats.binomtest(hits, of).proportion_ci(0.95)
    return f"{1000 * hits / of:.0f} ({1000 * low:.0f} - {1000 * high:.0f})"


def mean(values: Sequence[float]) -> str:
    """A mean with its 95 % interval."""
    if not values:
        return "-"
    spread = 1.96 * float(np.std(values)) / len(values) ** 0.5
    return f"{np.mean(values):.1f} ± {spread:.1f}"


def row(kind: str, policy: str, results: Sequence[Result]) -> list[str]:
    """One row of the table."""
    through = [one.lost_s for one in results if not one.stuck]
    return [
        kind,
        policy,
        per_thousand(sum(one.touched for one in results), len(results)),
        mean(through),
        str(sum(one.stuck for one in results)),
    ]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--encounters", type=int, default=200, help="of each kind and policy")
    parser.add_argument("--policy", action="append", choices=list(POLICIES))
    parser.add_argument("--kind", action="append", choices=list(KINDS))
    parser.add_argument("--jobs", type=int, help="processes at once; all processors by default")
    parser.add_argument("--plan", type=Path, help="a floor plan of ACES: whole days there instead")
    parser.add_argument("--seeds", default="1:20", help="of those days, first and last")
    given = parser.parse_args()
    if given.plan:
        first, last = (int(text) for text in given.seeds.split(":"))
        Console().print(days(given.plan.resolve(), range(first, last + 1), given.jobs))
        return
    title = f"{given.encounters} encounters of each kind"
    table = Table("encounter", "policy", "touched in 1000", "seconds lost", "stuck", title=title)
    with ProcessPoolExecutor(given.jobs) as pool:
        for kind in given.kind or KINDS:
            for policy in given.policy or POLICIES:
                seeds = range(given.encounters)
                results = list(pool.map(partial(run, kind, policy), seeds, chunksize=8))
                table.add_row(*row(kind, policy, results))
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
