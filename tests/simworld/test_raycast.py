"""The compiled geometry against plain numpy rays, very dense, and shapely's lines of sight."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from shapely.geometry import LineString, MultiLineString

from bus.grid import Grid
from simworld.building import Building, build, random_connected
from simworld.raycast import cast_rays, hear_segments, wrapped

HALF = math.radians(15.0)
SPECULAR = math.radians(22.5)
FAR = 10.7
DENSE = np.arange(0.0, 2.0 * math.pi, math.radians(0.02))


def narrow_building(seed: int) -> Building:
    """Short corridors, so that much is within range and hidden."""
    rng = np.random.default_rng(seed)
    columns_m, rows_m = np.cumsum(rng.uniform(2.5, 7.0, (2, 4)), axis=1)
    corridors = random_connected(Grid(4, 4), 0.7, rng)
    return build(columns_m.tolist(), rows_m.tolist(), corridors, 2.0)


def somewhere(building: Building, rng: np.random.Generator) -> tuple[float, float]:
    """A free point at least 0.2 m from any wall."""
    while True:
        x = rng.uniform(building.columns_m[0] - 1, building.columns_m[-1] + 1)
        y = rng.uniform(building.rows_m[0] - 1, building.rows_m[-1] + 1)
        if building.clearance_m(x, y) > 0.2:
            return x, y


def plain_rays(
    walls: NDArray[np.float64], x: float, y: float, angles: NDArray[np.float64]
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """As cast_rays: solve start + t * ray = wall, all pairs at once."""
    ray = np.stack([np.cos(angles), np.sin(angles)], axis=1)[:, None, :]
    along = (walls[:, 2:] - walls[:, :2])[None]
    start = (walls[:, :2] - [x, y])[None]
    cross = ray[..., 0] * along[..., 1] - ray[..., 1] * along[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (start[..., 0] * along[..., 1] - start[..., 1] * along[..., 0]) / cross
        share = (start[..., 0] * ray[..., 1] - start[..., 1] * ray[..., 0]) / cross
    t[~((t > 0) & (share >= 0) & (share <= 1))] = np.inf
    return t.argmin(axis=1), t.min(axis=1)


def plain_echoes(
    building: Building,
    people: NDArray[np.float64],
    x: float,
    y: float,
    axes: NDArray[np.float64],
) -> NDArray[np.float64]:
    """As hear_segments, from dense rays and lines of sight."""
    hit, t = plain_rays(building.walls, x, y, DENSE)
    along = building.walls[hit, 2:] - building.walls[hit, :2]
    ray = np.stack([np.cos(DENSE), np.sin(DENSE)], axis=1)
    sine = np.abs((ray * along).sum(axis=1)) / np.hypot(*along.T)
    echo = np.where(sine <= math.sin(SPECULAR), t, np.inf)
    for px, py, radius in people:
        ahead = (px - x) * ray[:, 0] + (py - y) * ray[:, 1]
        aside = (px - x) * ray[:, 1] - (py - y) * ray[:, 0]
        with np.errstate(invalid="ignore"):
            rim = ahead - np.sqrt(radius**2 - aside**2)
        rim = np.where(np.isnan(rim) | (ahead < 0), np.inf, rim)
        echo = np.where(rim < t, np.minimum(echo, rim), echo)
    angles, ranges = np.append(DENSE, []), echo
    walls = MultiLineString([[(a, b), (c, d)] for a, b, c, d in building.walls])
    for cx, cy in building.corners:
        near_it = (cx - (cx - x) * 1e-4, cy - (cy - y) * 1e-4)
        if not LineString([(x, y), near_it]).intersects(walls):
            angles = np.append(angles, math.atan2(cy - y, cx - x))
            ranges = np.append(ranges, math.hypot(cx - x, cy - y))
    off = np.abs(np.angle(np.exp(1j * (angles[None] - axes[:, None]))))
    nearest = np.where(off <= HALF + 1e-9, ranges[None], np.inf).min(axis=1)
    return np.where(nearest <= FAR, nearest, np.inf)


@pytest.mark.parametrize("seed", range(5))
def test_rays_agree_with_plain_numpy(seed: int) -> None:
    building = narrow_building(seed)
    x, y = somewhere(building, np.random.default_rng(seed))
    hit, t = cast_rays(building.walls, x, y, DENSE[::50])
    plain_hit, plain_t = plain_rays(building.walls, x, y, DENSE[::50])
    np.testing.assert_array_equal(hit, plain_hit)
    np.testing.assert_allclose(t, plain_t, rtol=1e-12)


def test_a_ray_into_the_open_meets_nothing() -> None:
    wall = np.array([[1.0, -1.0, 1.0, 1.0]])
    hit, t = cast_rays(wall, 0.0, 0.0, np.array([0.0, math.pi, math.pi / 2]))
    assert hit.tolist() == [0, -1, -1]
    assert t.tolist() == [1.0, math.inf, math.inf]


@pytest.mark.parametrize("seed", range(20))
def test_echoes_agree_with_dense_rays(seed: int) -> None:
    # Dense rays miss the very edge of what is seen, so they find an echo at most a little
    # farther: 0.02 degrees along a wall 10.7 m off at 22.5 degrees is 1.8 mm, and as much
    # again for a person's rim, which falls away steeply, to the root of 2 r times that.
    building, rng = narrow_building(seed), np.random.default_rng(1000 + seed)
    for _ in range(3):
        x, y = somewhere(building, rng)
        people = np.array([[*somewhere(building, rng), 0.25] for _ in range(int(rng.integers(4)))])
        people = people.reshape(-1, 3)
        axes = rng.uniform(-7.0, 7.0) + np.arange(24) * math.pi / 12
        exact = hear_segments(
            building.walls, building.corners, people, x, y, axes, HALF, SPECULAR, FAR
        )
        plain = plain_echoes(building, people, x, y, axes)
        np.testing.assert_array_equal(np.isinf(exact), np.isinf(plain))
        found = np.isfinite(exact)
        assert (exact[found] <= plain[found] + 1e-9).all()
        assert (plain[found] <= exact[found] + 0.04).all()


def test_other_cones_than_the_rings() -> None:
    # A wall at x = 1 from y = -9 to 9. A cone of +-80 degrees along +y reaches 10 degrees from
    # the wall's normal, inside the specular limit: 1 / cos(10 deg). With limit 0 only cones that
    # contain the normal hear it.
    wall, none = np.array([[1.0, -9.0, 1.0, 9.0]]), np.empty((0, 2))
    nobody = np.empty((0, 3))
    wide, mirror, corner_only = (
        hear_segments(wall, none, nobody, 0.0, 0.0, np.array([axis]), half, limit, 99.0)[0]
        for axis, half, limit in (
            (math.pi / 2, math.radians(80.0), SPECULAR),
            (0.1, 0.2, 0.0),
            (0.3, 0.2, 0.0),
        )
    )
    assert wide == pytest.approx(1.0 / math.cos(math.radians(10.0)))
    assert mirror == pytest.approx(1.0)
    assert corner_only == math.inf


@pytest.mark.parametrize("off_deg", [-14.0, 0.0, 14.0])
def test_people_where_there_are_no_walls(off_deg: float) -> None:
    # Whichever way, a cone of +-15 degrees contains the centre, so the nearest point: 3 - 0.5 m.
    for direction in np.radians(np.arange(-180, 181, 5)):
        people = np.array([[3.0 * math.cos(direction), 3.0 * math.sin(direction), 0.5]])
        axes = np.array([direction - math.radians(off_deg), direction + math.pi])
        ranges = hear_segments(
            np.empty((0, 4)), np.empty((0, 2)), people, 0.0, 0.0, axes, HALF, SPECULAR, FAR
        )
        assert ranges.tolist() == pytest.approx([2.5, math.inf])


def test_the_nearer_of_two_people_is_heard() -> None:
    people = np.array([[6.0, 0.0, 0.5], [4.0, 0.0, 0.25]])
    ranges = hear_segments(
        np.empty((0, 4)), np.empty((0, 2)), people, 0.0, 0.0, np.zeros(1), HALF, SPECULAR, FAR
    )
    assert ranges[0] == 3.75


def test_wrapped_angles() -> None:
    for angle in (-9.0, -3.2, 0.0, 3.1, 3.2, 40.0):
        assert wrapped(angle) == pytest.approx(math.remainder(angle, 2 * math.pi))
