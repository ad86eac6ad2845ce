"""One processor, two, or one for each module: what sharing costs.

    python -m benchmarks.shared_processors [--seeds 1:4]

Whole runs of the shipped scenarios with the profiles ``host`` and ``huey-1990``. Modules that share
processors queue for them by priority, the reactor first, and a handler that has begun is not
interrupted. A reaction's time is from the ping at which the thing was within hearing to the answer.
Everything is simulated time: the numbers repeat anywhere.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence

import numpy as np

from benchmarks.days import KINDS, Day, Progress, day, scenario_of, seeds_of

SCENARIOS = ("aces", "office-4x4")
PROFILES = ("host", "huey-1990")
PROCESSORS = ("1", "2", "one each")


def days(scenario: str, profile: str, processors: str, seeds: Iterable[int]) -> list[Day]:
    """A run for each seed."""
    changes = (
        f"compute.profile={profile}",
        f"compute.processors={processors}",
        "modules.decider.model=paper",
    )
    return [day(scenario_of(scenario, changes, seed)) for seed in seeds]


HEADER = (
    f"{'':>33} | {'late':^32} | {'idle':>7} | {'reaction time, s':^17} | {'':>9} |\n"
    f"{'scenario':>11} {'profile':>10} {'processors':>10} | {'sensing':>10} {'path':>10} "
    f"{'reaction':>10} | {'s a day':>7} | {'median':>8} {'most':>8} | {'touched':>9} | "
    f"{'errands, s':>10}"
)


def row(found: Sequence[Day]) -> str:
    """Late of all decisions by kind, idle seconds, reaction times, collisions, errand time."""
    late = []
    for kind in KINDS:
        decided = sum(len(one.of(kind)) for one in found)
        late.append(f"{f'{sum(one.late(kind) for one in found)} of {decided}':>10}")
    times = reaction_times_s(found)
    met = sum(len(one.encounters) for one in found)
    touched = f"{sum(one.collisions for one in found)} of {met}"
    idle_s = np.mean([one.idle_s() for one in found])
    done_s = np.mean([one.errand_s for one in found])
    return (
        f"{' '.join(late)} | {idle_s:>7.1f} | {np.median(times):>8.3f} {max(times):>8.3f} | "
        f"{touched:>9} | {done_s:>10.0f}"
    )


def reaction_times_s(found: Sequence[Day]) -> list[float]:
    """From hearing to answer, of the reactions that came; nan if none did."""
    entries = [entry for one in found for entry in one.of("reaction") if entry.decided_ns >= 0]
    return [(entry.decided_ns - entry.asked_ns) / 1e9 for entry in entries] or [float("nan")]


def main() -> None:
    parser = argparse.ArgumentParser(
        description="What sharing one or two processors costs: misses, idle and reaction times.",
        epilog="Example: python -m benchmarks.shared_processors --seeds 1:4",
    )
    parser.add_argument("--seeds", default="1:4", help="seeds of the runs, A:B (1:4)")
    arguments = parser.parse_args()
    seeds = seeds_of(arguments.seeds)
    progress = Progress(len(SCENARIOS) * len(PROFILES) * len(PROCESSORS))
    print(HEADER)
    for scenario in SCENARIOS:
        for profile in PROFILES:
            for processors in PROCESSORS:
                found = days(scenario, profile, processors, seeds)
                print(f"{scenario:>11} {profile:>10} {processors:>10} | {row(found)}", flush=True)
                progress.step(f"{scenario}, {profile}, {processors}")


if __name__ == "__main__":
    main()
