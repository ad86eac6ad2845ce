"""What comes of an act: does the robot touch what comes, by the geometry of the corridor.

Robot and thing move along straight pieces, so their least separation over an encounter is
found piece by piece, exactly. Coordinates: metres ahead of and left of the place on the centre
line where the robot is when it decides.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from numba import njit

from bus.acts import ACTS as ACTS

CONTINUE = ACTS.index("continue")
LEFT = tuple(k for k, act in enumerate(ACTS) if act.endswith("left"))
RIGHT = tuple(k for k, act in enumerate(ACTS) if act.endswith("right"))

_SHARE_OF_SPEED = {"continue": 1.0, "slow": 0.5, "pass left": 0.5, "pass right": 0.5, "back up": -1}
"""How fast the acts drive ahead; the others stand."""

BEHIND_M = 0.6
"""A thing that stands is passed when it is so far behind: two radii and a little."""

GRAZE_M = 1e-9
"""Who comes exactly as near as the radii does not touch, whatever the rounding."""


class Body(NamedTuple):
    """How the robot moves, and its size; the drive speed is that of the paper's four minutes.

    Assumptions: a robot of 0.25 m radius that pulls aside to 0.65 m leaves 0.1 m to the wall of
    a corridor 2 m wide. It then misses whoever walks within 0.15 m of the centre line,
    whichever side it chose.
    """

    radius_m: float = 0.25
    speed_m_s: float = 0.085
    lateral_m_s: float = 0.3
    aside_m: float = 0.65

    def along_m_s(self, act: str) -> float:
        """Speed along the corridor while doing an act."""
        return _SHARE_OF_SPEED.get(act, 0.0) * self.speed_m_s

    def goes_to_m(self, act: str, lateral_m: float, room_m: float = math.inf) -> float:
        """Where across the corridor an act ends: 0 is the centre line, left is positive.

        ``room_m`` is how far aside the walls leave room, on the side to which the act goes.
        """
        aside_m = min(self.aside_m, room_m)
        sides = {
            "continue": 0.0,
            "slow": 0.0,
            "pull aside left": aside_m,
            "pull aside right": -aside_m,
            "pass left": aside_m,
            "pass right": -aside_m,
        }
        return sides.get(act, lateral_m)

    def across_m(
        self, act: str, lateral_m: float, elapsed_s: float, room_m: float = math.inf
    ) -> float:
        """How far left of the centre line the robot is after doing an act for a while."""
        step = self.lateral_m_s * elapsed_s
        off = self.goes_to_m(act, lateral_m, room_m) - lateral_m
        return lateral_m + max(-step, min(step, off))

    def motion(self, act: str, lateral_m: float, room_m: float = math.inf) -> Motion:
        """What doing an act is, for a robot so far left of the centre line."""
        goal_m = self.goes_to_m(act, lateral_m, room_m)
        return Motion(self.along_m_s(act), lateral_m, goal_m, self.lateral_m_s)


class Motion(NamedTuple):
    """The robot during an act: its speed ahead, and from where to where across the corridor."""

    along_m_s: float
    from_m: float
    goal_m: float
    lateral_m_s: float


class Walking(NamedTuple):
    """How people walk. One who yields sidesteps at ``notices_m`` to ``aside_m`` off the centre.

    He goes to the side that the robot leaves free, and sees ``foresees_s`` ahead that it pulls
    aside.
    """

    radius_m: float = 0.25
    sidestep_m_s: float = 0.9
    notices_m: float = 2.0
    aside_m: float = 0.75
    foresees_s: float = 1.0


@njit(cache=True)
def touches_walker(
    motion: Motion,
    yields: bool,
    ahead_m: float,
    line_m: float,
    speed_m_s: float,
    body: Body,
    walking: Walking,
) -> bool:
    """Whether a robot touches a person before he has passed.

    ``ahead_m`` how far ahead he is, ``line_m`` how far left of the centre line he walks,
    ``speed_m_s`` how fast.
    """
    closing = speed_m_s + motion.along_m_s
    passed = (ahead_m + 1.0) / closing
    arrives = abs(motion.goal_m - motion.from_m) / motion.lateral_m_s
    noticed = max((ahead_m - walking.notices_m) / closing, 0.0)
    side, beside = line_m, noticed
    if yields:
        side = _free_side_m(motion, noticed, line_m, body, walking)
        beside = noticed + abs(side - line_m) / walking.sidestep_m_s
    reach = body.radius_m + walking.radius_m - GRAZE_M
    first = min(arrives, noticed)
    last = max(arrives, beside)
    middle = max(first, min(arrives + noticed + beside - first - last, last))
    ahead, across, since = ahead_m, line_m - motion.from_m, 0.0
    for until in (first, middle, last, passed):
        at = min(until, passed)
        if at <= since:
            continue
        his = _towards(line_m, side, walking.sidestep_m_s * max(at - noticed, 0.0))
        mine = _towards(motion.from_m, motion.goal_m, motion.lateral_m_s * at)
        then, beside_m = ahead_m - closing * at, his - mine
        if _comes_within(reach, ahead, across, then, beside_m):
            return True
        ahead, across, since = then, beside_m, at
    return False


@njit(cache=True)
def touches_standing(
    motion: Motion, ahead_m: float, line_m: float, body: Body, walking: Walking
) -> bool:
    """Whether a robot touches a thing that stands before it has passed it, or ever if it waits.

    How big a thing is that was left in a corridor is not known: as big as a person, say.
    """
    reach = body.radius_m + walking.radius_m - GRAZE_M
    arrives = abs(motion.goal_m - motion.from_m) / motion.lateral_m_s
    passed = arrives
    if motion.along_m_s > 0.0:
        passed = max(arrives, (ahead_m + BEHIND_M) / motion.along_m_s)
    ahead, across = ahead_m, line_m - motion.from_m
    for at in (arrives, passed):
        mine = _towards(motion.from_m, motion.goal_m, motion.lateral_m_s * at)
        then, beside_m = ahead_m - motion.along_m_s * at, line_m - mine
        if _comes_within(reach, ahead, across, then, beside_m):
            return True
        ahead, across = then, beside_m
    return False


@njit(cache=True)
def least_separation_m(x0: float, y0: float, x1: float, y1: float) -> float:
    """Least distance from the origin of a straight piece of way."""
    dx, dy = x1 - x0, y1 - y0
    length2 = dx * dx + dy * dy
    share = 0.0
    if length2 > 0.0:
        share = min(max(-(x0 * dx + y0 * dy) / length2, 0.0), 1.0)
    x, y = x0 + share * dx, y0 + share * dy
    least: float = (x * x + y * y) ** 0.5
    return least


@njit(cache=True)
def _comes_within(reach_m: float, x0: float, y0: float, x1: float, y1: float) -> bool:
    """Whether a straight piece of way comes nearer to the origin than a distance."""
    if min(x0, x1) > reach_m or min(y0, y1) > reach_m or max(y0, y1) < -reach_m:
        return False
    near: bool = least_separation_m(x0, y0, x1, y1) < reach_m
    return near


@njit(cache=True)
def _free_side_m(
    motion: Motion, noticed_s: float, line_m: float, body: Body, walking: Walking
) -> float:
    """Where a person who yields sidesteps to: away from a robot that is aside or going there."""
    robot = _towards(motion.from_m, motion.goal_m, motion.lateral_m_s * noticed_s)
    if (motion.goal_m - robot) * robot >= 0.0:
        robot = _towards(robot, motion.goal_m, motion.lateral_m_s * walking.foresees_s)
    if abs(robot) > body.radius_m / 2:
        return -walking.aside_m if robot > 0.0 else walking.aside_m
    return walking.aside_m if line_m >= robot else -walking.aside_m


@njit(cache=True)
def _towards(value: float, goal: float, step: float) -> float:
    """``value`` moved towards ``goal`` by at most ``step``."""
    return value + min(max(goal - value, -step), step)
