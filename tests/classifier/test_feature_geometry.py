"""Pr(X|J) by hand for each kind of junction, and against the walls of a built one."""

import math

import numpy as np
import pytest

from bus.features import CONVEX_CORNER, DETECTORS, FLAT_WALL, OPENING
from bus.grid import DIRECTIONS, EAST, JUNCTION_TYPES, NORTH, OPPOSITE, SOUTH, WEST
from modules.classifier.geometry import HeadingError, enterable, features_present, presence_table
from modules.detectors import views
from scenarios.calibrate_detectors import at_port, junction
from simworld.building import Building
from simworld.motion import Pose

# Wedges in which a feature is, on entering northward: opening, flat wall, convex corner.
BY_HAND = {
    "dead end": (SOUTH, {4}, {0, 1, 2, 3, 5, 6, 7}, set()),
    "corridor": (NORTH | SOUTH, {0, 4}, {1, 2, 3, 5, 6, 7}, set()),
    "L left": (SOUTH | WEST, {1, 4}, {0, 3, 5, 6, 7}, {2}),
    "L right": (SOUTH | EAST, {7, 4}, {0, 1, 2, 3, 5}, {6}),
    "T left": (NORTH | SOUTH | WEST, {0, 1, 4}, {3, 5, 6, 7}, {1, 2}),
    "T right": (NORTH | SOUTH | EAST, {0, 7, 4}, {1, 2, 3, 5}, {6, 7}),
    "T end": (EAST | SOUTH | WEST, {1, 7, 4}, {0, 3, 5}, {2, 6}),
    "cross": (15, {0, 1, 4, 7}, {3, 5}, {1, 2, 6, 7}),
}


@pytest.mark.parametrize("kind", BY_HAND)
def test_features_of_each_kind_by_hand(kind: str) -> None:
    junction_type, *wedges = BY_HAND[kind]
    present = features_present(junction_type, NORTH)
    assert [set(np.flatnonzero(row).tolist()) for row in present] == wedges


@pytest.mark.parametrize("heading", DIRECTIONS)
def test_a_type_without_the_corridor_behind_shows_nothing(heading: int) -> None:
    for junction_type in range(JUNCTION_TYPES):
        behind = bool(junction_type & OPPOSITE[heading])
        assert features_present(junction_type, heading).any() == behind
        assert enterable(heading)[junction_type] == behind
    assert enterable(heading).sum() == 8


def test_turning_the_building_turns_the_features() -> None:
    turned = {NORTH: EAST, EAST: SOUTH, SOUTH: WEST, WEST: NORTH}
    for heading in DIRECTIONS:
        for junction_type in range(JUNCTION_TYPES):
            type_turned = sum(turned[d] for d in DIRECTIONS if junction_type & d)
            assert np.array_equal(
                features_present(junction_type, heading),
                features_present(type_turned, turned[heading]),
            )


def test_the_eight_types_that_can_be_entered_differ_in_their_features() -> None:
    for number, heading in enumerate(DIRECTIONS):
        rows = presence_table()[number, enterable(heading)].reshape(8, -1)
        assert len(np.unique(rows, axis=0)) == 8


# In half widths: the place of each feature. A wall's place has free space on one side of it,
# an opening's on all sides, a convex corner's on all but one quarter.
PLACES = {
    (OPENING, 0): (2, 0), (OPENING, 1): (1, 1), (OPENING, 4): (0, 0), (OPENING, 7): (1, -1),
    (FLAT_WALL, 0): (2, 0), (FLAT_WALL, 1): (1, 1), (FLAT_WALL, 2): (0, 1), (FLAT_WALL, 3): (-1, 1),
    (FLAT_WALL, 4): (0, 0), (FLAT_WALL, 5): (-1, -1), (FLAT_WALL, 6): (0, -1),
    (FLAT_WALL, 7): (1, -1),
    (CONVEX_CORNER, 1): (2, 1), (CONVEX_CORNER, 2): (0, 1), (CONVEX_CORNER, 6): (0, -1),
    (CONVEX_CORNER, 7): (2, -1),
}  # fmt: skip
FREE_QUARTERS = {OPENING: 4, FLAT_WALL: 2, CONVEX_CORNER: 3}


def _free_quarters(building: Building, port: Pose, place: tuple[int, int]) -> int:
    half_m = building.corridor_width_m / 2
    c, s = math.cos(port.heading_rad), math.sin(port.heading_rad)
    count = 0
    for ahead, left in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        x, y = place[0] * half_m + 0.01 * ahead, place[1] * half_m + 0.01 * left
        count += building.clearance_m(port.x_m + c * x - s * y, port.y_m + s * x + c * y) > 0
    return count


@pytest.mark.parametrize("heading", DIRECTIONS)
def test_features_agree_with_the_walls_of_a_building(heading: int) -> None:
    for junction_type in np.flatnonzero(enterable(heading)).tolist():
        building = junction(junction_type, 2.0)
        port = at_port(building, heading, 0.0, 0.0)
        present = features_present(junction_type, heading)
        for (feature, wedge), place in PLACES.items():
            built = _free_quarters(building, port, place) == FREE_QUARTERS[feature]
            assert present[feature, wedge] == built, (junction_type, feature, wedge)
        elsewhere = [p for p in np.ndindex(present.shape) if p not in PLACES]
        assert not any(present[p] for p in elsewhere)


def test_a_heading_is_a_direction_bit() -> None:
    with pytest.raises(HeadingError, match=r"got 3"):
        features_present(15, 3)


def test_the_last_detector_is_the_last_features_last_wedge() -> None:
    assert views.detector_code(CONVEX_CORNER, 7) == DETECTORS - 1
