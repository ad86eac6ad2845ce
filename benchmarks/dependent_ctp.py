"""Errands in buildings nobody knows: the planner beside other ways to decide, over random maps.

    python -m benchmarks.dependent_ctp [--worlds N] [--keep FILE] [--plot docs/dependent-ctp.svg]

Connected maps make a Canadian Traveller's Problem whose ways depend on each other. Random ones
from 3x3 to 8x8 lines are drawn exactly; every robot drives the same ten errands in the same world
and knows all of them, the lengths of the corridors and the prior. ``--keep`` writes each world's
result as it comes and continues from there. Lengths are simulated and repeat anywhere.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.progress import track
from rich.table import Table

from benchmarks.dependent_worlds import ROBOTS, SIZES, World

SHARE = (28, 26, 22, 14, 6, 4)
"""Of a hundred worlds, how many of each of SIZES: a large one takes a hundred times a small."""

ERRANDS = 10
OURS = "least expected cost"
SEER = "sees the truth"

Found = Mapping[int, NDArray[np.float64]]
"""By size: corridor lengths driven, (worlds, robots), robots in the order of ROBOTS."""


def seeds(worlds: int) -> Iterator[tuple[int, int]]:
    """Size and seed of each world, all sizes early on."""
    order = sorted(
        ((k + 0.5) / share, size, k)
        for size, share in zip(SIZES, SHARE, strict=True)
        for k in range(share)
    )
    for number in range(worlds):
        size = order[number % len(order)][1]
        yield size, number


def run(job: tuple[int, int]) -> tuple[int, int, list[float]]:
    """What every robot drives in one world."""
    size, seed = job
    world = World.drawn(seed, size, ERRANDS)
    return size, seed, [robot(world) for robot in ROBOTS.values()]


def study(worlds: int, keep: Path | None) -> Found:
    """All worlds, those that were kept not again."""
    lines = keep.read_text(encoding="utf-8").splitlines() if keep and keep.is_file() else []
    done = {(size, seed): costs for size, seed, costs in map(json.loads, lines)}
    jobs = list(seeds(worlds))
    missing = [job for job in jobs if job not in done]
    with ProcessPoolExecutor() as pool:
        found = pool.map(run, missing)
        for size, seed, costs in track(found, "worlds", len(missing), console=Console(stderr=True)):
            done[size, seed] = costs
            if keep:
                with keep.open("a", encoding="utf-8") as file:
                    file.write(json.dumps([size, seed, costs]) + "\n")
    return by_size({job: done[job] for job in jobs})


def by_size(done: Mapping[tuple[int, int], Sequence[float]]) -> Found:
    """The results as arrays."""
    sizes = [size for size in SIZES if any(s == size for s, _ in done)]
    return {s: np.array([costs for (size, _), costs in done.items() if size == s]) for s in sizes}


def ratio(costs: NDArray[np.float64], robot: str) -> tuple[float, float]:
    """Mean over worlds of a robot's way over the seer's, and 1.96 standard errors of it."""
    names = list(ROBOTS)
    each = costs[:, names.index(robot)] / costs[:, names.index(SEER)]
    return interval(each)


def lost(costs: NDArray[np.float64], robot: str) -> tuple[float, float]:
    """The same of how much more it drives than ours in the same world, in parts of the seer's."""
    names = list(ROBOTS)
    more = costs[:, names.index(robot)] - costs[:, names.index(OURS)]
    return interval(more / costs[:, names.index(SEER)])


def interval(each: NDArray[np.float64]) -> tuple[float, float]:
    """Mean and 1.96 standard errors."""
    return float(each.mean()), 1.96 * float(each.std(ddof=1)) / len(each) ** 0.5


def table(found: Found, title: str, of: str) -> Table:
    """One row a robot, one column a size: ratios, or what is lost to ours."""
    result = Table(title=title)
    result.add_column("")
    for size, costs in found.items():
        result.add_column(f"{size}x{size}\n{len(costs)} worlds")
    for robot in ROBOTS:
        if robot == SEER or (of == "lost" and robot == OURS):
            continue
        figures = [ratio(c, robot) if of == "ratio" else lost(c, robot) for c in found.values()]
        sign = "+" if of == "lost" else ""
        result.add_row(robot, *(f"{mean:{sign}.3f} +- {more:.3f}" for mean, more in figures))
    return result


def plot(found: Found, file: Path) -> None:
    """Ratio over size, a line a robot."""
    import matplotlib as mpl

    mpl.use("svg")
    mpl.rcParams["svg.hashsalt"] = "waywiser"  # else the file would differ from run to run
    mpl.rcParams["svg.fonttype"] = "none"
    from matplotlib import pyplot

    figure, panel = pyplot.subplots(figsize=(7.0, 4.2))
    robots = [robot for robot in ROBOTS if robot not in (SEER, "explores first")]
    for number, robot in enumerate(robots):
        means, bars = np.array([ratio(costs, robot) for costs in found.values()]).T
        at = np.array(list(found)) + 0.05 * (number - len(robots) / 2)
        panel.errorbar(at, means, bars, marker="o", markersize=4, capsize=2, label=robot)
    panel.set_xticks(list(found), [f"{size}x{size}" for size in found])
    panel.set_ylabel("way of ten errands over the shortest")
    panel.grid(alpha=0.3)
    panel.legend()
    figure.tight_layout()
    figure.savefig(file, metadata={"Date": None})


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--worlds", type=int, default=1000, help="in all (1000)")
    parser.add_argument("--keep", type=Path, help="a file of results, to go on from")
    parser.add_argument("--plot", type=Path, help="an SVG file to write")
    given = parser.parse_args()
    if given.worlds < 100:
        parser.error(f"--worlds is {given.worlds}, expected at least 100")
    found = study(given.worlds, given.keep)
    console = Console(width=130)
    console.print(table(found, "way driven over the shortest, mean +- 1.96 s.e.", "ratio"))
    console.print(table(found, f"more than by {OURS}, same worlds", "lost"))
    if given.plot:
        plot(found, given.plot)


if __name__ == "__main__":
    main()
