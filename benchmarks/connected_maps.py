"""How long exact updates of the belief over all connected maps take.

Usage: ``python -m benchmarks.connected_maps [--largest 10] [--longest 64] [--without-baselines]``

Prints a line for each square grid and for each grid 8 lines wide: a fresh update, then one more
reading at a junction in the middle: the log evidence and that junction's marginals, a
neighbour's, all of them. Then what evidence costs that is not local, what the stored tables save,
and the 4 by 4 update beside a list of all 3,565,408 maps (marginals to 1e-9) and the paper's
network in pyAgrum and pgmpy. All in one process with the same evidence.
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from functools import partial
from pathlib import Path

import numpy as np

from benchmarks.connected_maps_baselines import (
    compare_with_listing,
    compare_with_networks,
    random_likelihood,
    seconds,
)
from bus.grid import JUNCTION_TYPES
from modules.geographer import ConnectedMaps, MapBelief, PairLikelihood
from modules.geographer.density import medium_density
from modules.geographer.table_store import tables

HEADER = (
    f"{'grid':>6} {'maps':>10} {'cells':>11} {'making':>9} {'fresh':>10} | one more reading: "
    f"{'there':>9} {'beside':>9} {'all':>10} {'of fresh':>8}"
)


def print_updates(columns: int, rows: int) -> None:
    """One line of the table of update times."""
    start = time.perf_counter()
    maps = ConnectedMaps(columns, rows)
    making_s = time.perf_counter() - start
    likelihood = random_likelihood(maps.grid)
    reading = np.random.default_rng(2).random(JUNCTION_TYPES)
    x, y = columns // 2, rows // 2
    repeats = 200 if maps.update_cells < 1e6 else 30 if maps.update_cells < 1e8 else 5
    belief = maps.posterior(likelihood).update(x, y, reading)
    belief.junctions  # noqa: B018

    def updated() -> MapBelief:
        return belief.update(x, y, reading)

    fresh_s = seconds(lambda: maps.posterior(likelihood).junctions, repeats)
    there_s = seconds(lambda: updated().junction(x, y), repeats)
    beside_s = seconds(lambda: updated().junction(x, y - 1), repeats)
    all_s = seconds(lambda: updated().junctions, repeats)
    print(
        f"{columns:>3}x{rows:<2} {float(maps.count):>10.3g} {maps.update_cells:>11} "
        f"{making_s * 1e3:>6.1f} ms {fresh_s * 1e3:>7.3f} ms | {'':>17} {there_s * 1e3:>6.3f} ms "
        f"{beside_s * 1e3:>6.3f} ms {all_s * 1e3:>7.3f} ms {all_s / fresh_s:>8.2f}",
        flush=True,
    )


def print_peak() -> None:
    peak_gib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(f"peak memory {peak_gib:.2f} GiB")


def print_beyond_local() -> None:
    """What a prior on the number of corridors and a pair of junctions cost."""
    print(f"{'grid':>6} {'fresh':>10} {'counted':>10} {'a pair along':>13} {'a pair across':>14}")
    table = np.random.default_rng(3).random((JUNCTION_TYPES, JUNCTION_TYPES))
    for lines in range(4, 9):
        maps = ConnectedMaps(lines, lines)
        repeats = 20 if lines < 7 else 4
        solve = partial(maps.posterior, random_likelihood(maps.grid))
        asked = [
            solve,
            partial(solve, corridor_count_weights=medium_density(maps.grid.corridors)),
            partial(solve, pairs=[PairLikelihood((1, 1), (2, 1), table)]),
            partial(solve, pairs=[PairLikelihood((1, 1), (1, 2), table)]),
        ]
        for action in asked:
            action()
        found = [seconds(action, repeats) for action in asked]
        fresh, counted, along, across = (f"{s * 1e3:.2f} ms" for s in found)
        print(f"{lines:>3}x{lines:<2} {fresh:>10} {counted:>10} {along:>13} {across:>14}")


def print_tables() -> None:
    """Tables built, stored and mapped again, in a folder of their own."""
    with tempfile.TemporaryDirectory() as folder:
        for width in (8, 9, 10):
            load = partial(tables, width, folder=Path(folder))
            first_s, again_s = seconds(load, 1), seconds(load, 3)
            print(
                f"tables of {width} lines: {first_s * 1e3:.0f} ms the first time, "
                f"{again_s * 1e3:.1f} ms from the cache folder"
            )


def main() -> None:
    parser = argparse.ArgumentParser(
        description="Time exact updates of the belief over maps.",
        epilog="Example: python -m benchmarks.connected_maps --largest 8 --longest 16",
    )
    parser.add_argument("--largest", type=int, default=10, help="lines of the largest square (10)")
    parser.add_argument("--longest", type=int, default=64, help="lines of the longest 8 wide (64)")
    parser.add_argument(
        "--without-baselines", action="store_true", help="leave out the list and the networks"
    )
    arguments = parser.parse_args()
    print(HEADER)
    for lines in range(3, arguments.largest + 1):
        print_updates(lines, lines)
    print_peak()
    for length in (8, 16, 32, 64):
        if length <= arguments.longest:
            print_updates(8, length)
    print_tables()
    print_beyond_local()
    if not arguments.without_baselines:
        compare_with_listing()
        compare_with_networks()


if __name__ == "__main__":
    main()
