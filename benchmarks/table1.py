"""The paper's Table 1 again: the largest clique and the time of an update, by |H| and exploration.

Usage: ``python -m benchmarks.table1 [--runs 10] [--walks 1000] [--seed 1]``

The network is the multiply connected one on a 4 by 4 grid: H with |H| states (NOTA is one of
them), a junction with 4, 8 or 16 types at each intersection, and for each possible corridor a
feature with the junctions at its two ends as parents. A run explores by a random walk that meets
no junction twice; the junctions it met are instantiated, the others stay. The table has the
paper's averages of 10 runs, this program's, and its mean over many walks with the scatter that a
mean of 10 has.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import JUNCTION_TYPES, Grid
from modules.geographer import ConnectedMaps
from modules.geographer.density import medium_density
from modules.geographer.paper import PaperNetwork, corridor_features, first_set
from modules.geographer.paper.junction_tree import JunctionTree
from modules.geographer.paper.triangulation import largest_clique

Floats = NDArray[np.float64]

READINGS = np.array([[0.95, 0.05], [0.05, 0.95]])
"""Pr(S|X); it has no influence on the cliques."""


@dataclass(frozen=True)
class Published:
    """A row of Table 1 in Basye, Lejter, Kanazawa (1990): "Average results for 10 runs"."""

    states: int
    explored: int
    seconds: float
    clique: int


TABLE_1 = (
    Published(10, 4, 92.2, 88064),
    Published(10, 6, 35.6, 41728),
    Published(10, 8, 8.8, 7424),
    Published(10, 10, 14.6, 12992),
    Published(20, 4, 148.0, 147456),
    Published(20, 6, 73.6, 73728),
    Published(20, 8, 28.9, 26240),
    Published(20, 10, 14.3, 13152),
    Published(30, 4, 238.3, 245760),
    Published(30, 6, 129.7, 150528),
    Published(30, 8, 65.4, 64512),
    Published(30, 10, 12.8, 10944),
)

REPRODUCED = {4: 8942, 6: 3843, 8: 1238, 10: 671}
"""Cells of the largest clique for each state of H, by length of exploration: means that another
program found for the same network and walks, triangulated by minimum weight."""


def random_walk(grid: Grid, length: int, rng: np.random.Generator) -> list[int]:
    """Intersections of a walk on the grid's lines that meets none twice; dead ends begin anew."""
    while True:
        walk = [int(rng.integers(grid.intersections))]
        while len(walk) < length:
            ahead = [v for v in neighbours(grid, walk[-1]) if v not in walk]
            if not ahead:
                break
            walk.append(ahead[rng.integers(len(ahead))])
        if len(walk) == length:
            return walk


def neighbours(grid: Grid, intersection: int) -> list[int]:
    """The intersections next to one."""
    corridors = grid.corridor_table[intersection]
    return [sum(grid.ends(int(c))) - intersection for c in corridors if c >= 0]


def network_for(maps: ConnectedMaps, states: int, rng: np.random.Generator) -> PaperNetwork:
    """The multiply connected network with random hypotheses."""
    hypotheses = first_set(maps, states, rng, medium_density(maps.grid.corridors))
    return PaperNetwork(hypotheses, tuple(corridor_features(maps.grid, READINGS)))


def cliques(network: PaperNetwork, explored: int, rng: np.random.Generator) -> Iterator[int]:
    """Cells of the largest clique, for one walk after the other."""
    while True:
        yield largest_clique(network, random_walk(network.hypotheses.grid, explored, rng))


def classified(network: PaperNetwork, walk: list[int]) -> Floats:
    """lambda(J) when the junctions of a walk are known to be as in the first hypothesis."""
    grid = network.hypotheses.grid
    likelihood = np.ones((grid.intersections, JUNCTION_TYPES))
    for v in walk:
        likelihood[v] = 0.0
        likelihood[v, network.hypotheses.types[0, v]] = 1.0
    return likelihood.reshape(grid.rows, grid.columns, JUNCTION_TYPES)


@dataclass(frozen=True)
class Measured:
    """What one row came to here: cells and seconds, means over the runs."""

    clique: float
    seconds: float
    many: float
    scatter_of_ten: float
    as_reckoned: int


def measure(row: Published, runs: int, walks: int, seed: int) -> Measured:
    """Do one row over; also counts the runs where pyAgrum's clique is the one reckoned before."""
    rng = np.random.default_rng([seed, row.states, row.explored])
    maps = ConnectedMaps(4, 4)
    sizes, reckoned, seconds = [], [], []
    for _ in range(runs):
        network = network_for(maps, row.states, rng)
        tree = JunctionTree(network)
        walk = random_walk(maps.grid, row.explored, rng)
        start = time.perf_counter()
        tree.update(classified(network, walk))
        seconds.append(time.perf_counter() - start)
        sizes.append(tree.largest_clique)
        reckoned.append(largest_clique(network, walk))
    stream = cliques(network, row.explored, rng)
    many = np.array([next(stream) for _ in range(walks)])
    return Measured(
        float(np.mean(sizes)),
        float(np.mean(seconds)),
        float(many.mean()),
        float(many.std() / np.sqrt(10)),
        sum(a == b for a, b in zip(sizes, reckoned, strict=True)),
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description="Table 1 of the paper, done over: cells of the largest clique, and time.",
        epilog="Example: python -m benchmarks.table1 --runs 10 --walks 1000",
    )
    parser.add_argument("--runs", type=int, default=10, help="updates by pyAgrum a row (10)")
    parser.add_argument("--walks", type=int, default=1000, help="walks for the mean clique (1000)")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    print(HEADER)
    as_reckoned = 0
    for row in TABLE_1:
        found = measure(row, arguments.runs, arguments.walks, arguments.seed)
        print_row(row, found)
        as_reckoned += found.as_reckoned
    updates = arguments.runs * len(TABLE_1)
    print(f"pyAgrum's largest clique is the one reckoned before in {as_reckoned} of {updates} runs")


HEADER = (
    f"{'':>12} | {'largest clique, cells':^54} | {'seconds':^17}\n"
    f"{'|H|':>4} {'length':>7} | {'paper':>8} {'elsewhere':>10} {'runs here':>10} "
    f"{'many walks':>11} {'+- of ten':>11} | {'paper':>8} {'here':>8}"
)


def print_row(row: Published, found: Measured) -> None:
    elsewhere = row.states * REPRODUCED[row.explored]
    print(
        f"{row.states:>4} {row.explored:>7} | {row.clique:>8} {elsewhere:>10} "
        f"{found.clique:>10.0f} "
        f"{found.many:>11.0f} {found.scatter_of_ten:>11.0f} | "
        f"{row.seconds:>8.1f} {found.seconds:>8.4f}",
        flush=True,
    )


if __name__ == "__main__":
    main()
