"""People in corridors, and a robot that meets them.

Everything is in *corridor coordinates*: ``s`` metres along the corridor in the robot's
direction of travel, ``y`` metres to the left of the centre line. A person comes towards the
robot, so walks towards smaller ``s``. Motion is piecewise straight: a person who does not
yield has a closed form (:func:`position`); one who yields is stepped (:func:`walked`).

The paper (section 5) says only that an approaching object leaves "on the order of a few
seconds"; every number below is an assumption unless a source is named.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

from bus.acts import ACTS as ACTS
from bus.acts import Act as Act

_SHARE_OF_SPEED: dict[Act, float] = {
    "continue": 1.0,
    "slow": 0.5,
    "pass left": 0.5,
    "pass right": 0.5,
    "back up": -1.0,
}
"""How fast the acts drive ahead; the others stand."""

WALKED_PAST_M = 2.0
"""A person this far behind the robot has left."""


class EncounterError(ValueError):
    """A person or robot that cannot be: a negative speed, say."""


@dataclass(frozen=True)
class Body:
    """How the robot moves in a corridor.

    The drive speed makes a corridor of about 20 m last the paper's four minutes. It is so
    slow that starting and stopping count as instantaneous. Aside at 0.65 m it leaves 0.1 m to
    the wall of a corridor 2 m wide, and is clear (0.5 m) of anybody who walks within 0.15 m of
    the centre line, on whichever side.
    """

    radius_m: float = 0.25
    speed_m_s: float = 0.085
    lateral_m_s: float = 0.3
    aside_m: float = 0.65

    def __post_init__(self) -> None:
        for name in ("radius_m", "speed_m_s", "lateral_m_s"):
            if not getattr(self, name) > 0:
                raise EncounterError(f"{name} must be positive, got {getattr(self, name)}")
        if not self.aside_m >= 0:
            raise EncounterError(f"aside_m must not be negative, got {self.aside_m}")


@dataclass(frozen=True)
class RobotInCorridor:
    """Where the robot is in the corridor and how it moves at this moment."""

    s_m: float
    y_m: float = 0.0
    speed_m_s: float = 0.085
    lateral_speed_m_s: float = 0.0
    radius_m: float = 0.25


@dataclass(frozen=True)
class Person:
    """Someone who walks the corridor towards the robot, or a thing left in it (speed 0).

    ``at_m`` is where along the corridor he enters, at time ``enters_s``; ``offset_m`` the line
    he then walks on. Who comes through a door at the side first crosses from the wall
    (``door_m`` from the centre line) to that line, straight across. Speeds of people: about
    1.3 m/s on average (Bohannon, Age and Ageing 26, 1997), here 0.8 to 1.8.
    """

    enters_s: float
    at_m: float
    speed_m_s: float = 1.3
    offset_m: float = 0.0
    yields: bool = True
    radius_m: float = 0.25
    appears: Literal["ahead", "left door", "right door"] = "ahead"
    door_m: float = 1.0
    sidestep_m_s: float = 0.9
    notices_m: float = 2.0
    aside_m: float = 0.75
    foresees_s: float = 1.0

    def __post_init__(self) -> None:
        if self.speed_m_s < 0 or self.radius_m <= 0 or self.sidestep_m_s <= 0:
            raise EncounterError(
                "a person needs speed_m_s >= 0, radius_m > 0 and sidestep_m_s > 0, got "
                f"{self.speed_m_s}, {self.radius_m}, {self.sidestep_m_s}"
            )
        if self.appears != "ahead" and self.speed_m_s == 0:
            raise EncounterError("who comes through a door must walk, got speed_m_s = 0")

    @property
    def crossing_s(self) -> float:
        """Seconds from the door to the line he walks on; 0 for one who is ahead already."""
        if self.appears == "ahead":
            return 0.0
        return abs(self.offset_m - self._door_y_m) / self.speed_m_s

    @property
    def _door_y_m(self) -> float:
        return self.door_m if self.appears == "left door" else -self.door_m


@dataclass(frozen=True)
class Walker:
    """A person at a moment: position and velocity in corridor coordinates."""

    s_m: float
    y_m: float
    speed_m_s: float
    lateral_speed_m_s: float = 0.0


def position(person: Person, time_s: float) -> Walker | None:
    """Where a person who does not yield is at a time, in closed form; None before he enters."""
    since = time_s - person.enters_s
    if since < 0:
        return None
    if since < person.crossing_s:
        start = person._door_y_m
        lateral = math.copysign(person.speed_m_s, person.offset_m - start)
        return Walker(person.at_m, start + lateral * since, 0.0, lateral)
    walked_m = person.speed_m_s * (since - person.crossing_s)
    return Walker(person.at_m - walked_m, person.offset_m, -person.speed_m_s)


def walked(
    person: Person, walker: Walker | None, robot: RobotInCorridor, time_s: float, dt_s: float
) -> Walker | None:
    """The person ``dt_s`` after ``time_s``, given where he and the robot were at ``time_s``.

    One who yields sidesteps, once the robot is within ``notices_m``, to the side of the
    corridor that the robot leaves free; a robot that pulls aside he sees where it will be
    ``foresees_s`` later. Steps of 50 ms are fine: he walks 0.09 m in one.
    None before he enters and once he is ``WALKED_PAST_M`` behind the robot.
    """
    straight = position(person, time_s + dt_s)
    if straight is None or straight.s_m < robot.s_m - WALKED_PAST_M:
        return None
    crosses = straight.lateral_speed_m_s != 0
    if walker is None or crosses or not person.yields or person.speed_m_s == 0:
        return straight
    y_m = walker.y_m
    if walker.s_m > robot.s_m and separation(walker, robot) < person.notices_m:
        target = math.copysign(person.aside_m, _free_side(person, walker, robot))
        y_m = _towards(y_m, target, person.sidestep_m_s * dt_s)
    return replace(straight, y_m=y_m, lateral_speed_m_s=(y_m - walker.y_m) / dt_s)


def _free_side(person: Person, walker: Walker, robot: RobotInCorridor) -> float:
    """Positive for left: away from a robot that is aside or going there, else his own side."""
    robot_m = robot.y_m
    if robot_m * robot.lateral_speed_m_s >= 0:
        robot_m += person.foresees_s * robot.lateral_speed_m_s
    if abs(robot_m) > robot.radius_m / 2:
        return -robot_m
    return walker.y_m - robot_m


def _towards(value: float, target: float, step: float) -> float:
    """``value`` moved towards ``target`` by at most ``step``."""
    return value + max(-step, min(step, target - value))


def along_m_s(act: Act, body: Body) -> float:
    """Speed along the corridor while doing an act; negative backwards."""
    return _SHARE_OF_SPEED.get(act, 0.0) * body.speed_m_s


def advance(
    robot: RobotInCorridor, act: Act, dt_s: float, body: Body | None = None
) -> RobotInCorridor:
    """The robot after doing ``act`` for ``dt_s`` seconds.

    ``continue`` and ``slow`` drive, at full and half speed, and return to the centre line;
    ``stop`` stands; ``pull aside`` moves sideways to ``body.aside_m`` and stands there;
    ``pass`` does so at half speed and drives on there; ``back up`` reverses. Raises
    EncounterError for any other act.
    """
    body = body or Body(radius_m=robot.radius_m)
    along = along_m_s(act, body)
    sides = {
        "continue": 0.0,
        "slow": 0.0,
        "stop": robot.y_m,
        "back up": robot.y_m,
        "pull aside left": body.aside_m,
        "pull aside right": -body.aside_m,
        "pass left": body.aside_m,
        "pass right": -body.aside_m,
    }
    if act not in sides:
        raise EncounterError(f"no such act: {act!r}; expected one of {', '.join(ACTS)}")
    y_m = _towards(robot.y_m, sides[act], body.lateral_m_s * dt_s)
    lateral = (y_m - robot.y_m) / dt_s if dt_s > 0 else 0.0
    return replace(
        robot,
        s_m=robot.s_m + along * dt_s,
        y_m=y_m,
        speed_m_s=along,
        lateral_speed_m_s=lateral,
    )


def separation(walker: Walker, robot: RobotInCorridor) -> float:
    """Distance of the centres in metres."""
    return math.hypot(walker.s_m - robot.s_m, walker.y_m - robot.y_m)


def collides(person: Person, walker: Walker, robot: RobotInCorridor) -> bool:
    """Whether they touch: the centres are nearer than the two radii (0.5 m) together."""
    return separation(walker, robot) < person.radius_m + robot.radius_m


def time_to_collision_s(person: Person, walker: Walker, robot: RobotInCorridor) -> float:
    """Seconds until they touch if both go straight on as now; inf if they never do.

    Exact: the first root of ``|p + v t| = r`` for the relative position and velocity.
    """
    ps, py = walker.s_m - robot.s_m, walker.y_m - robot.y_m
    vs = walker.speed_m_s - robot.speed_m_s
    vy = walker.lateral_speed_m_s - robot.lateral_speed_m_s
    reach = person.radius_m + robot.radius_m
    c = ps * ps + py * py - reach * reach
    if c < 0:
        return 0.0
    a, half_b = vs * vs + vy * vy, ps * vs + py * vy
    root = half_b * half_b - a * c
    if half_b >= 0 or root <= 0:
        return math.inf
    # c / (-b + sqrt) rather than (-b - sqrt) / a: no cancellation when the touch is near.
    return c / (-half_b + math.sqrt(root))


def braking_s(act: Act, body: Body | None = None) -> float:
    """Seconds that an act takes to have its effect, for a robot on the centre line."""
    body = body or Body()
    return body.aside_m / body.lateral_m_s if act.startswith(("pull aside", "pass")) else 0.0


def deadline_s(
    person: Person,
    walker: Walker,
    robot: RobotInCorridor,
    time_s: float,
    body: Body | None = None,
) -> float:
    """The latest time at which a decision can still avoid the collision; inf if none threatens.

    Time to collision less what the slowest useful manoeuvre takes, which is pulling aside
    from the centre line.
    """
    slowest = max(braking_s(act, body) for act in ACTS)
    return time_s + time_to_collision_s(person, walker, robot) - slowest
