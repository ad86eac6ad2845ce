"""Pr(X|J) by hand for each kind of junction, and against the walls of a built one."""

import math

import numpy as np
import pytest

from bus.features import (
    CONCAVE_CORNER,
    CONVEX_CORNER,
    DOOR_JAMB,
    FLAT_WALL,
    OPENING,
    USUAL,
    Place,
    Wedges,
)
from bus.grid import DIRECTIONS, EAST, JUNCTION_TYPES, NORTH, OPPOSITE, SOUTH, WEST
from modules.classifier.geometry import (
    DOORWAY_RATE,
    JAMB_RATE,
    HeadingError,
    enterable,
    presence,
    presence_table,
)
from scenarios.trial_junction import at_port, junction
from simworld.building import Building
from simworld.motion import Pose

# Wedges in which a feature is, on entering northward: opening, flat wall, convex corner, concave
# corner, and those in which a door jamb may be.
BY_HAND = {
    "dead end": (SOUTH, {4}, {0, 1, 2, 3, 5, 6, 7}, set(), {1, 7}, {1, 3, 5, 7}),
    "corridor": (NORTH | SOUTH, {0, 4}, {1, 2, 3, 5, 6, 7}, set(), set(), {1, 3, 5, 7}),
    "L left": (SOUTH | WEST, {1, 4}, {0, 3, 5, 6, 7}, {2}, {7}, {3, 5, 7}),
    "L right": (SOUTH | EAST, {7, 4}, {0, 1, 2, 3, 5}, {6}, {1}, {1, 3, 5}),
    "T left": (NORTH | SOUTH | WEST, {0, 1, 4}, {3, 5, 6, 7}, {1, 2}, set(), {3, 5, 7}),
    "T right": (NORTH | SOUTH | EAST, {0, 7, 4}, {1, 2, 3, 5}, {6, 7}, set(), {1, 3, 5}),
    "T end": (EAST | SOUTH | WEST, {1, 7, 4}, {0, 3, 5}, {2, 6}, set(), {3, 5}),
    "cross": (15, {0, 1, 4, 7}, {3, 5}, {1, 2, 6, 7}, set(), {3, 5}),
}


@pytest.mark.parametrize("kind", BY_HAND)
def test_features_of_each_kind_by_hand(kind: str) -> None:
    junction_type, *wedges = BY_HAND[kind]
    present = presence(junction_type, NORTH)
    assert [set(np.flatnonzero(row).tolist()) for row in present] == wedges
    assert set(present[:DOOR_JAMB].ravel().tolist()) == {0.0, 1.0}
    assert set(present[DOOR_JAMB].tolist()) <= {0.0, JAMB_RATE}


def test_corridors_behind_doorways_have_walls_at_their_corners_by_hand() -> None:
    assert DOORWAY_RATE == 0.1
    cross = presence_table()[DIRECTIONS.index(NORTH), 15]
    # At the far left corner meet the ways ahead and to the left: neither has a doorway, or both.
    assert cross[CONVEX_CORNER, 1] == pytest.approx(0.9 * 0.9)
    assert cross[CONCAVE_CORNER, 1] == pytest.approx(0.1 * 0.1)
    # At the near left one those to the left and behind, and the robot came through no doorway.
    assert cross[CONVEX_CORNER, 2] == pytest.approx(0.9)
    assert cross[FLAT_WALL, 2] == pytest.approx(0.1)
    l_left = presence_table()[DIRECTIONS.index(NORTH), SOUTH | WEST]
    assert l_left[CONCAVE_CORNER, 1] == pytest.approx(0.1)
    assert l_left[CONCAVE_CORNER, 7] == 1.0


@pytest.mark.parametrize("count", [4, 8, 12])
def test_a_doorway_opens_in_the_middle_of_a_side_all_the_same(count: int) -> None:
    wedges = Wedges(count)
    for (h, j, f, w), present in np.ndenumerate(presence_table(wedges)):
        place = wedges.place(f, w)
        if place is None or len(place.sides) < 2:
            assert present == pytest.approx(presence(j, DIRECTIONS[h], wedges)[f, w])


# The same of an L to the left, with other numbers of wedges: with four, side and near corner are
# one wedge, and the far corners are on both sides of wedge 0; with twelve, far corner and side
# are two, and the far wall runs on through the far left corner.
L_LEFT_BY_HAND = {
    4: ({1, 2}, {0, 3}, {1}, set(), {3}),
    6: ({1, 3}, {0, 2, 4, 5}, {2}, set(), {2, 4, 5}),
    12: ({2, 6}, {0, 1, 5, 7, 9, 10}, {3}, {11}, {5, 7, 10}),
}


@pytest.mark.parametrize("count", L_LEFT_BY_HAND)
def test_an_l_with_other_numbers_of_wedges_by_hand(count: int) -> None:
    present = presence(SOUTH | WEST, NORTH, Wedges(count))
    found = tuple(set(np.flatnonzero(row).tolist()) for row in present)
    assert found == L_LEFT_BY_HAND[count]


@pytest.mark.parametrize("heading", DIRECTIONS)
def test_a_type_without_the_corridor_behind_shows_nothing(heading: int) -> None:
    for junction_type in range(JUNCTION_TYPES):
        behind = bool(junction_type & OPPOSITE[heading])
        assert presence(junction_type, heading).any() == behind
        assert enterable(heading)[junction_type] == behind
    assert enterable(heading).sum() == 8


def test_turning_the_building_turns_the_features() -> None:
    turned = {NORTH: EAST, EAST: SOUTH, SOUTH: WEST, WEST: NORTH}
    for heading in DIRECTIONS:
        for junction_type in range(JUNCTION_TYPES):
            type_turned = sum(turned[d] for d in DIRECTIONS if junction_type & d)
            assert np.array_equal(
                presence(junction_type, heading),
                presence(type_turned, turned[heading]),
            )


@pytest.mark.parametrize("count", [4, 5, 6, 8, 12, 16, 24, 100])
def test_the_eight_types_that_can_be_entered_differ_in_their_features(count: int) -> None:
    for number, heading in enumerate(DIRECTIONS):
        rows = presence_table(Wedges(count))[number, enterable(heading)].reshape(8, -1)
        assert len(np.unique(rows, axis=0)) == 8


# Around the place of a feature, how many of the four quarters are free.
FREE_QUARTERS = {OPENING: 4, FLAT_WALL: 2, CONVEX_CORNER: 3, CONCAVE_CORNER: 1, DOOR_JAMB: 2}


def _free_quarters(building: Building, port: Pose, place: Place) -> int:
    half_m = building.corridor_width_m / 2
    c, s = math.cos(port.heading_rad), math.sin(port.heading_rad)
    count = 0
    for ahead, left in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        x, y = place.x * half_m + 0.01 * ahead, place.y * half_m + 0.01 * left
        count += building.clearance_m(port.x_m + c * x - s * y, port.y_m + s * x + c * y) > 0
    return count


@pytest.mark.parametrize("count", [4, 8, 12, 16])
@pytest.mark.parametrize("heading", DIRECTIONS)
def test_features_agree_with_the_walls_of_a_building(heading: int, count: int) -> None:
    wedges = Wedges(count)
    for junction_type in np.flatnonzero(enterable(heading)).tolist():
        building = junction(junction_type, 2.0)
        port = at_port(building, heading, 0.0, 0.0)
        present = presence(junction_type, heading, wedges)
        for feature, wedge in np.ndindex(present.shape):
            place = wedges.place(feature, wedge)
            if place is None or feature not in place.holds:
                assert present[feature, wedge] == 0.0
                continue
            built = _free_quarters(building, port, place) == FREE_QUARTERS[feature]
            chance = JAMB_RATE if feature == DOOR_JAMB else 1.0
            assert present[feature, wedge] == chance * built, (junction_type, feature, wedge)


def test_a_heading_is_a_direction_bit() -> None:
    with pytest.raises(HeadingError, match=r"got 3"):
        presence(15, 3)


def test_the_usual_wedges_are_eight() -> None:
    assert np.array_equal(presence(15, EAST), presence(15, EAST, Wedges(8)))
    assert USUAL.count == 8
