"""What really was, from the truth in the log: junction types, and where the robot stood.

A visit's place is known when the robot has arrived: the true pose follows the arrival.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bus.features import USUAL, Wedges
from bus.grid import Grid
from bus.messages import Arrival, AtErrand, Blocked, Message, Reading, TrueBuilding, TruePose


def feature_is_there(
    junction_type: int, heading: int, feature: int, wedge: int, wedges: Wedges = USUAL
) -> bool | None:
    """Whether X_{f,w} holds at a junction that is entered by a heading (paper, section 3).

    None where the type does not say it: whether there is a door in a wall. Raises WedgeError.
    """
    place = wedges.place(feature, wedge)
    return False if place is None else place.shows(feature, junction_type, heading)


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
            case Blocked() | AtErrand(here=True) as again if self._stands is not None:
                return self._at(again.visit)  # the robot is back, or still, where it was
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

    def feature(self, reading: Reading) -> bool | None:
        """Whether the feature that was looked for is there, or None if that is not known."""
        junction_type = self.junction_type(reading.visit)
        if junction_type is None:
            return None
        heading, wedges = self._place_of[reading.visit][1], Wedges(reading.wedges)
        return feature_is_there(junction_type, heading, reading.feature, reading.wedge, wedges)
