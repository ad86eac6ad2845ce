"""Echoes by hand in simple places; noise, dropouts and cross-talk by their statistics.

Transducer i points at heading + i * 15 degrees; its cone reaches 15 degrees to both sides.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from bus.grid import EAST, NORTH, SOUTH, WEST, Grid
from simworld.building import Building, build
from simworld.sonar import SonarError, SonarRing, echoes, true_ranges_m

RING = SonarRing()
CORNER = math.sqrt(2.0)  # from the centre of a square of 2 m to its corner
# A wall 1 m off, seen at the edge of a cone that ends 15 degrees from the wall's normal.
SLANTED = 1.0 / math.cos(math.radians(15.0))


def junction(junction_type: int, arm_m: float = 30.0) -> Building:
    """A building around a junction of this type at the origin, with arms beyond the range."""
    grid = Grid(3, 3)
    corridors = np.zeros(grid.corridors, np.uint8)
    for direction in (NORTH, EAST, SOUTH, WEST):
        if junction_type & direction:
            corridors[grid.corridor(1, 1, direction)] = 1
    return build([-arm_m, 0.0, arm_m], [-arm_m, 0.0, arm_m], corridors, 2.0)


def expected(ranges: dict[int, float]) -> NDArray[np.float64]:
    return np.array([ranges.get(i, math.inf) for i in range(24)])


def at_centre(junction_type: int) -> NDArray[np.float64]:
    return true_ranges_m(RING, junction(junction_type), 0.0, 0.0, 0.0)


def corners(*axes: int) -> dict[int, float]:
    """Corners along the axes of these transducers, which the cones beside just reach, too."""
    return {(i + k) % 24: CORNER for i in axes for k in (-1, 0, 1)}


def closed(*middles: int) -> dict[int, float]:
    """Walls 1 m off with their normals along these transducers.

    The three cones that contain the normal hear it at 1 m; the next ones reach to 15 degrees of
    it, and hear that nearer than a corner.
    """
    near = {(m + k) % 24: 1.0 for m in middles for k in (-1, 0, 1)}
    return {(m + k) % 24: SLANTED for m in middles for k in (-2, 2)} | near


# Corners of the square lie at 45, 135, 225, 315 degrees: on the axes of 3, 9, 15 and 21. Where
# one of the two sides that meet there is closed and the other open, the wall runs straight on
# and there is no corner: two open sides meet in a convex one, two closed sides in a concave one.


def test_cross() -> None:
    # Four open arms of 29 m: nothing there within 10.7 m.
    np.testing.assert_allclose(at_centre(15), expected(corners(3, 9, 15, 21)))


def test_tee() -> None:
    # No exit north: the wall at y = 1 along both arms, the corners south-west and south-east.
    found = at_centre(EAST | SOUTH | WEST)
    np.testing.assert_allclose(found, expected(corners(15, 21) | closed(6)))


def test_ell() -> None:
    # Exits north and east: walls west (transducer 12) and south (18), a convex corner between
    # the exits, a concave one across. The latter alone is heard by 15, between the two walls.
    found = at_centre(NORTH | EAST)
    np.testing.assert_allclose(found, expected(corners(3, 15) | closed(12, 18)))


def test_dead_end() -> None:
    found = at_centre(WEST)
    np.testing.assert_allclose(found, expected(corners(3, 21) | closed(0, 6, 18)))


def test_corridor_sides() -> None:
    # Walls 1 m to the north and south, no corner within range.
    ranges = true_ranges_m(RING, junction(EAST | WEST), 15.0, 0.0, 0.0)
    np.testing.assert_allclose(ranges, expected(closed(6, 18)))


def test_ring_turns_with_the_robot() -> None:
    tee = junction(EAST | SOUTH | WEST)
    for steps in (1, 5, 18):
        turned = true_ranges_m(RING, tee, 0.0, 0.0, steps * math.pi / 12)
        np.testing.assert_allclose(turned, np.roll(at_centre(EAST | SOUTH | WEST), -steps))


def test_specular_loss() -> None:
    # Facing a wall 1 m off at 30 degrees from its normal with a cone of 1 degree: incidence
    # 29 degrees at least, more than 22.5, so the wall is a mirror. At 20 degrees it echoes from
    # the cone's near edge, 19 degrees off the normal.
    narrow = SonarRing(transducers=1, half_angle_rad=math.radians(1.0))
    corridor = junction(EAST | WEST)
    lost = true_ranges_m(narrow, corridor, 15.0, 0.0, math.radians(60.0))
    heard = true_ranges_m(narrow, corridor, 15.0, 0.0, math.radians(70.0))
    assert lost[0] == math.inf
    assert heard[0] == pytest.approx(1.0 / math.cos(math.radians(19.0)))


def test_corner_is_heard_where_the_wall_is_not() -> None:
    # 4 m west of a cross's centre, facing it: the junction's near corners are 3 m ahead, 1 m
    # to the side: sqrt(10) m at 18.4 degrees, in the cones of transducers 1 (0..30) and 2
    # (15..45), not of 0 (-15..15). The far corners, 5 m ahead and 1 m aside, lie at 11.3
    # degrees, in the cones of 0 and 1: sqrt(26) m.
    ranges = true_ranges_m(RING, junction(15), -4.0, 0.0, 0.0)
    assert ranges[0] == pytest.approx(math.sqrt(26.0))
    assert ranges[1] == pytest.approx(math.sqrt(10.0))
    assert ranges[2] == pytest.approx(math.sqrt(10.0))


def test_wall_hides_the_corner_behind_it() -> None:
    # From (-4, 0) the cross's north arm is seen only through the square: its far end's corner
    # (1, 5) lies behind the near corner (-1, 1): the line to it passes x = -1 at y = 3, in the
    # wall. With the arm's end at y = 5, an unhidden corner would answer transducer 3 (45 deg).
    short = build([-30.0, 0.0, 30.0], [-4.0, 0.0, 4.0], cross_corridors(), 2.0)
    assert [1.0, 5.0] in short.corners.tolist()
    ranges = true_ranges_m(RING, short, -4.0, 0.0, 0.0)
    assert ranges[3] == math.inf
    # From the square's centre the same corner is in sight at atan(5) = 78.7 degrees, but the
    # end's wall is nearer, 5 m ahead of transducer 6.
    centre = true_ranges_m(RING, short, 0.0, 0.0, 0.0)
    assert centre[6] == pytest.approx(5.0)


def cross_corridors() -> NDArray[np.uint8]:
    grid = Grid(3, 3)
    corridors = np.zeros(grid.corridors, np.uint8)
    for direction in (NORTH, EAST, SOUTH, WEST):
        corridors[grid.corridor(1, 1, direction)] = 1
    return corridors


def test_person_in_the_corridor() -> None:
    # 5 m ahead, radius 0.25 m: 4.75 m on the axis, which is also the edge of 1 and 23.
    ranges = true_ranges_m(RING, junction(EAST | WEST), 10.0, 0.0, 0.0, [(15.0, 0.0, 0.25)])
    np.testing.assert_allclose(ranges, expected(closed(6, 18) | {0: 4.75, 1: 4.75, 23: 4.75}))


def test_person_at_the_edge_of_a_cone() -> None:
    # At 4 m and 90 degrees off a single narrow cone nothing; at 5 degrees with radius 0.5 m the
    # disc spans asin(0.125) = 7.18 degrees, so a cone of 1 degree meets its rim 4 degrees off
    # centre: 4 cos 4 - sqrt(0.25 - 16 sin^2 4).
    narrow = SonarRing(transducers=1, half_angle_rad=math.radians(1.0))
    hall = junction(EAST | WEST)
    off = math.radians(5.0)
    person = (15.0 + 4.0 * math.cos(off), 4.0 * math.sin(off), 0.5)
    rim = 4.0 * math.cos(math.radians(4.0)) - math.sqrt(
        0.25 - 16.0 * math.sin(math.radians(4.0)) ** 2
    )
    assert true_ranges_m(narrow, hall, 15.0, 0.0, 0.0, [person])[0] == pytest.approx(rim)
    assert true_ranges_m(narrow, hall, 15.0, 0.0, 1.0, [person])[0] == math.inf


def test_person_round_the_corner_is_not_heard() -> None:
    # From (-4, 0), 3 m up the north arm of a cross at (0, 4): the line passes x = -1 at y = 3,
    # inside the wall. In the square, at (0, 0), the person stands in plain view.
    cross = junction(15)
    without = true_ranges_m(RING, cross, -4.0, 0.0, 0.0)
    hidden = true_ranges_m(RING, cross, -4.0, 0.0, 0.0, [(0.0, 4.0, 0.25)])
    seen = true_ranges_m(RING, cross, -4.0, 0.0, 0.0, [(0.0, 0.0, 0.25)])
    np.testing.assert_array_equal(hidden, without)
    assert seen[0] == pytest.approx(3.75)


def test_person_half_round_the_corner_is_heard_at_the_visible_rim() -> None:
    # A person of 0.5 m at (0, 2.5) seen from (-4, 0): the line of sight that grazes the corner
    # (-1, 1) has direction atan(1/3) = 18.43 degrees; the centre lies at atan(2.5/4) = 32.01
    # degrees, 4.717 m away, the disc spans asin(0.5/4.717) = 6.08 degrees: down to 25.9. Hidden.
    cross = junction(15)
    without = true_ranges_m(RING, cross, -4.0, 0.0, 0.0)
    np.testing.assert_array_equal(
        true_ranges_m(RING, cross, -4.0, 0.0, 0.0, [(0.0, 2.5, 0.5)]), without
    )
    # At (0, 1.6) the centre is at 21.80 degrees, 4.308 m away, still behind the corner, but the
    # disc spans 6.67 degrees, down to 15.1: the rim is in view along 18.43 degrees. There it is
    # 4.308 cos 3.37 - sqrt(0.25 - (4.308 sin 3.37)^2) = 4.301 - 0.431 = 3.870 m: nearer than
    # nothing else but the corner at sqrt(10), which transducers 1 and 2 hear. So listen with a
    # cone of 16.5 +- 1.5 degrees, short of the corner: the rim along its edge at 18.0 degrees.
    narrow = SonarRing(transducers=1, half_angle_rad=math.radians(1.5))
    off = math.atan2(1.6, 4.0) - math.radians(18.0)
    away = math.hypot(1.6, 4.0)
    rim = away * math.cos(off) - math.sqrt(0.25 - (away * math.sin(off)) ** 2)
    heard = true_ranges_m(narrow, cross, -4.0, 0.0, math.radians(16.5), [(0.0, 1.6, 0.5)])
    assert heard[0] == pytest.approx(rim)


def test_nothing_beyond_the_farthest_range() -> None:
    # A dead end's wall 10.6 and 10.8 m ahead.
    hall = junction(EAST | WEST)  # its end wall is at x = 31
    assert true_ranges_m(RING, hall, 31.0 - 10.6, 0.0, 0.0)[0] == pytest.approx(10.6)
    assert true_ranges_m(RING, hall, 31.0 - 10.8, 0.0, 0.0)[0] == math.inf


def test_what_is_too_near_blinds() -> None:
    quiet = SonarRing(dropout=0.0, cross_talk=1.0)
    reading = echoes(
        quiet, junction(15), 0.0, 0.0, 0.0, np.random.default_rng(3), [(0.2, 0.0, 0.1)]
    )
    assert math.isnan(reading[0])
    assert not math.isnan(reading[6])


def test_noise_statistics() -> None:
    # The person's echo at 4.75 m: sigma = 1 % of 4.75 m + 10 mm = 57.5 mm. With 4000 readings
    # the mean is within 4 * 57.5 / sqrt(4000) = 3.6 mm, the deviation within 4 / sqrt(8000) of it.
    ring = SonarRing(dropout=0.0, cross_talk=0.0)
    hall, rng = junction(EAST | WEST), np.random.default_rng(11)
    readings = np.array(
        [echoes(ring, hall, 10.0, 0.0, 0.0, rng, [(15.0, 0.0, 0.25)]) for _ in range(4000)]
    )
    assert readings[:, 0].mean() == pytest.approx(4.75, abs=0.0036)
    assert readings[:, 0].std() == pytest.approx(0.0575, rel=0.045)
    assert readings[:, 6].std() == pytest.approx(0.020, rel=0.045)
    assert abs(np.corrcoef(readings[:, 0], readings[:, 6])[0, 1]) < 4 / math.sqrt(4000)
    assert np.isnan(readings[:, 12]).all()


def test_dropout_and_cross_talk_rates() -> None:
    # 2000 pings, 10 transducers hear a wall. Lost: 2 % less the 1 % of those that cross-talk
    # fills again; 20000 * 0.0198 = 396 +- 20. Of the 14 silent ones 1 % report something.
    hall, rng = junction(EAST | WEST), np.random.default_rng(12)
    ideal = true_ranges_m(RING, hall, 15.0, 0.0, 0.0)
    readings = np.array([echoes(RING, hall, 15.0, 0.0, 0.0, rng) for _ in range(2000)])
    heard = np.isfinite(ideal)
    assert heard.sum() == 10
    assert np.isnan(readings[:, heard]).mean() == pytest.approx(0.0198, abs=0.004)
    ghosts = readings[:, ~heard]
    ghosts = ghosts[~np.isnan(ghosts)]
    assert len(ghosts) / 28000 == pytest.approx(0.01, abs=0.0024)
    # Uniform in 0.15 .. 10.7 m: mean 5.425, deviation 10.55 / sqrt(12) = 3.05.
    assert ghosts.mean() == pytest.approx(5.425, abs=4 * 3.05 / math.sqrt(len(ghosts)))
    assert ghosts.min() >= RING.nearest_m
    # Where there is a wall at 1 m a wrong reading is shorter than it, never beyond.
    assert readings[:, heard].max(initial=0.0, where=~np.isnan(readings[:, heard])) < 1.2
    wrong = readings[:, 6] < 0.9
    assert wrong.mean() == pytest.approx(0.01 * 0.75 / 0.85, abs=0.008)


def test_a_seed_gives_the_same_echoes() -> None:
    cross = junction(15)
    first, again, other = (
        echoes(RING, cross, 0.3, -0.2, 0.7, np.random.default_rng(s)) for s in (4, 4, 5)
    )
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other, equal_nan=True)


def test_draws_do_not_depend_on_what_is_heard() -> None:
    a, b = np.random.default_rng(9), np.random.default_rng(9)
    echoes(RING, junction(15), 0.0, 0.0, 0.0, a)
    echoes(RING, junction(EAST | WEST), 3.0, 0.0, 1.0, b, [(4.0, 0.0, 0.2)])
    assert a.random() == b.random()


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"transducers": 0}, "transducers, at least 1"),
        ({"half_angle_rad": 2.0}, "half_angle_rad"),
        ({"specular_limit_rad": -0.1}, "specular_limit_rad"),
        ({"nearest_m": 11.0}, "nearest_m less than farthest_m"),
        ({"noise_share": -0.1}, "noise not negative"),
        ({"dropout": 1.5}, "dropout"),
        ({"cross_talk": math.nan}, "cross_talk"),
    ],
)
def test_impossible_rings_are_refused(change: dict[str, float], says: str) -> None:
    with pytest.raises(SonarError, match=says):
        SonarRing(**change)  # type: ignore[arg-type]
