"""The planner for ways that may be blocked, beside others, on the Canadian Traveller's Problem.

    python -m benchmarks.ctp                                 reduced: 100 weathers a graph
    python -m benchmarks.ctp --weathers 1000 --results FILE  the full protocol, goes on where it was
    python -m benchmarks.ctp --random 50 --graphs 3          random Delaunay graphs of 50 vertices

Runs every planner through the same weathers (only those with a way count) of the ten 20-node
graphs of AAAI-10, and prints mean costs with 95 % confidence intervals and seconds a decision,
beside the costs published for them. A decision depends on what is known alone, its worlds are
drawn with a seed made from that, so one that comes again is not made again; the seconds are means
over those made.
"""

from __future__ import annotations

import argparse
import csv
import json
import sys
import time
import zlib
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from scipy.spatial import Delaunay

from benchmarks.ctp_baselines import by_samples, optimistic, uct
from modules.decider.roads import Roads
from modules.decider.traveller import (
    UNKNOWN,
    Instance,
    independent_worlds,
    least_cells,
    look_ahead,
    read_instance,
)
from modules.decider.traveller.way_kernels import learn, moves
from modules.decider.traveller.world_kernels import clairvoyant, draw_worlds

SHARED = Path("../shared/benchmarks/ctp")
PUBLISHED = {
    "optimistic": "optimistic",
    "hindsight": "hindsight_optimisation",
    "rollout": "optimistic_rollout",
    "uct": "uct_optimistic_10k",
}
WORLDS = {"optimistic": 1, "hindsight": 2000, "rollout": 2000, "uct": 10_000, "waywiser": 500}

State = NDArray[np.uint8]
Policy = Callable[[Roads, State, int, int, NDArray[np.uint8]], int]


def waywiser(roads: Roads, known: State, place: int, goal: int, worlds: NDArray[np.uint8]) -> int:
    """The decider's planner."""
    cells = least_cells(len(roads.corridor), len(worlds))
    found = look_ahead(roads, known, place, goal, worlds, cells)
    return int(found.to[found.best])


POLICIES: dict[str, Policy] = {
    "optimistic": lambda roads, known, place, goal, _: int(optimistic(roads, known, place, goal)),
    "hindsight": partial(by_samples, hindsight=True),
    "rollout": partial(by_samples, hindsight=False),
    "uct": uct,
    "waywiser": waywiser,
}


@dataclass(frozen=True)
class Outcome:
    """One planner on one graph."""

    graph: str
    planner: str
    seed: int
    weathers: int
    costs: list[float]
    seconds: float
    """Of all decisions made."""
    decisions: int


@dataclass
class Traveller:
    """One planner's decisions on one instance, each made once."""

    instance: Instance
    roads: Roads
    planner: str
    seconds: float = 0.0
    made: dict[bytes, int] = field(default_factory=dict)

    def drive(self, weather: State) -> float:
        """Cost of the way from the start to the goal in one weather."""
        known = np.full(len(weather), UNKNOWN, dtype=np.uint8)
        vertices = len(self.roads.corridor)
        way, queue = np.empty(vertices), np.empty(vertices, dtype=np.int64)
        place, spent = 0, 0.0
        learn(self.roads, known, weather, place)
        while place != self.instance.goal:
            to = self.decide(known, place)
            moves(self.roads, known, place, self.instance.goal, way, queue, queue.copy())
            spent += float(way[to])
            place = to
            learn(self.roads, known, weather, place)
        return spent

    def decide(self, known: State, place: int) -> int:
        """The next move, from memory where the same was known before."""
        state = place.to_bytes(2, "big") + known.tobytes()
        if state not in self.made:
            start = time.perf_counter()
            self.made[state] = self._decide(known, place, zlib.crc32(state))
            self.seconds += time.perf_counter() - start
        return self.made[state]

    def _decide(self, known: State, place: int, seed: int) -> int:
        roads, goal = self.roads, self.instance.goal
        worlds = independent_worlds(
            roads,
            self.instance.probability,
            known,
            place,
            goal,
            WORLDS[self.planner],
            np.random.default_rng(seed),
        )
        if not len(worlds):  # so improbable a weather that no sample has it
            return int(optimistic(roads, known, place, goal))
        return int(POLICIES[self.planner](roads, known, place, goal, worlds))


def delaunay(vertices: int, seed: int) -> Instance:
    """A random graph as in AAAI-10: Delaunay of random points, costs 1..50, any probability."""
    rng = np.random.default_rng([vertices, seed])
    corners = Delaunay(rng.random((vertices, 2))).simplices
    pairs = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [0, 2]]])
    ends = np.unique(np.sort(pairs, axis=1), axis=0).astype(np.int64)
    cost = rng.integers(1, 51, len(ends)).astype(np.float64)
    return Instance(vertices, ends, rng.random(len(ends)), cost)


def weathers_of(instance: Instance, count: int, seed: int | list[int]) -> NDArray[np.uint8]:
    """``count`` weathers with a way."""
    weathers = np.empty((count, len(instance.cost)), dtype=np.uint8)
    nothing = np.full(len(instance.cost), UNKNOWN, dtype=np.uint8)
    rng = np.random.default_rng(seed)
    tries = 10_000 * count
    found = draw_worlds(
        instance.roads(), instance.probability, nothing, 0, instance.goal, rng, tries, weathers
    )
    return weathers[:found]


def bad_input(said: str) -> NoReturn:
    """End with status 2."""
    print(said, file=sys.stderr)
    raise SystemExit(2)


def run(name: str, instance: Instance, planner: str, count: int, seed: int) -> Outcome:
    """Drive every weather with one planner."""
    # no two graphs share random numbers, or their means would err together
    weathers = weathers_of(instance, count, [seed, zlib.crc32(name.encode())])
    roads = instance.roads()
    if planner == "clairvoyant":
        costs = clairvoyant(roads, weathers, instance.goal)[:, 0].tolist()
        return Outcome(name, planner, seed, count, costs, 0.0, 0)
    compiling = Traveller(instance, roads, planner)
    compiling.drive(weathers[0])  # not counted
    traveller = Traveller(instance, roads, planner)
    costs = []
    for number, weather in enumerate(weathers):
        costs.append(traveller.drive(weather))
        if number % 20 == 0:
            print(f"\r{name} {planner} {number}/{count}  ", end="", file=sys.stderr, flush=True)
    print("\r" + " " * 60 + "\r", end="", file=sys.stderr, flush=True)
    return Outcome(name, planner, seed, count, costs, traveller.seconds, len(traveller.made))


def remembered(results: Path | None) -> dict[tuple[str, str, int, int], Outcome]:
    """What an earlier call has finished."""
    if results is None or not results.exists():
        return {}
    found = {}
    for number, line in enumerate(results.read_text().splitlines(), start=1):
        try:
            o = Outcome(**json.loads(line))
        except (TypeError, ValueError):
            bad_input(f"{results}:{number}: no result of this program; expected a line it wrote")
        found[o.graph, o.planner, o.seed, o.weathers] = o
    return found


def outcomes(
    graphs: dict[str, Instance], planners: list[str], count: int, seed: int, results: Path | None
) -> Iterator[Outcome]:
    """One outcome a graph and planner; those not in ``results`` are made and added to it."""
    done = remembered(results)
    for name, instance in graphs.items():
        for planner in planners:
            outcome = done.get((name, planner, seed, count))
            if outcome is None:
                outcome = run(name, instance, planner, count, seed)
                if results is not None:
                    with results.open("a") as file:
                        file.write(json.dumps(asdict(outcome)) + "\n")
            yield outcome


def print_table(found: list[Outcome], planners: list[str], graphs: list[str]) -> None:
    """Costs by graph, their mean with its interval, and what a decision took."""
    table = Table(title="mean cost, 95 % confidence; seconds a decision")
    for column in ("graph", *planners):
        table.add_column(column, justify="right")
    by = {(o.graph, o.planner): o for o in found}
    for graph in graphs:
        cells = [_cell([by[graph, planner]]) for planner in planners]
        table.add_row(graph, *cells)
    every = {p: [by[graph, p] for graph in graphs] for p in planners}
    table.add_section()
    table.add_row("mean", *(_cell(every[p]) for p in planners))
    table.add_row("ms/decision", *(_milliseconds(every[p]) for p in planners))
    table.add_row("published", *(_published(p, graphs) for p in planners))
    if "uct" in planners and "waywiser" in planners:
        difference = [_less(by[g, "waywiser"], by[g, "uct"]) for g in graphs]
        print(f"waywiser less uct, same weathers: {_cell(difference)}")
    Console(width=120).print(table)


def _less(one: Outcome, other: Outcome) -> Outcome:
    costs = [a - b for a, b in zip(one.costs, other.costs, strict=True)]
    return Outcome(one.graph, "", one.seed, one.weathers, costs, 0.0, 0)


def _cell(outcomes: list[Outcome]) -> str:
    mean = np.mean([np.mean(o.costs) for o in outcomes])
    variance = sum(np.var(o.costs, ddof=1) / len(o.costs) for o in outcomes)
    return f"{mean:.1f} ± {1.96 * variance**0.5 / len(outcomes):.1f}"


def _milliseconds(outcomes: list[Outcome]) -> str:
    made = sum(o.decisions for o in outcomes)
    return f"{1e3 * sum(o.seconds for o in outcomes) / made:.2f}" if made else ""


def _published(planner: str, graphs: list[str]) -> str:
    if planner not in PUBLISHED or not (SHARED / "results.csv").exists():
        return ""
    with (SHARED / "results.csv").open() as file:
        rows = {row["graph"]: float(row[PUBLISHED[planner]]) for row in csv.DictReader(file)}
    return f"{np.mean([rows[g] for g in graphs]):.1f}" if set(graphs) <= set(rows) else ""


def graphs_of(arguments: argparse.Namespace) -> dict[str, Instance]:
    """The graphs asked for, by name."""
    numbers = range(1, arguments.graphs + 1)
    if arguments.random:
        size = arguments.random
        return {f"random {size}-{k}": delaunay(size, k) for k in numbers}
    if not SHARED.exists():
        raise SystemExit(f"skipped: the graphs of AAAI-10 are not in {SHARED}; try --random 20")
    return {f"20-{k}": read_instance(SHARED / f"20-{k}.graph") for k in numbers}


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    everyone = ["clairvoyant", *POLICIES]
    parser.add_argument("--weathers", type=int, default=100, help="of each graph (100)")
    parser.add_argument("--graphs", type=int, default=10, help="how many (10)")
    parser.add_argument("--random", type=int, metavar="VERTICES", help="random graphs instead")
    parser.add_argument("--planners", nargs="+", choices=everyone, default=everyone)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--results", type=Path, help="keep results here and go on from them")
    arguments = parser.parse_args()
    most = 10 if not arguments.random else 1000
    if arguments.weathers < 2 or not 1 <= arguments.graphs <= most:
        bad_input(f"expected --weathers of at least 2 and --graphs in 1..{most}")
    if arguments.random is not None and arguments.random < 4:
        bad_input(f"--random is {arguments.random}, expected at least 4")
    graphs = graphs_of(arguments)
    found = list(
        outcomes(graphs, arguments.planners, arguments.weathers, arguments.seed, arguments.results)
    )
    print_table(found, arguments.planners, list(graphs))


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit("stopped; what --results holds is kept")
