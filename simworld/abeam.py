"""Where a corridor begins with a doorway: the port by what is beside the robot.

A doorway is too narrow to be heard from ahead as the end of a wall: its far jamb is there before
the near one is gone. Abeam it is plain, an interruption of the wall that begins and ends again, if
the robot is so near that its cone passes between the jambs. So a robot that could not tell its port
drives on through the junction along the left wall, comes back along the right one, listens to
either, and stands half a corridor's width before the doorway's middle. A reflex, as the approach
is (:mod:`simworld.approach`), for robots that are about to look around and must know from where.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from simworld.approach import STEP_M, Listen, Move, Stop
from simworld.motion import Pose
from simworld.ports import Ears

WIDEST_M = 1.2
"""The widest doorway whose both jambs are heard; wider ones are the ends of walls."""

BEYOND_M = 0.6
"""Further beyond the wall than this it is not the wall, nor a closed door that stands back."""

FEWEST_SILENT = 3
"""An interruption is so many places without an echo of the wall, each with one beside it: 9 cm."""

HUGS_M = 0.55
"""How far from a wall the robot drives along it: a cone of 15 degrees to either side passes the
door of 0.7 m for 40 cm of the way, from the middle of a corridor for 15 at most."""

VEERS_RAD = math.radians(45.0)
"""It turns so far to change from the middle to a wall."""

KEEPS_OFF_M = 0.5
"""The robot does not drive on where something in its way is nearer than this."""


@dataclass(frozen=True)
class Abeam:
    """Where the robot is after it looked, and where the port is from there, along its heading.

    ``port_m`` is None where it heard no doorway; ``begun_m`` is where it began.
    """

    pose: Pose
    begun_m: float
    port_m: float | None


@dataclass(frozen=True)
class _Pass:
    """What was heard of one wall along a stretch of the way: by the count of it, and how far."""

    pose: Pose
    way_m: tuple[float, ...]
    side_m: tuple[float, ...]


def look_abeam(stop: Stop, ears: Ears, listen: Listen, move: Move) -> Abeam:
    """Drive on until every doorway has been abeam whose port may be here, and come back."""
    expected = stop.expected
    half_m = expected.width_m / 2.0
    to_left_m, to_right_m = (
        max(0.0, wall_m - HUGS_M) for wall_m in (stop.to_left_m, stop.to_right_m)
    )
    first_m = min(0.0, expected.first_m + half_m - WIDEST_M / 2.0)
    last_m = expected.last_m + half_m + WIDEST_M / 2.0
    pose = _sideways(move(stop.pose, first_m, 0.0), to_left_m, move)
    out = _along(pose, first_m, last_m, ears.left, ears.ahead, listen, move)
    pose = _sideways(out.pose, -to_left_m - to_right_m, move)
    back = _along(pose, out.way_m[-1], first_m, ears.right, ears.behind, listen, move)
    middles_m = [
        middle
        for way, to_wall_m in (
            (out, stop.to_left_m - to_left_m),
            (back, stop.to_right_m - to_right_m),
        )
        for middle in interruptions_m(way.way_m, way.side_m, to_wall_m + BEYOND_M)
    ]
    ports_m = [at_m - half_m for at_m in middles_m if expected.is_near(at_m - half_m)]
    nearest_m = min(ports_m, key=expected.off_m, default=None)
    at_m = back.way_m[-1]
    return Abeam(
        _sideways(back.pose, to_right_m, move),
        -at_m,
        None if nearest_m is None else nearest_m - at_m,
    )


def _sideways(pose: Pose, left_m: float, move: Move) -> Pose:
    """Be so far to the left, and neither ahead nor behind: back, veer, on, and straight again."""
    turn_rad = math.copysign(VEERS_RAD, left_m)
    pose = move(pose, -abs(left_m) / math.tan(VEERS_RAD), 0.0)
    pose = move(pose, 0.0, turn_rad)
    pose = move(pose, abs(left_m) / math.sin(VEERS_RAD), 0.0)
    return move(pose, 0.0, -turn_rad)


def _along(
    pose: Pose, from_m: float, to_m: float, side: int, way: int, listen: Listen, move: Move
) -> _Pass:
    """Drive along a wall, on or back, until something is in the way.

    ``side`` and ``way`` are the transducers that look to the wall and to where it drives.
    """
    step_m = math.copysign(STEP_M, to_m - from_m)
    way_m, side_m, free_m = [from_m], [], [math.inf]
    while True:
        ranges_m = listen(pose)
        side_m.append(float(ranges_m[side]))
        free_m.append(float(ranges_m[way]))
        # Twice, for one near echo may be another's.
        if (way_m[-1] - to_m) * step_m >= 0.0 or all(m < KEEPS_OFF_M for m in free_m[-2:]):
            return _Pass(pose, tuple(way_m), tuple(side_m))
        pose = move(pose, step_m, 0.0)
        way_m.append(way_m[-1] + step_m)


def interruptions_m(way_m: Sequence[float], side_m: Sequence[float], gone_m: float) -> list[float]:
    """The middles of the interruptions in one wall, by the count of the way.

    ``side_m`` is what the transducer abeam heard at each place, nan for no echo; beyond
    ``gone_m`` it is not the wall. What begins before the first place or ends after the last does not count.
    """
    silent = [not range_m <= gone_m for range_m in side_m]
    # A single echo among silent places is another's, a single silent place a lost echo.
    silent = [sum(silent[max(0, k - 1) : k + 2]) >= 2 for k in range(len(silent))]
    starts = [k for k in range(1, len(silent)) if silent[k] and not silent[k - 1]]
    found = []
    for first in starts:
        beyond = next((k for k in range(first, len(silent)) if not silent[k]), None)
        if beyond is not None and beyond - first >= FEWEST_SILENT:
            found.append((way_m[first] + way_m[beyond - 1]) / 2.0)
    return found
