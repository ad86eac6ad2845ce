"""What the ring measures beside the robot: room to go aside, and which acts lead into the open."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from modules.reactor.cone import Floats
from modules.reactor.meeting import ACTS, Body
from modules.reactor.openness import Sectors, back_is_open, open_acts, walls_m
from modules.reactor.room import BUMPER_M, WIDE, Room

SPARE_M = 0.03
"""Of the bumper's 5 cm beside the robot; what a range is in error is less, mostly."""

PINGS = 3
"""So many are looked at together."""


@dataclass(frozen=True, eq=False)
class Sides:
    """The room beside the centre line, and for each act whether the way is open, (acts,).

    ``abreast`` says whether something is where the robot would be in the middle.
    """

    room: Room
    open: Floats
    abreast: bool = False


UNSEEN = Sides(WIDE, np.zeros(len(ACTS)))
"""Where nothing was measured: as much room as in a wide corridor, and no way known to be open."""


def beside(pings: Sequence[Floats], sectors: Sectors, lateral_m: float, body: Body) -> Sides:
    """What the last few pings say to a robot so far left of the centre line.

    ``pings`` are as of :meth:`Sectors.free_m`: the shortest counts, for an echo may be missed.
    """
    free_m = np.min(np.stack(pings), axis=0)
    left_m, right_m = walls_m(free_m, sectors)
    most_m = float(body.aside_m)
    room = Room(
        min(most_m, max(0.0, left_m + lateral_m - BUMPER_M + SPARE_M)),
        min(most_m, max(0.0, right_m - lateral_m - BUMPER_M + SPARE_M)),
    )
    goals = np.array([body.goes_to_m(act, lateral_m, room.for_act(act)) for act in ACTS])
    abreast = not back_is_open(free_m, sectors, lateral_m, body)
    return Sides(room, open_acts(free_m, sectors, goals, lateral_m, body), abreast)
