"""Whether a map is worth making first, by how many errands will use it.

    python -m benchmarks.crossover [--size N] [--worlds N]

The same buildings with ever more errands: a robot that explores everything before its first
errand, one that hopes and keeps no map from errand to errand, and three that keep what their
errands teach: by known ways wherever there are any, hoping, and planning for all errands. What each
drives beyond the shortest ways, in corridors of mean length.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace

import numpy as np
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.dependent_worlds import ROBOTS, SIZES, World, optimist, seer

COUNTS = (1, 2, 4, 8, 16, 32, 64, 128)
MOST_PLANNED = 16
"""Errands that are planned for at most: beyond that the planner's time grows, its gain does not."""


def forgetful(world: World) -> float:
    """The shortest way that may exist, every errand as if it were the first."""
    ends = zip(world.places, world.goals, strict=False)
    return sum(optimist(replace(world, start=a, goals=np.array([b]))) for a, b in ends)


PLANNER = "least expected cost"
SHOWN: dict[str, Callable[[World], float]] = {
    "explores first": ROBOTS["explores first"],
    "keeps no map": forgetful,
    **{name: ROBOTS[name] for name in ("known ways", "optimist", PLANNER)},
}


def run(job: tuple[int, int, int]) -> list[float]:
    """Beyond the shortest ways, by every robot shown; nan where it was left out."""
    size, seed, errands = job
    world = World.drawn(seed, size, errands)
    least = seer(world)
    return [
        (robot(world) - least) / float(world.roads.seconds.mean())
        if errands <= MOST_PLANNED or name != PLANNER
        else float("nan")
        for name, robot in SHOWN.items()
    ]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--size", type=int, choices=SIZES, default=4, help="lines each way (4)")
    parser.add_argument("--worlds", type=int, default=100, help="buildings for each count (100)")
    given = parser.parse_args()
    jobs = [(given.size, seed, errands) for errands in COUNTS for seed in range(given.worlds)]
    with ProcessPoolExecutor() as pool:
        found = list(
            track(
                pool.map(run, jobs, chunksize=4), "worlds", len(jobs), console=Console(stderr=True)
            )
        )
    costs = np.array(found).reshape(len(COUNTS), given.worlds, len(SHOWN))
    table = Table(
        title=f"{given.size}x{given.size}: corridors beyond the shortest ways, +- 1.96 s.e."
    )
    for name in ("errands", *SHOWN, "least of the first two"):
        table.add_column(name)
    for errands, of in zip(COUNTS, costs, strict=True):
        mean, error = of.mean(axis=0), 1.96 * of.std(axis=0, ddof=1) / given.worlds**0.5
        cells = [
            "" if np.isnan(m) else f"{m:.1f} +- {e:.1f}" for m, e in zip(mean, error, strict=True)
        ]
        table.add_row(str(errands), *cells, list(SHOWN)[int(mean[:2].argmin())])
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
