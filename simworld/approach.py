"""The last metres to an LDP: the robot follows its corridor and stops where a wall changes.

A reflex below the decision processes, by the echoes of its own firings, which nobody else hears.
It knows how wide corridors are and, by the grid and its wheels, about where the port should be.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from simworld.following import Glimpse, InCorridor, located, steering_rad, stray_share, wall_m
from simworld.motion import Pose
from simworld.ports import GONE_AFTER, Ears, end_at_m, has_ended

LOOKS_FROM_M = 1.2
"""How far before the port is expected it begins to look for it, beyond what it may err by."""

STEP_M = 0.03
"""Between two firings of the transducers it listens to: five of them, 40 ms each, take 2 cm."""

GATE = 2.5
"""A change further from where the port is expected than so many sigmas is a doorway's."""

SURE = 1.5
"""Within so many it is the port's at once; else the robot looks on for a better one."""

FAR_SIDE_M = 0.2
"""What the way across is wider or narrower than the corridor, or a cupboard stands before the far
side (standard deviation, an assumption)."""

SMOOTH_SHARE = 0.08
"""So many echoes beside may be lost, or others', and the walls be smooth all the same."""

Listen = Callable[[Pose], NDArray[np.float64]]
"""What the ring hears from a pose, (transducers,), nan for no echo."""

Move = Callable[[Pose, float, float], Pose]
"""Where a step forward and a turn, as commanded, really end."""


@dataclass(frozen=True)
class Expected:
    """What the robot knows beforehand: the way to the port by its count, and how sure it is.

    ``way_m`` from where it begins to look, ``sigma_m`` its standard deviation; ``width_m`` of
    the corridors, nominal; whether a corridor may begin ``left`` and ``right``, by the grid.
    """

    way_m: float
    sigma_m: float
    width_m: float
    left: bool = True
    right: bool = True

    def off_m(self, at_m: float) -> float:
        """How far a place is from where the port is expected."""
        return abs(at_m - self.way_m)

    def is_near(self, at_m: float) -> bool:
        """Whether a port may be there."""
        return self.off_m(at_m) <= GATE * self.sigma_m

    @property
    def first_m(self) -> float:
        """Before this there is no port yet."""
        return self.way_m - GATE * self.sigma_m

    @property
    def last_m(self) -> float:
        """Beyond this there is no port any more."""
        return self.way_m + GATE * self.sigma_m


@dataclass(frozen=True)
class Stop:
    """Where the robot stands, and how far it went beyond and came back, looking in vain.

    ``by`` is what it stopped by: ``wall ends``, ``wall ahead`` or ``wheels``; ``expected`` where
    its wheels say that the port is, from here. The corridor's walls are ``to_left_m`` and
    ``to_right_m`` from the way that it came, and ``smooth`` unless much that it heard beside was
    not of one straight wall.
    """

    pose: Pose
    beyond_m: float
    by: str
    expected: Expected
    to_left_m: float
    to_right_m: float
    smooth: bool

    @property
    def sure(self) -> bool:
        """Whether a smooth wall ends here, about where the wheels say that it should."""
        as_expected = self.expected.off_m(0.0) <= self.expected.sigma_m
        return self.smooth and self.by == "wall ends" and as_expected


@dataclass
class _Looking:
    """What was heard since the robot began to look, by its count of the way."""

    ears: Ears
    expected: Expected
    glimpses: list[Glimpse] = field(default_factory=list)
    way_m: list[float] = field(default_factory=list)
    early_left_m: list[float] = field(default_factory=list)
    early_right_m: list[float] = field(default_factory=list)
    ahead_m: list[float] = field(default_factory=list)
    ended_m: list[float] = field(default_factory=list)

    def hear(self, count: Pose, ranges_m: NDArray[np.float64]) -> None:
        ears = self.ears
        self.way_m.append(count.x_m)
        left_m, right_m = float(ranges_m[ears.left]), float(ranges_m[ears.right])
        if not self.glimpses or self.follows:  # beyond there may be no walls of the corridor
            self.glimpses.append(Glimpse(count.x_m, count.y_m, count.heading_rad, left_m, right_m))
        self.early_left_m.append(float(ranges_m[ears.early_left]))
        self.early_right_m.append(float(ranges_m[ears.early_right]))
        self.ahead_m.append(float(ranges_m[ears.ahead]))

    @property
    def follows(self) -> bool:
        """Whether the robot is still in its corridor, as far as it knows."""
        return self.way_m[-1] <= self.expected.way_m

    @property
    def through(self) -> bool:
        """Whether all is heard that can be a port's."""
        return self.way_m[-1] >= self.expected.last_m - STEP_M / 2.0

    def place(self) -> InCorridor:
        return located(self.glimpses, self.expected.width_m / 2.0)

    def walls_m(self) -> tuple[float, float]:
        """How far the walls of the corridor are, left and right."""
        half_m = self.expected.width_m / 2.0
        return (
            wall_m([glimpse.to_left_m for glimpse in self.glimpses], half_m),
            wall_m([glimpse.to_right_m for glimpse in self.glimpses], half_m),
        )

    def port_at_m(self, place: InCorridor) -> tuple[float, str] | None:
        """Where on the count the port is, and by what; None while nothing tells."""
        to_left_m, to_right_m = self.walls_m()
        if self.expected.left:
            self._note_end(self.early_left_m, to_left_m, place.askew_rad)
        if self.expected.right:
            self._note_end(self.early_right_m, to_right_m, -place.askew_rad)
        ended_m = min(self.ended_m, key=self.expected.off_m, default=None)
        if ended_m is not None and (
            self.through or self.expected.off_m(ended_m) <= SURE * self.expected.sigma_m
        ):
            return ended_m, "wall ends"
        # The end of a wall tells it better than a wall ahead, and may come as late as anything.
        end_m = end_at_m(self.way_m, self.ahead_m) if self.through else None
        if end_m is None:
            return None
        # The junction's far side is about as far from its port as the corridor is wide.
        at_m = end_m - to_left_m - to_right_m
        if not self.expected.is_near(at_m):
            return None
        trust = 1.0 / (1.0 + (FAR_SIDE_M / self.expected.sigma_m) ** 2)
        return trust * at_m + (1.0 - trust) * self.expected.way_m, "wall ahead"

    def _note_end(self, early_m: list[float], side_m: float, askew_rad: float) -> None:
        """Where the wall of one side ends, if it has just left the cone ahead of the robot."""
        # A cupboard along the wall ends, too, and the wall behind it is still there.
        if not has_ended(early_m, max(side_m, self.expected.width_m / 2.0)):
            return
        last, first = self.way_m[-GONE_AFTER - 1], self.way_m[-GONE_AFTER]
        at_m = (last + first) / 2.0 + side_m / math.tan(self.ears.leaves_rad + askew_rad)
        if self.expected.is_near(at_m):
            self.ended_m.append(at_m)


def approach(begins: Pose, expected: Expected, ears: Ears, listen: Listen, move: Move) -> Stop:
    """Drive from where the robot begins to look to where it takes the port to be.

    Where nothing tells it goes on until there can be no port any more, and comes back to where
    its wheels say that the port is.
    """
    looking = _Looking(ears, expected)
    pose, count = begins, Pose(0.0, 0.0, 0.0)
    while True:
        looking.hear(count, listen(pose))
        place = looking.place()
        found = looking.port_at_m(place)
        stops_m = found[0] if found else expected.last_m
        if count.x_m >= stops_m - STEP_M / 2.0:
            break
        turn_rad = steering_rad(place) if looking.follows else 0.0
        pose, count = move(pose, STEP_M, turn_rad), count.after(STEP_M, turn_rad)
    at_m, by = found or (expected.way_m, "wheels")
    back_m = at_m - count.x_m
    pose = move(pose, back_m, -place.askew_rad)
    return Stop(
        pose,
        max(0.0, -back_m),
        by,
        replace(expected, way_m=expected.way_m - at_m),
        *looking.walls_m(),
        stray_share(looking.glimpses) <= SMOOTH_SHARE,
    )
