"""How long one exact update of the belief over all connected maps takes.

Usage: ``python -m benchmarks.connected_maps [--largest 10] [--without-enumeration]``

Prints a line for each square grid, then does the 4 by 4 update over by listing all 3,565,408
connected maps with vectorised numpy: the same marginals to 1e-9, and the ratio of the times in
the same run.
"""

from __future__ import annotations

import argparse
import resource
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bus.grid import JUNCTION_TYPES, Grid, Maps
from modules.geographer import ConnectedMaps

Floats = NDArray[np.float64]


def seconds(action: Callable[[], object], repeats: int) -> float:
    """The median time of an action."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return float(np.median(times))


def random_likelihood(grid: Grid) -> Floats:
    """Evidence everywhere, from a fixed seed."""
    rng = np.random.default_rng(1)
    return rng.random((grid.rows, grid.columns, JUNCTION_TYPES))


def print_updates(largest: int) -> None:
    """The table of update times by size."""
    print(f"{'grid':>6} {'maps':>10} {'states':>8} {'cells':>11} {'tables':>9} {'update':>10}")
    for lines in range(3, largest + 1):
        start = time.perf_counter()
        maps = ConnectedMaps(lines, lines)
        building_s = time.perf_counter() - start
        likelihood = random_likelihood(maps.grid)
        maps.posterior(likelihood)

        def update(maps: ConnectedMaps = maps, likelihood: Floats = likelihood) -> object:
            return maps.posterior(likelihood).junctions

        update_s = seconds(update, 200 if lines < 6 else 7 if lines < 9 else 3)
        print(
            f"{lines:>3}x{lines:<2} {maps.count:>10.3g} {maps.states:>8} {maps.update_cells:>11} "
            f"{building_s * 1e3:>6.1f} ms {update_s * 1e3:>7.3f} ms"
        )
    peak_gib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(f"peak memory {peak_gib:.2f} GiB")


def list_connected_maps(grid: Grid) -> Maps:
    """All connected maps: grow the component of one corridor in every set of corridors."""
    found = []
    every = 1 << grid.corridors
    for first in range(0, every, 1 << 20):
        numbers = np.arange(first, min(first + (1 << 20), every), dtype=np.uint32)
        found.append(numbers[_connected(grid, numbers)])
    bits = np.arange(grid.corridors, dtype=np.uint32)
    return (np.concatenate(found)[:, None] >> bits & 1).astype(np.uint8)


def _connected(grid: Grid, numbers: NDArray[np.uint32]) -> NDArray[np.bool_]:
    """Which sets of corridors, one bit each, are one component and not empty."""
    reached = numbers & (~numbers + np.uint32(1))  # the lowest corridor of each set
    meeting = [
        sum(1 << c for c in range(grid.corridors) if set(grid.ends(c)) & set(grid.ends(corridor)))
        for corridor in range(grid.corridors)
    ]
    while True:
        before = reached.copy()
        for corridor, neighbours in enumerate(meeting):
            met = (reached & np.uint32(neighbours)) != 0
            reached |= met.astype(np.uint32) << np.uint32(corridor) & numbers
        if (reached == before).all():
            whole: NDArray[np.bool_] = (reached == numbers) & (numbers > 0)
            return whole


def update_by_listing(types: NDArray[np.uint8], likelihood: Floats) -> Floats:
    """Junction marginals from the listed maps' types (intersections, maps)."""
    by_type = likelihood.reshape(-1, JUNCTION_TYPES)
    weight = np.ones(types.shape[1])
    for likelihoods, column in zip(by_type, types, strict=True):
        weight *= likelihoods[column]
    sums = [np.bincount(column, weight, JUNCTION_TYPES) for column in types]
    marginals: Floats = np.reshape(sums, likelihood.shape) / weight.sum()
    return marginals


def compare_with_listing() -> None:
    """The 4 by 4 update by the frontier method and by listing every map."""
    maps = ConnectedMaps(4, 4)
    listed = list_connected_maps(maps.grid)
    if len(listed) != maps.count:
        raise SystemExit(f"listed {len(listed)} maps, but counted {maps.count}")
    types = np.ascontiguousarray(maps.grid.junction_types(listed).T)
    likelihood = random_likelihood(maps.grid)
    error = np.abs(
        update_by_listing(types, likelihood) - maps.posterior(likelihood).junctions
    ).max()
    listing_s = seconds(lambda: update_by_listing(types, likelihood), 3)
    frontier_s = seconds(lambda: maps.posterior(likelihood).junctions, 200)
    print(
        f"4x4 by listing {len(listed)} maps: {listing_s * 1e3:.0f} ms, by the frontier method "
        f"{frontier_s * 1e3:.3f} ms: {listing_s / frontier_s:.0f} times faster; "
        f"marginals differ by {error:.1e} at most"
    )
    if error > 1e-9:
        raise SystemExit("the two updates disagree")


def main() -> None:
    parser = argparse.ArgumentParser(description="Time exact updates of the belief over maps.")
    parser.add_argument("--largest", type=int, default=8, help="lines of the largest grid, to 10")
    parser.add_argument("--without-enumeration", action="store_true")
    arguments = parser.parse_args()
    print_updates(arguments.largest)
    if not arguments.without_enumeration:
        compare_with_listing()


if __name__ == "__main__":
    main()
