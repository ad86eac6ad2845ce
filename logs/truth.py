"""What really was, from the truth in the log: junction types, and where the robot stood.

A visit's place is known when the robot has arrived: the true pose follows the arrival.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bus.grid import LEFT_OF, OPPOSITE, RIGHT_OF, Grid
from bus.messages import Arrival, Blocked, Message, TrueBuilding, TruePose

OPENING, FLAT_WALL, CONVEX_CORNER = range(3)
WEDGES = 8


def feature_is_there(junction_type: int, heading: int, feature: int, wedge: int) -> bool:
    """Whether X_{f,w} holds at a junction that is entered by a heading (paper, section 3).

    Wedge 0 is straight ahead, the others follow by 45 degrees counter-clockwise; the place of a
    side's opening is in 1 and 7, that of its near corner in 2 and 6, and the corridor the robot
    came by, with its walls, is in 3 to 5.
    """
    ahead = bool(junction_type & heading)
    left, right = (bool(junction_type & side[heading]) for side in (LEFT_OF, RIGHT_OF))
    behind = bool(junction_type & OPPOSITE[heading])
    table = {
        OPENING: (ahead, left, False, False, behind, False, False, right),
        FLAT_WALL: (not ahead, not left, not left, True, False, True, not right, not right),
        CONVEX_CORNER: (False, left & ahead, left, False, False, False, right, right & ahead),
    }
    return table[feature][wedge]


class Truth:
    """What the log has said so far of what really is."""

    def __init__(self) -> None:
        self.building: TrueBuilding | None = None
        self.grid: Grid | None = None
        self.types: NDArray[np.uint8] = np.zeros(0, np.uint8)
        self._place_of: dict[int, tuple[int, int]] = {}  # of a visit: intersection, heading
        self._arrived: Arrival | None = None
        self._stands: tuple[int, int] | None = None

    def hear(self, message: Message) -> int | None:
        """Take in a message about the building or the robot's way; a visit whose place it tells."""
        match message:
            case TrueBuilding() as building:
                self.building = building
                self.grid = Grid(len(building.columns_m), len(building.rows_m))
                self.types = self.grid.junction_types(building.corridors[None, :])[0]
            case Arrival() as arrival:
                self._arrived = arrival
            case TruePose() as pose if self._arrived is not None:
                self._stands = pose.place, self._arrived.heading
                return self._at(self._arrived.visit)
            case Blocked() as blocked if self._stands is not None:
                return self._at(blocked.visit)  # the robot is back where it was
        return None

    def _at(self, visit: int) -> int:
        assert self._stands is not None
        self._arrived = None
        self._place_of[visit] = self._stands
        return visit

    def place(self, visit: int) -> int | None:
        """The intersection of a visit, or None while it is not known."""
        stands = self._place_of.get(visit)
        return stands[0] if stands is not None else None

    def junction_type(self, visit: int) -> int | None:
        """The type of the junction of a visit, or None while it is not known."""
        place = self.place(visit)
        return int(self.types[place]) if place is not None and place < len(self.types) else None

    def feature(self, visit: int, feature: int, wedge: int) -> bool | None:
        """Whether a feature is there at a visit, or None while it is not known."""
        junction_type = self.junction_type(visit)
        if junction_type is None:
            return None
        return feature_is_there(junction_type, self._place_of[visit][1], feature, wedge)
