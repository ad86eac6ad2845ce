"""What else could answer for the 4 by 4 grid: every map in a list, and the paper's network.

Used by ``benchmarks.connected_maps``.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bus.grid import JUNCTION_TYPES, Grid, Maps
from modules.geographer import ConnectedMaps, PairLikelihood
from modules.geographer.paper import PaperNetwork, corridor_features, declare
from modules.geographer.paper.drawing import draw_hypotheses
from modules.geographer.paper.junction_tree import JunctionTree, pgmpy_posterior

Floats = NDArray[np.float64]

PAPER_S = {10: 92.2, 20: 148.0, 30: 238.3}
"""Table 1 of the paper: seconds of an update by number of states of H, four junctions explored."""

READINGS = np.array([[0.9, 0.1], [0.2, 0.8]])
"""Pr(S|X) of the features whose parents are two neighbours."""


def seconds(action: Callable[[], object], repeats: int) -> float:
    """The least time of an action: what else the machine does can only add to it."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return min(times)


def random_likelihood(grid: Grid) -> Floats:
    """Evidence everywhere, from a fixed seed."""
    rng = np.random.default_rng(1)
    return rng.random((grid.rows, grid.columns, JUNCTION_TYPES))


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


def compare_with_networks() -> None:
    """The 4 by 4 update beside the paper's network, all given the same evidence.

    The singly connected network has evidence at every junction, the multiply connected one also a
    reading for each corridor's feature, whose parents are the junctions at its ends.
    """
    maps = ConnectedMaps(4, 4)
    grid, rng = maps.grid, np.random.default_rng(1)
    likelihood, nothing = random_likelihood(grid), np.ones((4, 4, JUNCTION_TYPES))
    features = corridor_features(grid, READINGS)
    read = {feature.name: int(rng.integers(2)) for feature in features}
    pairs = [
        PairLikelihood(
            grid.place(feature.junctions[0]),
            grid.place(feature.junctions[1]),
            np.stack([1.0 - feature.present, feature.present], axis=2)
            @ READINGS[:, read[feature.name]],
        )
        for feature in features
    ]
    single_s = seconds(lambda: maps.posterior(likelihood).junctions, 200)
    multiple_s = seconds(lambda: maps.posterior(likelihood, pairs=pairs).junctions, 50)
    print(
        f"4x4 over {maps.count} maps: {single_s * 1e3:.3f} ms; with evidence about "
        f"{len(pairs)} pairs of neighbours {multiple_s * 1e3:.2f} ms"
    )
    print(f"{'|H|':>4} {'pyAgrum':>10} {'pgmpy':>10} {'pyAgrum, pairs':>15} {'paper, pairs':>13}")
    for states, paper_s in PAPER_S.items():
        hypotheses = draw_hypotheses(maps.posterior(nothing), states, rng)
        single = PaperNetwork(hypotheses)
        declared = declare(single)
        tree, joined = JunctionTree(single), JunctionTree(PaperNetwork(hypotheses, tuple(features)))
        joined.update(nothing)
        tree_s = seconds(partial(tree.update, likelihood), 5)
        pgmpy_s = seconds(partial(pgmpy_posterior, single, declared, likelihood), 3)
        joined_s = seconds(partial(joined.update, likelihood, read), 2)
        print(
            f"{states:>4} {tree_s * 1e3:>7.1f} ms {pgmpy_s * 1e3:>7.0f} ms {joined_s:>13.2f} s "
            f"{paper_s:>11.1f} s",
            flush=True,
        )
