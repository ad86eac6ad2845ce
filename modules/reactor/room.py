"""How far aside there is room, and the class of it that an act has."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from modules.reactor.meeting import ACTS, LEFT, RIGHT
from modules.reactor.react_kernels import Ints
from modules.reactor.tables import ROOMS_M

BUMPER_M = 0.3
"""From the robot's centre to a wall that it keeps clear of: its radius and 5 cm."""

_BETWEEN_M = (ROOMS_M[1:] + ROOMS_M[:-1]) / 2


class Room(NamedTuple):
    """How far left and right of the centre line the robot can go, metres; 0 to 0.65."""

    left_m: float
    right_m: float

    def for_act(self, act: str) -> float:
        """The distance aside that an act goes."""
        return self.right_m if ACTS.index(act) in RIGHT else self.left_m


WIDE = Room(float(ROOMS_M[-1]), float(ROOMS_M[-1]))


@lru_cache(maxsize=256)
def _rooms(left: int, right: int) -> Ints:
    """The class of room of each act: (acts,)."""
    rooms = np.zeros(len(ACTS), dtype=np.int64)
    rooms[list(LEFT)], rooms[list(RIGHT)] = left, right
    return rooms


def rooms_of(room: Room) -> Ints:
    """The class of the room that each act has, (acts,): the nearest of ROOMS_M."""
    left, right = (int(np.searchsorted(_BETWEEN_M, side_m)) for side_m in room)
    return _rooms(left, right)
