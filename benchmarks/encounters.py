"""Collisions and seconds lost in encounters: the reactor, always-stop, and never-react.

    python -m benchmarks.encounters [--encounters N] [--policy NAME]... [--kind NAME]...

Each of the shipped encounter scenarios is run over and over, whole system, in one process: with
another line, speed, distance or side each time, drawn from a seed. ``always stops`` halts the
robot while any of the three transducers that look ahead hears something within 4 m that is nearer
than it should be, and for three seconds after; ``never reacts`` drives on. A run whose robot
comes no further for two minutes counts as stuck; seconds lost are those of the runs that are not.
Everything is simulated time, so the numbers repeat on any machine.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy import stats

from bus.messages import Arrival, RunEnded, TrueEncounter
from bus.turns import Module
from scenarios.modules import build_module
from scenarios.scenario import check
from tests.scenarios.encounters import KINDS, Stops, drawn, replacing
from tests.scenarios.outcomes import unmoved
from tests.scenarios.runs import everything_said, of_kind

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
    given = parser.parse_args()
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
