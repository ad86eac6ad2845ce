"""Where a corridor begins with a doorway: the port by what is beside the robot.

A doorway is too narrow to be heard from ahead as the end of a wall: its far jamb is there before
the near one is gone. Abeam it is plain, an interruption of the wall that begins and ends again. So
a robot that could not tell its port drives on through the junction, listens to the sides where the
grid has room for a corridor, and comes back to half a corridor's width before the doorway's middle.
Where the walls are not smooth it drives near them, out along the left one and back along the right
one: from the middle the cone hears a jamb or the other of a narrow doorway all the time, from near
it passes between them. A reflex, as the approach is (:mod:`simworld.approach`), for robots that are
about to look around and must know from where.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from simworld.approach import STEP_M, Listen, Move, Stop
from simworld.motion import Pose
from simworld.ports import Ears, Floats

WIDEST_M = 1.2
"""The widest doorway whose both jambs are heard; wider ones are the ends of walls."""

BEYOND_M = 0.6
"""Further beyond the wall than this it is not the wall, nor a closed door that stands back."""

FEWEST_SILENT = 3
"""An interruption is so many places without an echo of the wall, each with one beside it: 9 cm."""

HUGS_M = 0.55
"""How far from a wall the robot drives near it: a cone of 15 degrees to either side passes a door
of 0.7 m for 40 cm of the way, from the middle of a corridor of 2 m for 15 cm."""

VEERS_RAD = math.radians(45.0)
"""It turns so far to change from the middle to a wall."""

KEEPS_OFF_M = 0.5
"""The robot does not drive on where something in its way is nearer than this."""


@dataclass(frozen=True)
class Abeam:
    """Where the robot is after it looked, and how far ahead of it are its port and its beginning.

    ``port_m`` is None where it heard no doorway.
    """

    pose: Pose
    begun_m: float
    port_m: float | None


@dataclass(frozen=True)
class _Side:
    """A side where a doorway may be: its transducer, how far its wall is, 1 for left or -1."""

    ear: int
    to_wall_m: float
    sign: float


@dataclass(frozen=True)
class _Heard:
    """What was heard on the way: the ring's echoes, by the count of the way."""

    way_m: list[float]
    ranges_m: list[Floats]

    def interruptions_m(self, ear: int, to_wall_m: float) -> list[float]:
        """The middles of the interruptions in a wall that is so far."""
        side_m = [float(ranges_m[ear]) for ranges_m in self.ranges_m]
        return interruptions_m(self.way_m, side_m, to_wall_m)


@dataclass
class _Looking:
    """A robot that looks: where it is, the count of its way, and how far aside of it."""

    ears: Ears
    listen: Listen
    move: Move
    pose: Pose
    at_m: float = 0.0
    left_m: float = 0.0

    def back(self, to_m: float) -> None:
        """Be back at a place before this one."""
        self.pose, self.at_m = self.move(self.pose, to_m - self.at_m, 0.0), to_m

    def along(self, to_m: float) -> _Heard:
        """Drive straight on, or back, until something is in the way."""
        step_m = math.copysign(STEP_M, to_m - self.at_m)
        ahead = self.ears.ahead if step_m > 0.0 else self.ears.behind
        way_m, ranges_m = [self.at_m], [self.listen(self.pose)]
        # Twice, for one near echo may be another's.
        while (to_m - way_m[-1]) * step_m > 0.0 and not (
            len(way_m) > 1 and all(heard[ahead] < KEEPS_OFF_M for heard in ranges_m[-2:])
        ):
            self.pose = self.move(self.pose, step_m, 0.0)
            way_m.append(way_m[-1] + step_m)
            ranges_m.append(self.listen(self.pose))
        self.at_m = way_m[-1]
        return _Heard(way_m, ranges_m)

    def sideways(self, left_m: float) -> None:
        """Be so far left of the middle, and no further on: back, veer, on, and straight again."""
        aside_m = left_m - self.left_m
        turn_rad = math.copysign(VEERS_RAD, aside_m)
        pose = self.move(self.pose, -abs(aside_m) / math.tan(VEERS_RAD), 0.0)
        pose = self.move(pose, 0.0, turn_rad)
        pose = self.move(pose, abs(aside_m) / math.sin(VEERS_RAD), 0.0)
        self.pose, self.left_m = self.move(pose, 0.0, -turn_rad), left_m


def look_abeam(stop: Stop, ears: Ears, listen: Listen, move: Move) -> Abeam:
    """Drive on until every doorway has been abeam whose port may be here."""
    expected = stop.expected
    half_m = expected.width_m / 2.0
    sides = [
        side
        for side, may_be in (
            (_Side(ears.left, stop.to_left_m, 1.0), expected.left),
            (_Side(ears.right, stop.to_right_m, -1.0), expected.right),
        )
        if may_be
    ]
    first_m = min(0.0, expected.first_m + half_m - WIDEST_M / 2.0)
    last_m = expected.last_m + half_m + WIDEST_M / 2.0
    looking = _Looking(ears, listen, move, stop.pose)
    if stop.smooth:
        middles_m = _from_the_middle(looking, sides, last_m, half_m)
    else:
        looking.back(first_m)
        middles_m = _from_near(looking, sides, (last_m, first_m))
    ports_m = [at_m - half_m for at_m in middles_m if expected.is_near(at_m - half_m)]
    port_m = min(ports_m, key=expected.off_m, default=None)
    at_m = looking.at_m
    return Abeam(looking.pose, -at_m, None if port_m is None else port_m - at_m)


def _from_the_middle(
    looking: _Looking, sides: Sequence[_Side], to_m: float, half_m: float
) -> list[float]:
    """The middles of the doorways heard from the middle of the corridor, both sides at once."""
    heard = looking.along(to_m)
    return [
        middle
        for side in sides
        for middle in heard.interruptions_m(side.ear, max(half_m, side.to_wall_m))
    ]


def _from_near(
    looking: _Looking, sides: Sequence[_Side], ends_m: tuple[float, float]
) -> list[float]:
    """The middles of the doorways heard from near one wall after the other, there and back."""
    found: list[float] = []
    for side, to_m in zip(sides, ends_m, strict=False):
        nearer_m = max(0.0, side.to_wall_m - HUGS_M)
        looking.sideways(side.sign * nearer_m)
        heard = looking.along(to_m)
        found += heard.interruptions_m(side.ear, side.to_wall_m - nearer_m)
    looking.sideways(0.0)
    return found


def interruptions_m(
    way_m: Sequence[float], side_m: Sequence[float], to_wall_m: float
) -> list[float]:
    """The middles of the interruptions in one wall, by the count of the way.

    ``side_m`` is what the transducer abeam heard at each place, nan for no echo; ``to_wall_m`` how
    far the wall is. What begins before the first place or ends after the last does not count.
    """
    silent = [not range_m <= to_wall_m + BEYOND_M for range_m in side_m]
    # A single echo among silent places is another's, a single silent place a lost echo.
    silent = [sum(silent[max(0, k - 1) : k + 2]) >= 2 for k in range(len(silent))]
    starts = [k for k in range(1, len(silent)) if silent[k] and not silent[k - 1]]
    found = []
    for first in starts:
        beyond = next((k for k in range(first, len(silent)) if not silent[k]), None)
        if beyond is not None and beyond - first >= FEWEST_SILENT:
            found.append((way_m[first] + way_m[beyond - 1]) / 2.0)
    return found
