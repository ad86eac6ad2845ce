"""The world of a trial: doors where the truth says there are, people who stand clear."""

import math

import numpy as np
import pytest

from bus.features import DOOR_JAMB, LEFT_SIDE, WALL_LEFT, WALL_RIGHT
from bus.grid import DIRECTIONS, EAST, JUNCTION_TYPES, OPPOSITE, SOUTH, WEST
from modules.classifier.geometry import JAMB_RATE
from scenarios.trial_junction import (
    BYSTANDER_KEEPS_OFF_M,
    BYSTANDER_RADIUS_M,
    at_port,
    bystander,
    doorway,
    jambs,
    junction,
)


def test_bystanders_stand_clear() -> None:
    building = junction(15, 2.0)
    robot = at_port(building, 1, 0.0, 0.0)
    rng = np.random.default_rng(2)
    for _ in range(50):
        ((x_m, y_m, radius_m),) = bystander(building, robot, rng)
        assert building.clearance_m(x_m, y_m) >= radius_m == BYSTANDER_RADIUS_M
        assert np.hypot(x_m - robot.x_m, y_m - robot.y_m) >= BYSTANDER_KEEPS_OFF_M


@pytest.mark.parametrize("heading", DIRECTIONS)
def test_a_doorway_is_cut_into_the_wall_at_its_place(heading: int) -> None:
    rng = np.random.default_rng(heading)
    for junction_type in (j for j in range(JUNCTION_TYPES) if j & OPPOSITE[heading]):
        bare = junction(junction_type, 1.9)
        port = at_port(bare, heading, 0.0, 0.0)
        c, s = math.cos(port.heading_rad), math.sin(port.heading_rad)
        for place in (LEFT_SIDE, LEFT_SIDE.mirrored, WALL_LEFT, WALL_RIGHT):
            if place.shows(DOOR_JAMB, junction_type, heading) is not None:
                continue
            built = junction(junction_type, 1.9, [doorway(place, heading, 1.9, rng)])
            # 4 cm behind the wall in the middle of the place there was no room, and is now.
            x, y = place.x * 0.95, place.y * (0.95 + 0.04)
            behind = port.x_m + c * x - s * y, port.y_m + s * x + c * y
            assert bare.clearance_m(*behind) < 0.0 < built.clearance_m(*behind)
            assert len(built.corners) == len(bare.corners) + 4


def test_jambs_come_at_the_rate_of_the_geometry_and_only_where_a_wall_is() -> None:
    rng = np.random.default_rng(7)
    drawn = [jambs(WEST | SOUTH, EAST, rng) for _ in range(1000)]  # open behind and to the right
    share = {place: sum(one[place] for one in drawn) / 1000 for place in drawn[0]}
    assert share.pop(LEFT_SIDE.mirrored) == 0.0
    assert len(share) == 3
    # Four standard deviations of a thousand draws.
    assert all(abs(found - JAMB_RATE) < 4 * math.sqrt(0.2 * 0.8 / 1000) for found in share.values())
