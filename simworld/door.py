"""A door leaf that opens from a wall into the corridor, stands open for a while, and closes.

Corridor coordinates as in :mod:`simworld.people`. The leaf is a straight smooth board: it is
heard as a mirror is, at the foot of the perpendicular if that lies on it, and at its free edge
from everywhere.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from simworld.people import EncounterError, RobotInCorridor

EDGE_M = 0.03
"""Half the thickness of the leaf, and the radius of what echoes of it (assumption)."""

Disc = tuple[float, float, float]
"""What echoes: along the corridor, left of its centre line, radius; metres."""


@dataclass(frozen=True)
class Door:
    """A door in a wall ``wall_m`` from the centre line, hinged ``at_m`` along the corridor.

    Closed, the leaf lies in the wall, its free edge towards the robot. From ``begins_s`` on it
    swings out to a right angle in ``opens_s``, stands open for ``stays_s`` and swings back.
    A leaf 0.8 m wide that opens in a second and a half is an ordinary door (assumption). Raises
    EncounterError for a leaf or times that are not positive.
    """

    begins_s: float
    at_m: float
    side: Literal["left", "right"] = "left"
    wall_m: float = 1.0
    leaf_m: float = 0.8
    opens_s: float = 1.5
    stays_s: float = 8.0

    def __post_init__(self) -> None:
        if not (self.leaf_m > 0 and self.opens_s > 0 and self.stays_s >= 0):
            raise EncounterError(
                "a door needs leaf_m > 0, opens_s > 0 and stays_s >= 0, got "
                f"{self.leaf_m}, {self.opens_s}, {self.stays_s}"
            )

    @property
    def over_s(self) -> float:
        """When it is closed again."""
        return self.begins_s + 2 * self.opens_s + self.stays_s

    def angle_rad(self, time_s: float) -> float:
        """How far it is open: 0 in the wall, a right angle straight across."""
        out = (time_s - self.begins_s) / self.opens_s
        back = (self.over_s - time_s) / self.opens_s
        return math.pi / 2 * max(0.0, min(1.0, out, back))

    def ends(self, time_s: float) -> tuple[float, float, float, float]:
        """The leaf as a segment from hinge to free edge: s, y, s, y."""
        angle, sign = self.angle_rad(time_s), 1.0 if self.side == "left" else -1.0
        s_m = self.at_m - self.leaf_m * math.cos(angle)
        return self.at_m, sign * self.wall_m, s_m, sign * (self.wall_m - self._out_m(angle))

    def _out_m(self, angle_rad: float) -> float:
        return self.leaf_m * math.sin(angle_rad)


def apart_m(door: Door, robot: RobotInCorridor, time_s: float) -> float:
    """From the robot's centre to the leaf."""
    _, s_m, y_m = _nearest(door, robot, time_s)
    return math.hypot(s_m - robot.s_m, y_m - robot.y_m)


def touches(door: Door, robot: RobotInCorridor, time_s: float) -> bool:
    """Whether the leaf touches the robot."""
    return apart_m(door, robot, time_s) < robot.radius_m + EDGE_M


def echoing(door: Door, robot: RobotInCorridor, time_s: float) -> tuple[Disc, ...]:
    """What of the leaf echoes to a robot there: its edge, and where it is a mirror; while open."""
    if door.angle_rad(time_s) == 0.0:
        return ()
    share, s_m, y_m = _nearest(door, robot, time_s)
    _, _, edge_s, edge_y = door.ends(time_s)
    edge = (edge_s, edge_y, EDGE_M)
    return (edge, (s_m, y_m, EDGE_M)) if 0.0 < share < 1.0 else (edge,)


def meets_in_s(door: Door, robot: RobotInCorridor) -> float:
    """Seconds until a robot that drives on as now touches the open leaf; inf if it never does."""
    _, _, edge_s, edge_y = door.ends(door.begins_s + door.opens_s)
    beside_m = max(0.0, edge_y - robot.y_m if door.side == "left" else robot.y_m - edge_y)
    reach_m = robot.radius_m + EDGE_M
    if beside_m >= reach_m or robot.speed_m_s <= 0.0:
        return math.inf
    way_m = edge_s - math.sqrt(reach_m**2 - beside_m**2) - robot.s_m
    return way_m / robot.speed_m_s if way_m > 0.0 else math.inf


def _nearest(door: Door, robot: RobotInCorridor, time_s: float) -> tuple[float, float, float]:
    """The leaf's point nearest to the robot: share of the way from the hinge, s, y."""
    s0, y0, s1, y1 = door.ends(time_s)
    along = (robot.s_m - s0) * (s1 - s0) + (robot.y_m - y0) * (y1 - y0)
    share = min(1.0, max(0.0, along / door.leaf_m**2))
    return share, s0 + share * (s1 - s0), y0 + share * (y1 - y0)
