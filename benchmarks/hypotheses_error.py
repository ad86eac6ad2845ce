"""What a few hypotheses cost in truth: the paper's belief beside the exact one, by |H|.

Usage: ``python -m benchmarks.hypotheses_error [--days 40] [--largest 10000] [--right 1.0]
[--plot docs/hypotheses-error.svg]``

A day is a random connected map of a 4 by 4 grid and a walk that classifies one junction after the
other, as in Table 1. The paper's belief has |H| states, NOTA among them, drawn from the same
prior as the true map, so that only the number of hypotheses differs from the exact belief over all
3,565,408 maps. The table has, by |H| and junctions explored: the total variation between the two
beliefs, a mean over the junctions not yet explored, for one set kept throughout and for the
paper's, replaced when NOTA exceeds every map; how often the true map is in H; how often the set
was replaced so far and is exhaustive; and what an update costs.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks.table1 import random_walk
from bus.grid import JUNCTION_TYPES, Maps
from modules.geographer import ConnectedMaps, MapBelief
from modules.geographer.paper import (
    HypothesisBelief,
    HypothesisSet,
    direct_belief,
    direct_cells,
    first_set,
    revise,
)

Floats = NDArray[np.float64]
SIZES = (10, 30, 100, 300, 1000, 3000, 10000)
LENGTHS = (0, 2, 4, 6, 8, 10)


@dataclass(frozen=True)
class Day:
    """A true map (corridors,) and the evidence after each length of exploration."""

    truth: Maps
    walk: list[int]
    evidence: list[Floats]
    exact: list[MapBelief]


@dataclass(frozen=True)
class Found:
    """One belief of the paper's beside the exact one."""

    variation: float
    contains_truth: bool
    exhaustive: bool
    replacements: int


def make_day(maps: ConnectedMaps, right: float, rng: np.random.Generator) -> Day:
    """A random map and walk; a junction is taken for its type with probability `right`."""
    grid = maps.grid
    nothing = np.ones((grid.intersections, JUNCTION_TYPES))
    shape = (grid.rows, grid.columns, JUNCTION_TYPES)
    truth = maps.posterior(nothing.reshape(shape)).sample(1, rng)
    walk = random_walk(grid, max(LENGTHS), rng)
    types = grid.junction_types(truth)[0]
    evidence = [nothing]
    for v in walk:
        fitting = np.flatnonzero(grid.possible_types(*grid.place(v)))
        wrong = fitting[fitting != types[v]]
        seen = types[v] if rng.random() < right else wrong[rng.integers(len(wrong))]
        now = evidence[-1].copy()
        now[v] = (1.0 - right) / (len(fitting) - 1)
        now[v, seen] = right
        evidence.append(now)
    shaped = [e.reshape(shape) for e in evidence]
    return Day(truth[0], walk, shaped, [maps.posterior(e) for e in shaped])


def variation(day: Day, explored: int, belief: HypothesisBelief) -> float:
    """Mean total variation over the junctions not explored yet."""
    apart = np.abs(belief.junctions - day.exact[explored].junctions).sum(axis=2).ravel() / 2
    rest = np.ones(len(apart), dtype=bool)
    rest[day.walk[:explored]] = False
    return float(apart[rest].mean())


def one_set(maps: ConnectedMaps, day: Day, states: int, rng: np.random.Generator) -> list[Found]:
    """One set of hypotheses all day: what was found at each length of exploration."""
    chosen = first_set(maps, states, rng)
    contains = chosen.contains(day.truth)
    return [
        Found(variation(day, n, direct_belief(chosen, day.evidence[n])), contains, False, 0)
        for n in LENGTHS
    ]


def renewed(maps: ConnectedMaps, day: Day, states: int, rng: np.random.Generator) -> list[Found]:
    """The set replaced when NOTA exceeds every map, with all the evidence up to then."""
    chosen, replacements, found = first_set(maps, states, rng), 0, []
    for explored, evidence in enumerate(day.evidence):
        revision = revise(chosen, evidence, maps, states, rng)
        chosen = revision.hypotheses
        replacements += revision.replaced
        if explored in LENGTHS:
            found.append(
                Found(
                    variation(day, explored, revision.belief),
                    chosen.contains(day.truth),
                    chosen.exhaustive,
                    replacements,
                )
            )
    return found


Study = dict[tuple[int, str], list[list[Found]]]
"""By |H| and way: for each day, what was found at each length."""

WAYS = {"one set": one_set, "renewed": renewed}


def study(maps: ConnectedMaps, days: list[Day], sizes: list[int], seed: int) -> Study:
    """Everything that is compared; says on standard error how far it is."""
    found: Study = {}
    for states in sizes:
        for name, way in WAYS.items():
            rng = np.random.default_rng([seed, states, len(name)])
            print(f"|H| {states}, {name} ...        ", end="\r", file=sys.stderr, flush=True)
            found[states, name] = [way(maps, day, states, rng) for day in days]
    print(" " * 40, end="\r", file=sys.stderr, flush=True)
    return found


def mean(days: list[list[Found]], length: int, what: Callable[[Found], float]) -> float:
    return float(np.mean([what(day[length]) for day in days]))


def print_study(found: Study, sizes: list[int]) -> None:
    print(
        f"{'|H|':>6} {'explored':>8} | {'variation':^19} | {'true map in H':^19} | "
        f"{'renewed':>8} {'exhaustive':>10}\n"
        f"{'':>15} | {'one set':>9} {'renewed':>9} | {'one set':>9} {'renewed':>9} | "
        f"{'times':>8}"
    )
    for states in sizes:
        for number, explored in enumerate(LENGTHS):
            kept, new = found[states, "one set"], found[states, "renewed"]
            print(
                f"{states:>6} {explored:>8} | "
                f"{mean(kept, number, lambda f: f.variation):>9.3f} "
                f"{mean(new, number, lambda f: f.variation):>9.3f} | "
                f"{mean(kept, number, lambda f: f.contains_truth):>9.0%} "
                f"{mean(new, number, lambda f: f.contains_truth):>9.0%} | "
                f"{mean(new, number, lambda f: f.replacements):>8.2f} "
                f"{mean(new, number, lambda f: f.exhaustive):>10.0%}"
            )


def seconds(action: Callable[[], object], repeats: int = 50) -> float:
    """The median time of an action."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return float(np.median(times))


def print_costs(maps: ConnectedMaps, day: Day, sizes: list[int]) -> None:
    """What one update takes, by |H|, and what the exact one takes."""
    print(f"\n{'|H|':>6} {'cells':>9} {'update':>12} {'new set':>12}")
    evidence = day.evidence[4]
    for states in sizes:
        rng = np.random.default_rng(states)
        chosen = first_set(maps, states, rng)

        def update(chosen: HypothesisSet = chosen) -> object:
            return direct_belief(chosen, evidence)

        def replace(states: int = states, rng: np.random.Generator = rng) -> object:
            return first_set(maps, states, rng)

        print(
            f"{states:>6} {direct_cells(chosen):>9} {seconds(update) * 1e3:>9.3f} ms "
            f"{seconds(replace, 5) * 1e3:>9.3f} ms"
        )
    exact_s = seconds(lambda: maps.posterior(evidence).junctions)
    print(f" exact {maps.update_cells:>9} {exact_s * 1e3:>9.3f} ms")


def plot(found: Study, sizes: list[int], days: int, file: Path) -> None:
    """Variation over |H|, a line for each length of exploration, one panel a way."""
    import matplotlib as mpl

    mpl.use("svg")
    mpl.rcParams["svg.hashsalt"] = "waywiser"  # else the file would differ from run to run
    mpl.rcParams["svg.fonttype"] = "none"
    from matplotlib import pyplot

    figure, panels = pyplot.subplots(1, 2, figsize=(10.0, 4.0), sharey=True)
    titles = {"one set": "one set throughout", "renewed": "renewed when NOTA exceeds every map"}
    colours = mpl.colormaps["viridis"](np.linspace(0.0, 0.85, len(LENGTHS)))
    for panel, name in zip(panels, WAYS, strict=True):
        for number, explored in enumerate(LENGTHS):
            lines = [mean(found[s, name], number, lambda f: f.variation) for s in sizes]
            panel.plot(sizes, lines, marker="o", color=colours[number], label=str(explored))
        panel.set_xscale("log")
        panel.set_title(titles[name])
        panel.set_xlabel("|H|")
        panel.set_ylim(bottom=0.0)
        panel.grid(alpha=0.3)
    panels[0].set_ylabel("total variation from the exact belief")
    panels[1].legend(title="junctions\nexplored", loc="center left", bbox_to_anchor=(1.0, 0.5))
    figure.suptitle(f"4 x 4 grid, mean of {days} random maps and walks", fontsize=10)
    figure.tight_layout()
    figure.savefig(file, metadata={"Date": None})


def main() -> None:
    parser = argparse.ArgumentParser(
        description="The paper's belief with |H| hypotheses beside the exact one.",
        epilog="Example: python -m benchmarks.hypotheses_error --days 40 --plot error.svg",
    )
    parser.add_argument("--days", type=int, default=40, help="random maps and walks (40)")
    parser.add_argument("--largest", type=int, default=10000, help="the largest |H| (10000)")
    parser.add_argument("--right", type=float, default=1.0, help="P(a type is seen right) (1)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--plot", type=Path, help="an SVG file to write")
    arguments = parser.parse_args()
    sizes = [size for size in SIZES if size <= arguments.largest]
    maps = ConnectedMaps(4, 4)
    rng = np.random.default_rng(arguments.seed)
    days = [make_day(maps, arguments.right, rng) for _ in range(arguments.days)]
    found = study(maps, days, sizes, arguments.seed)
    print_study(found, sizes)
    print_costs(maps, days[0], sizes)
    if arguments.plot:
        plot(found, sizes, arguments.days, arguments.plot)


if __name__ == "__main__":
    main()
