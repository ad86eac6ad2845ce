"""Doorways and clutter: their outlines by hand, what they echo, and what is refused."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.grid import Grid
from scenarios.ground import draw_ground, generator
from scenarios.scenario import ScenarioError, check
from simworld.building import Building, BuildingError, build
from simworld.fittings import Clutter, Doorway, Side, fitted
from simworld.settings import SonarSettings, ring_of
from simworld.sonar import SonarRing, true_ranges_m

RING = SonarRing()
EAST, NORTH = 0, 2  # of the corridors of a 2 by 2 grid: south row, west column


def square() -> Building:
    """Four corridors 2 m wide around a block: centres at 0 and 20."""
    return build([0.0, 20.0], [0.0, 20.0], np.ones(4, np.uint8), 2.0)


def area_m2(building: Building) -> float:
    """Free area by the shoelace rule: the free space is on the left of every wall."""
    x0, y0, x1, y1 = building.walls.T
    return float((x0 * y1 - x1 * y0).sum() / 2)


@pytest.mark.parametrize(
    ("corridor", "side", "jambs", "back"),
    [
        (EAST, "left", [(4.55, 1.0), (5.45, 1.0)], [(4.55, 1.5), (5.45, 1.5)]),
        (EAST, "right", [(4.55, -1.0), (5.45, -1.0)], [(4.55, -1.5), (5.45, -1.5)]),
        (NORTH, "left", [(-1.0, 4.55), (-1.0, 5.45)], [(-1.5, 4.55), (-1.5, 5.45)]),
        (NORTH, "right", [(1.0, 4.55), (1.0, 5.45)], [(1.5, 4.55), (1.5, 5.45)]),
    ],
)
def test_a_doorway_by_hand(
    corridor: int, side: Side, jambs: list[tuple[float, float]], back: list[tuple[float, float]]
) -> None:
    bare = square()
    built = fitted(bare, [Doorway(corridor, 5.0, side, depth_m=0.5)])
    new = {tuple(c) for c in built.corners.round(9).tolist()}
    assert new - {tuple(c) for c in bare.corners.round(9).tolist()} == {*jambs, *back}
    assert len(built.walls) == len(bare.walls) + 4
    assert area_m2(built) == pytest.approx(area_m2(bare) + 0.9 * 0.5)
    x, y = np.mean([*jambs, *back], axis=0)
    assert built.clearance_m(x, y) == pytest.approx(0.25)
    assert bare.clearance_m(x, y) < 0.0


def test_a_box_by_hand() -> None:
    bare = square()
    built = fitted(bare, clutter=[Clutter(EAST, 8.0, -0.7, length_m=0.6, width_m=0.4)])
    corners = {tuple(c) for c in built.corners[-4:].round(9).tolist()}
    assert corners == {(7.7, -0.9), (7.7, -0.5), (8.3, -0.5), (8.3, -0.9)}
    assert area_m2(built) == pytest.approx(area_m2(bare) - 0.6 * 0.4)
    assert built.clearance_m(8.0, -0.7) < 0.0
    assert built.clearance_m(8.0, 0.0) == pytest.approx(0.5)


@given(
    st.sampled_from([EAST, NORTH]),
    st.floats(2.0, 18.0),
    st.sampled_from(["left", "right"]),
    st.floats(0.3, 1.5),
    st.floats(0.05, 3.0),
)
def test_any_doorway_adds_its_own_area_and_leaves_the_bare_building_alone(
    corridor: int, at_m: float, side: Side, width_m: float, depth_m: float
) -> None:
    bare = square()
    before = bare.walls.tobytes()
    built = fitted(bare, [Doorway(corridor, at_m, side, width_m, depth_m)])
    assert area_m2(built) == pytest.approx(area_m2(bare) + width_m * depth_m)
    assert bare.walls.tobytes() == before
    assert np.array_equal(built.corridors, bare.corridors)
    # every wall ends where another begins
    ends = sorted(map(tuple, built.walls[:, 2:].round(9).tolist()))
    assert ends == sorted(map(tuple, built.walls[:, :2].round(9).tolist()))


def test_jambs_echo_where_the_wall_is_a_mirror() -> None:
    # In the middle of the corridor, 3 m before the doorway's middle. A cone of 3 degrees at the
    # near jamb, 2.55 m ahead and 1 m aside, meets the wall at 67 degrees or more from its normal.
    narrow = SonarRing(transducers=1, half_angle_rad=math.radians(1.5))
    at = math.atan2(1.0, 2.55)
    bare, built = square(), fitted(square(), [Doorway(EAST, 10.0, "left")])
    assert true_ranges_m(narrow, bare, 7.0, 0.0, at)[0] == math.inf
    assert true_ranges_m(narrow, built, 7.0, 0.0, at)[0] == pytest.approx(math.hypot(1.0, 2.55))


def test_an_open_door_is_a_gap_and_a_stub_a_wall_further_off() -> None:
    stub = fitted(square(), [Doorway(EAST, 10.0, "left", width_m=1.2, depth_m=0.15)])
    room = fitted(square(), [Doorway(EAST, 10.0, "left", width_m=1.2, depth_m=4.0)])
    narrow = SonarRing(transducers=1, half_angle_rad=math.radians(5.0))
    ranges = [true_ranges_m(narrow, b, 10.0, 0.0, math.pi / 2)[0] for b in (square(), stub, room)]
    assert ranges == pytest.approx([1.0, 1.15, 5.0])


def test_a_box_is_heard_before_the_wall() -> None:
    built = fitted(square(), clutter=[Clutter(EAST, 10.0, 0.7)])
    assert true_ranges_m(RING, built, 10.0, 0.0, 0.0)[6] == pytest.approx(0.5)
    assert true_ranges_m(RING, square(), 10.0, 0.0, 0.0)[6] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("doorway", "says"),
    [
        (Doorway(9, 5.0, "left"), r"doorway\[0\]\.corridor: found 9"),
        (Doorway(EAST, 1.3, "left"), r"found 1\.3 m along on the left, expected a place where"),
        (Doorway(EAST, 25.0, "right"), "found 25 m along"),
        (Doorway(EAST, 5.0, "left", width_m=0.0), r"doorway\[0\]\.width_m: found 0\.0"),
        (Doorway(EAST, 5.0, "left", depth_m=math.nan), r"depth_m: found nan"),
        (Doorway(EAST, 5.0, "left", depth_m=18.5), "clear of all other walls"),
    ],
)
def test_what_is_no_doorway_is_refused(doorway: Doorway, says: str) -> None:
    with pytest.raises(BuildingError, match=says):
        fitted(square(), [doorway])


def test_two_doorways_in_one_place_are_refused() -> None:
    with pytest.raises(BuildingError, match=r"doorway\[1\]"):
        fitted(square(), [Doorway(EAST, 5.0, "left"), Doorway(EAST, 5.5, "left")])


@pytest.mark.parametrize(
    ("box", "says"),
    [
        (Clutter(EAST, 5.0, 0.4), r"left_m: found 0\.4 for a box 0\.4 m wide"),
        (Clutter(EAST, 5.0, 0.9), "clear of all other walls"),
        (Clutter(EAST, 5.0, 1.5), "inside a wall"),
        (Clutter(EAST, 5.0, 0.7, length_m=-1.0), r"length_m: found -1\.0"),
    ],
)
def test_what_is_no_clutter_is_refused(box: Clutter, says: str) -> None:
    with pytest.raises(BuildingError, match=says):
        fitted(square(), clutter=[box])


def _ground(**world: object) -> Building:
    table = {"columns_m": [0.0, 20.0], "rows_m": [0.0, 20.0]} | world
    scenario = check({"about": "a test", "world": table}, "a test")
    return draw_ground(scenario, generator(scenario)).building


def test_a_scenario_names_places_from_the_first_end_it_gives() -> None:
    one = _ground(
        doorway=[{"corridor": [[0, 0], [1, 0]], "at_m": 5.0, "side": "left"}],
        clutter=[{"corridor": [[0, 0], [0, 1]], "at_m": 5.0, "left_m": 0.7}],
    )
    two = _ground(
        doorway=[{"corridor": [[1, 0], [0, 0]], "at_m": 15.0, "side": "right"}],
        clutter=[{"corridor": [[0, 1], [0, 0]], "at_m": 15.0, "left_m": -0.7}],
    )
    assert np.array_equal(one.walls, two.walls)
    direct = fitted(square(), [Doorway(EAST, 5.0, "left")], [Clutter(NORTH, 5.0, 0.7)])
    assert np.array_equal(one.walls, direct.walls)
    assert Grid(2, 2).corridor(0, 0, 1) == NORTH


def test_a_scenario_with_a_fitting_that_does_not_fit_is_refused() -> None:
    with pytest.raises(ScenarioError, match=r"world\.doorway\[0\]: found 1 m along"):
        _ground(doorway=[{"corridor": [[0, 0], [1, 0]], "at_m": 1.0}])
    with pytest.raises(
        ScenarioError, match=r"world\.clutter\[0\]\.corridor: found .* expected two"
    ):
        _ground(clutter=[{"corridor": [[0, 0], [1, 1]], "at_m": 5.0, "left_m": 0.7}])


def test_a_scenario_sets_every_figure_of_the_ring() -> None:
    sonar = {
        "transducers": 16, "half_angle_deg": 11.25, "nearest_m": 0.2, "farthest_m": 6.0,
        "noise_share": 0.02, "noise_m": 0.02, "specular_limit_deg": 42, "dropout": 0.1,
        "cross_talk": 0.05,
    }  # fmt: skip
    table = {"columns_m": [0.0, 20.0], "rows_m": [0.0, 20.0], "sonar": sonar}
    scenario = check({"about": "a test", "world": table}, "a test")
    assert ring_of(scenario.world.sonar) == SonarRing(
        16, math.radians(11.25), 0.2, 6.0, 0.02, 0.02, math.radians(42.0), 0.1, 0.05
    )
    assert ring_of(SonarSettings()) == SonarRing()
    facts = draw_ground(scenario, generator(scenario)).facts
    assert (facts.ring.transducers, facts.ring.farthest_m) == (16, 6.0)


def test_a_wall_is_heard_up_to_the_limit_that_is_set() -> None:
    # 40 degrees from the normal of a wall 1 m off: a mirror by default, heard with 42.
    cone = {"transducers": 1, "half_angle_rad": math.radians(1.0)}
    askew = math.radians(50.0)
    smooth = SonarRing(**cone)  # type: ignore[arg-type]
    rough = SonarRing(**cone, specular_limit_rad=math.radians(42.0))  # type: ignore[arg-type]
    assert true_ranges_m(smooth, square(), 10.0, 0.0, askew)[0] == math.inf
    heard = true_ranges_m(rough, square(), 10.0, 0.0, askew)[0]
    assert heard == pytest.approx(1.0 / math.cos(math.radians(39.0)))
