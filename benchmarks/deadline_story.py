"""The four minutes: which of the paper's path decisions fit, and what follows where they do not.

    python -m benchmarks.deadline_story [--seeds 1:10] [--walks 1000] [--plot FILE.svg]

Table 1 of the paper says what an update of its network took on its computer, by |H| and junctions
explored: up to 238.3 s, while a corridor takes about four minutes. Here a robot runs errands in
random 4 by 4 offices of corridors that take 240 s, with the profile ``huey-1990`` and each module
on a processor of its own. Its belief is updated at the price of the paper's network: with |H|
forced to 10, 20, 30, with the |H| that a fixed-time procedure chooses, and, at its own price,
exactly, over all 3,565,408 maps. Before a run junctions were explored by a random walk, as in Table
1: for its rows that many throughout the run, for whole days four at the beginning and then those
that the robot comes to. Misses and idle seconds are those of the runs' ledgers.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.days import Day, Progress, day, scenario_of, seeds_of
from benchmarks.paper_prices import (
    Networks,
    Repriced,
    Sizes,
    Update,
    building_with,
    forced,
    largest_in,
)
from benchmarks.table1 import TABLE_1, random_walk
from bus.costs import CostModel
from bus.grid import Grid
from bus.messages import LedgerEntry
from scenarios.costs import cost_model
from scenarios.scenario import Compute

GRID = Grid(4, 4)
DRIVE_S = 240.0
SIZES = (10, 20, 30)
CHOICE = (2, 5, 10, 15, 20, 25, 30)
LEFT_FOR_OTHERS_S = 40.0
"""What the fixed-time procedure leaves for the path itself and the first feature."""

LENGTHS = (4, 6, 8, 10)
LINES_M = [0.0, 20.4, 40.8, 61.2]  # 240 s at 0.085 m/s, crossings included
CHANGES = (
    f"world.columns_m={LINES_M}",
    f"world.rows_m={LINES_M}",
    "world.person=[]",
    "world.patience_s=1000000",
    "world.until_s=1000000",
    "compute.profile=huey-1990",
    "modules.decider.model=paper",
)
HOURS = (*CHANGES, "world.until_s=3600")
"""The runs for one row of Table 1 last an hour; days until the errands are done."""


@dataclass(frozen=True)
class Run:
    """One run, what its updates were charged, and the decisions that had a corridor's time."""

    day: Day
    updates: tuple[Update, ...]

    def on_the_way(self, kind: str) -> list[LedgerEntry]:
        """Decisions due at the end of a corridor: not of the first, short drive, nor at walls."""
        return [one for one in self.day.of(kind) if one.until_ns - one.asked_ns > DRIVE_S / 2 * 1e9]

    @property
    def update_s(self) -> float:
        """What an update took, a mean."""
        return float(np.mean([update.seconds for update in self.updates]))


def run(
    seed: int, sizes: Sizes, networks: Networks, length: int, changes: Sequence[str], *, grows: bool
) -> Run:
    """A run with updates at the paper's price, so many junctions explored before."""
    before = tuple(random_walk(GRID, length, np.random.default_rng([seed, length])))
    priced: list[Repriced] = []
    build = building_with(priced, networks, sizes, before, grows=grows)
    done = day(scenario_of("office-4x4", changes, seed), build)
    return Run(done, tuple(priced[0].updates))


@dataclass(frozen=True)
class Walked:
    """Random walks as in Table 1: mean seconds of an update, and the share within four minutes."""

    mean_s: float
    in_time: float


def walked(networks: Networks, states: int, length: int, walks: int, costs: CostModel) -> Walked:
    rng = np.random.default_rng([states, length])
    cells = [networks.cells(states, random_walk(GRID, length, rng)) for _ in range(walks)]
    seconds = np.array([costs.cost_ns("belief", n) / 1e9 for n in cells])
    return Walked(float(seconds.mean()), float((seconds <= DRIVE_S).mean()))


HEADER = (
    f"{'':>11} | {'the paper, Table 1':^24} | {'random walks':^16} | runs of an hour\n"
    f"{'|H|':>4} {'length':>6} | {'seconds':>8} {'reckoned':>9} {'fits':>5} | {'mean, s':>8} "
    f"{'in time':>7} | {'update, s':>9} {'paths':>6} {'late':>5} {'idle, s a run':>13}"
)

Rows = dict[tuple[int, int], list[Run]]
"""Runs by |H| and junctions explored."""


def print_rows(
    networks: Networks, seeds: Sequence[int], walks: int, costs: CostModel, progress: Progress
) -> Rows:
    """Table 1 and what follows from it."""
    print(HEADER)
    rows: Rows = {}
    for row in TABLE_1:
        reckoned_s = costs.cost_ns("belief", row.clique) / 1e9
        found = walked(networks, row.states, row.explored, walks, costs)
        sizes = forced(row.states)
        runs = [run(seed, sizes, networks, row.explored, HOURS, grows=False) for seed in seeds]
        rows[row.states, row.explored] = runs
        print(
            f"{row.states:>4} {row.explored:>6} | {row.seconds:>8.1f} {reckoned_s:>9.1f} "
            f"{'yes' if max(row.seconds, reckoned_s) <= DRIVE_S else 'no':>5} | "
            f"{found.mean_s:>8.1f} {found.in_time:>7.0%} | {summed(runs)}",
            flush=True,
        )
        progress.step(f"|H| {row.states}, {row.explored} explored")
    return rows


def summed(runs: Sequence[Run]) -> str:
    """What runs came to: seconds of an update, paths decided, late, idle seconds."""
    paths = [entry for one in runs for entry in one.on_the_way("path")]
    late = sum(bool(entry.cause) for entry in paths)
    update_s = np.mean([one.update_s for one in runs])
    idle_s = np.mean([one.day.idle_s() for one in runs])
    return f"{update_s:>9.1f} {len(paths):>6} {late:>5} {idle_s:>13.0f}"


def print_choice(networks: Networks, seeds: Sequence[int], progress: Progress) -> None:
    sizes = largest_in(networks, CHOICE, DRIVE_S - LEFT_FOR_OTHERS_S)
    print(
        f"\nwhat the fixed-time procedure chooses, |H| of {', '.join(map(str, CHOICE))}, "
        f"an update within {DRIVE_S - LEFT_FOR_OTHERS_S:g} s:\n"
        f"{'length':>11} | {'|H|: least':>10} {'mean':>6} {'most':>5} | "
        f"{'update, s':>9} {'paths':>6} {'late':>5} {'idle, s a run':>13}"
    )
    for length in LENGTHS:
        runs = [run(seed, sizes, networks, length, HOURS, grows=False) for seed in seeds]
        chosen = [one.updates[0].states for one in runs]
        print(
            f"{length:>11} | {min(chosen):>10} {np.mean(chosen):>6.1f} {max(chosen):>5} | "
            f"{summed(runs)}",
            flush=True,
        )
        progress.step(f"fixed time, {length} explored")


def print_days(networks: Networks, seeds: Sequence[int], progress: Progress) -> float:
    """Whole days by way of choosing |H|; the seconds of an exact update."""
    print(
        f"\nwhole days, {LENGTHS[0]} junctions explored before:\n"
        f"{'|H|':>16} | {'paths late':>11} {'features late':>13} | {'idle, s a day':>13} "
        f"{'errands done at, s':>18}"
    )
    ways: dict[str, Sizes] = {f"forced, {states}": forced(states) for states in SIZES}
    ways["fixed time"] = largest_in(networks, CHOICE, DRIVE_S - LEFT_FOR_OTHERS_S)
    for name, sizes in ways.items():
        days = [run(seed, sizes, networks, LENGTHS[0], CHANGES, grows=True) for seed in seeds]
        print_day(name, days)
        progress.step(name)
    exact = [Run(day(scenario_of("office-4x4", CHANGES, seed)), ()) for seed in seeds]
    print_day("exact, all maps", exact)
    progress.step("exact")
    computing_s = sum(one.day.busy_s["geographer"] for one in exact)
    return computing_s / sum(len(one.day.of("path")) for one in exact)


def print_day(name: str, runs: Sequence[Run]) -> None:
    columns = []
    for kind in ("path", "sensing"):
        entries = [entry for one in runs for entry in one.on_the_way(kind)]
        columns.append(f"{sum(bool(entry.cause) for entry in entries)} of {len(entries)}")
    idle_s = np.mean([one.day.idle_s() for one in runs])
    done_s = np.mean([one.day.errand_s for one in runs])
    print(
        f"{name:>16} | {columns[0]:>11} {columns[1]:>13} | {idle_s:>13.0f} {done_s:>18.0f}",
        flush=True,
    )


def plot(rows: Rows, networks: Networks, exact_s: float, costs: CostModel, file: Path) -> None:
    """Seconds of an update over the junctions explored."""
    import matplotlib as mpl

    mpl.use("svg")
    mpl.rcParams["svg.hashsalt"] = "waywiser"  # else the file would differ from run to run
    mpl.rcParams["svg.fonttype"] = "none"
    from matplotlib import pyplot

    figure, panel = pyplot.subplots(figsize=(7.5, 4.5))
    colours = dict(zip(SIZES, mpl.colormaps["viridis"]([0.0, 0.45, 0.8]), strict=True))
    for states in SIZES:
        means = [walked(networks, states, n, 300, costs).mean_s for n in LENGTHS]
        panel.plot(LENGTHS, means, "-", color=colours[states], label=f"|H| {states}, walks' mean")
        paper = {row.explored: row.seconds for row in TABLE_1 if row.states == states}
        marks = panel.plot(list(paper), list(paper.values()), "D", color=colours[states])
        marks[0].set_label(f"|H| {states}, Table 1")
        for length in LENGTHS:
            for one in rows[states, length]:
                late = any(entry.cause for entry in one.on_the_way("path"))
                at = length + (states - 20) / 60
                panel.plot(at, one.update_s, "x" if late else ".", color=colours[states], ms=5)
    for seconds, words in ((DRIVE_S, "four minutes"), (exact_s, "exact, all maps")):
        panel.axhline(seconds, color="0.3", lw=1, ls="--")
        panel.text(LENGTHS[-1] + 0.3, seconds, words, color="0.3", ha="right", va="bottom")
    panel.set_yscale("log")
    panel.set_xlabel("junctions explored")
    panel.set_ylabel("seconds of an update, computer of 1990")
    panel.set_title("dots: runs of an hour; crosses: those with late paths", fontsize=9)
    panel.grid(alpha=0.3)
    panel.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(file, metadata={"Date": None})


def main() -> None:
    parser = argparse.ArgumentParser(
        description="Which path decisions of the paper fit four minutes, and what follows.",
        epilog="Example: python -m benchmarks.deadline_story --plot docs/deadline-story.svg",
    )
    parser.add_argument("--seeds", default="1:10", help="seeds of the runs, A:B (1:10)")
    parser.add_argument("--walks", type=int, default=1000, help="random walks a row (1000)")
    parser.add_argument("--plot", type=Path, help="an SVG file to write")
    arguments = parser.parse_args()
    networks, costs = Networks(GRID), cost_model(Compute(profile="huey-1990"))
    seeds = seeds_of(arguments.seeds)
    progress = Progress(len(TABLE_1) + len(LENGTHS) + len(SIZES) + 2)
    rows = print_rows(networks, seeds, arguments.walks, costs, progress)
    print_choice(networks, seeds, progress)
    exact_s = print_days(networks, seeds, progress)
    print(
        f"\nan exact update, all 3,565,408 maps and those drawn from them: {exact_s:.1f} s; "
        f"the paper's with |H| 30, four junctions explored: {TABLE_1[8].seconds} s"
    )
    if arguments.plot:
        plot(rows, networks, exact_s, costs, arguments.plot)


if __name__ == "__main__":
    main()
