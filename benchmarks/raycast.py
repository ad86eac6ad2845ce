"""Ray casting for the simulated sonar: our compiled kernels, plain numpy and shapely, in one run.

    python -m benchmarks.raycast [--poses N]

Casts 24 beams from each of N poses in a building of about 200 wall segments and compares the
ranges before it compares the times; then times the whole ring of cones (exact nearest echoes, not
beams). Each time is the best of three. Prints milliseconds and ratios.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable
from functools import partial

import numpy as np
import shapely
from numpy.typing import NDArray

from bus.grid import Grid
from simworld.building import Building, build, random_connected
from simworld.raycast import cast_rays
from simworld.sonar import SonarRing, true_ranges_m

BEAMS: NDArray[np.float64] = np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False)
REPEATS = 3
REACH_M = 10.7
"""Ranges beyond the sonar's are inf in all three."""


def office(rng: np.random.Generator) -> Building:
    """Ten by ten grid lines 20 m apart: about 200 walls."""
    lines = [20.0 * k for k in range(10)]
    return build(lines, lines, random_connected(Grid(10, 10), 0.62, rng), 2.0)


def random_poses(building: Building, n: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Places (n, 2) in corridors, off the centre line by up to 0.6 m."""
    present = np.flatnonzero(building.corridors)
    ends = [building.grid.ends(int(c)) for c in rng.choice(present, n)]
    places = np.array([[building.position_m(*building.grid.place(e)) for e in two] for two in ends])
    share = rng.random((n, 1))
    return places[:, 0] * share + places[:, 1] * (1 - share) + rng.uniform(-0.6, 0.6, (n, 2))


def by_kernel(walls: NDArray[np.float64], poses: NDArray[np.float64]) -> NDArray[np.float64]:
    ranges = np.array([cast_rays(walls, x, y, BEAMS)[1] for x, y in poses])
    return np.where(ranges <= REACH_M, ranges, np.inf)


def by_numpy(walls: NDArray[np.float64], poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """All beams of a pose against all walls at once."""
    c, s = np.cos(BEAMS)[:, None], np.sin(BEAMS)[:, None]
    ex, ey = walls[:, 2] - walls[:, 0], walls[:, 3] - walls[:, 1]
    cross = c * ey - s * ex
    ranges = np.empty((len(poses), len(BEAMS)))
    with np.errstate(divide="ignore", invalid="ignore"):
        for i, (x, y) in enumerate(poses):
            px, py = walls[:, 0] - x, walls[:, 1] - y
            t = (px * ey - py * ex) / cross
            share = (px * s - py * c) / cross
            met = (t > 0) & (share >= 0) & (share <= 1)
            ranges[i] = np.where(met, t, np.inf).min(axis=1)
    return np.where(ranges <= REACH_M, ranges, np.inf)


def by_shapely(walls: NDArray[np.float64], poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """All beams as lines of that length; a tree of walls names the pairs that meet."""
    tips = REACH_M * np.stack([np.cos(BEAMS), np.sin(BEAMS)], axis=1)
    starts = np.repeat(poses, len(BEAMS), axis=0)
    beams = shapely.linestrings(np.stack([starts, starts + np.tile(tips, (len(poses), 1))], axis=1))
    segments = shapely.linestrings(walls.reshape(-1, 2, 2))
    beam, wall = shapely.STRtree(segments).query(beams, predicate="intersects")
    met = shapely.intersection(beams[beam], segments[wall])
    ranges = np.full(len(beams), np.inf)
    np.minimum.at(ranges, beam, shapely.distance(shapely.points(starts[beam]), met))
    return ranges.reshape(len(poses), len(BEAMS))


def best_ms(work: Callable[[], object]) -> float:
    def once() -> float:
        began = time.perf_counter()
        work()
        return 1e3 * (time.perf_counter() - began)

    return min(once() for _ in range(REPEATS))


def main() -> None:
    parser = argparse.ArgumentParser(description="Time ray casting three ways.")
    parser.add_argument("--poses", type=int, default=1000)
    rng = np.random.default_rng(1)
    building = office(rng)
    poses = random_poses(building, parser.parse_args().poses, rng)
    ways = {"kernel": by_kernel, "numpy": by_numpy, "shapely": by_shapely}
    ranges = {name: way(building.walls, poses) for name, way in ways.items()}
    for name in ("numpy", "shapely"):
        np.testing.assert_allclose(ranges[name], ranges["kernel"], rtol=1e-6, err_msg=name)
    print(f"{len(BEAMS)} beams x {len(poses)} poses x {len(building.walls)} walls, same ranges")
    times = {name: best_ms(partial(way, building.walls, poses)) for name, way in ways.items()}
    for name, ms in times.items():
        print(f"  {name:8} {ms:8.1f} ms  {ms / times['kernel']:6.1f} x")
    ring = SonarRing()
    cones = best_ms(lambda: [true_ranges_m(ring, building, x, y, 0.1) for x, y in poses])
    print(f"whole rings of cones: {cones:.1f} ms, {1e3 * cones / len(poses):.1f} us a ring")


if __name__ == "__main__":
    main()
