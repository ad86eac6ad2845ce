"""Where a corridor begins with a doorway: the port by what is beside the robot.

A doorway is too narrow to be heard from ahead as the end of a wall: its far jamb is there before
the near one is gone. Abeam it is plain, an interruption of the wall that begins and ends again. So
a robot that could not tell its port drives on through the junction, listens to both sides, and
comes back to half a corridor's width before the doorway's middle. A reflex, as the approach is
(:mod:`simworld.approach`), for robots that are about to look around and must know from where.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from simworld.approach import STEP_M, Expected, Listen, Move
from simworld.following import wall_m
from simworld.motion import Pose
from simworld.ports import GONE, Ears

WIDEST_M = 1.2
"""The widest doorway whose both jambs are heard; wider ones are the ends of walls."""

FEWEST_SILENT = 3
"""An interruption is so many places without an echo of the wall, each with one beside it: 9 cm.
Of a door of 0.7 m, a cone of 15 degrees to either side hears a jamb or the other nearly always."""

KEEPS_OFF_M = 0.5
"""The robot does not drive on where something ahead is nearer than this."""


@dataclass(frozen=True)
class Abeam:
    """Where the robot is after it drove on, how far that was, and where the port is by its count.

    ``port_m`` is from where it began, None where it heard no doorway.
    """

    pose: Pose
    driven_m: float
    port_m: float | None


def look_abeam(begins: Pose, expected: Expected, ears: Ears, listen: Listen, move: Move) -> Abeam:
    """Drive on until every doorway has been abeam whose port may be here.

    ``expected.way_m`` is how far ahead of ``begins`` the wheels say that the port is.
    """
    half_m = expected.width_m / 2.0
    last_m = expected.last_m + half_m + WIDEST_M / 2.0
    pose, driven_m = begins, 0.0
    way_m, left_m, right_m, ahead_m = [], [], [], [math.inf]
    while True:
        ranges_m = listen(pose)
        way_m.append(driven_m)
        ahead_m.append(float(ranges_m[ears.ahead]))
        left_m.append(float(ranges_m[ears.left]))
        right_m.append(float(ranges_m[ears.right]))
        # Twice, for one near echo may be another's.
        if driven_m >= last_m or all(range_m < KEEPS_OFF_M for range_m in ahead_m[-2:]):
            break
        pose, driven_m = move(pose, STEP_M, 0.0), driven_m + STEP_M
    middles_m = [
        middle
        for side_m in (left_m, right_m)
        for middle in interruptions_m(way_m, side_m, max(half_m, wall_m(side_m, half_m)))
    ]
    ports_m = [at_m - half_m for at_m in middles_m if expected.is_near(at_m - half_m)]
    return Abeam(pose, driven_m, min(ports_m, key=expected.off_m, default=None))


def interruptions_m(
    way_m: Sequence[float], side_m: Sequence[float], to_wall_m: float
) -> list[float]:
    """The middles of the interruptions in one wall, by the count of the way.

    ``side_m`` is what the transducer abeam heard at each place, nan for no echo; ``to_wall_m`` how
    far the wall is. What begins before the first place or ends after the last does not count.
    """
    silent = [not range_m <= GONE * to_wall_m for range_m in side_m]
    # A single echo among silent places is another's, a single silent place a lost echo.
    silent = [sum(silent[max(0, k - 1) : k + 2]) >= 2 for k in range(len(silent))]
    starts = [k for k in range(1, len(silent)) if silent[k] and not silent[k - 1]]
    found = []
    for first in starts:
        beyond = next((k for k in range(first, len(silent)) if not silent[k]), None)
        if beyond is not None and beyond - first >= FEWEST_SILENT:
            found.append((way_m[first] + way_m[beyond - 1]) / 2.0)
    return found
