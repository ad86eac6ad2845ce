"""What a drive meets: somebody who walks, or a door that opens; each with its own geometry.

A meeting is advanced together with the robot, says whether they touch, what of it echoes, and
until when a decision about it can help.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol, TypeAlias

from simworld.door import Disc, Door, apart_m, echoing, meets_in_s, touches
from simworld.keeping import Beside
from simworld.people import (
    WALKED_PAST_M,
    Body,
    Person,
    RobotInCorridor,
    Walker,
    collides,
    deadline_s,
    separation,
    walked,
)

Room: TypeAlias = Callable[[float], Beside]
"""How far left and right of the centre line a robot can be, by how far along the corridor."""

BRUSHES_M = 0.3
"""Room is a robot's, radius and bumper; a person as broad walks 5 cm nearer to the wall."""


@dataclass(frozen=True)
class Met:
    """How a meeting went; ``number`` counts those who came."""

    number: int
    collided: bool
    closest_m: float
    delay_s: float


class Meeting(Protocol):
    """Something that is met. Times are seconds; ``before`` and ``robot`` frame one step."""

    number: int
    closest_m: float

    def step(
        self, before: RobotInCorridor, robot: RobotInCorridor, time_s: float, dt_s: float
    ) -> bool:
        """Move on by a step; whether it is still there."""

    def touching(self, robot: RobotInCorridor) -> bool:
        """Whether it touches the robot."""

    def heard(self, robot: RobotInCorridor) -> tuple[Disc, ...]:
        """What of it echoes."""

    def ahead_m(self, robot: RobotInCorridor) -> float:
        """How far ahead of the robot it is."""

    def react_by_s(self, robot: RobotInCorridor, time_s: float, body: Body) -> float:
        """The latest moment for a decision about it; inf if none is needed."""


class WithPerson:
    """Somebody walks towards the robot, or a thing was put down."""

    def __init__(self, number: int, person: Person, robot: RobotInCorridor, room: Room) -> None:
        self.number = number
        self.person = person
        self.closest_m = math.inf
        self._room = room
        self.walker = self._kept_off_walls(
            walked(person, None, robot, person.enters_s - 1e-9, 1e-9)
        )

    def step(
        self, before: RobotInCorridor, robot: RobotInCorridor, time_s: float, dt_s: float
    ) -> bool:
        """As :func:`simworld.people.walked`, as far as the walls let him."""
        self.walker = self._kept_off_walls(walked(self.person, self.walker, before, time_s, dt_s))
        if self.walker is None:
            return False
        self.closest_m = min(self.closest_m, separation(self.walker, robot))
        return True

    def _kept_off_walls(self, walker: Walker | None) -> Walker | None:
        """Nobody walks through a wall; who comes out of a door at the side does."""
        if walker is None or _crosses(walker):
            return walker
        left_m, right_m, _ = self._room(walker.s_m)
        wider_m = self.person.radius_m - BRUSHES_M
        y_m = max(-max(0.0, right_m - wider_m), min(max(0.0, left_m - wider_m), walker.y_m))
        return walker if y_m == walker.y_m else replace(walker, y_m=y_m)

    def touching(self, robot: RobotInCorridor) -> bool:
        """Whether he touches the robot."""
        return self.walker is not None and collides(self.person, self.walker, robot)

    def heard(self, robot: RobotInCorridor) -> tuple[Disc, ...]:
        """He is round."""
        del robot
        return (
            ()
            if self.walker is None
            else ((self.walker.s_m, self.walker.y_m, self.person.radius_m),)
        )

    def ahead_m(self, robot: RobotInCorridor) -> float:
        """How far ahead he is."""
        return math.inf if self.walker is None else self.walker.s_m - robot.s_m

    def react_by_s(self, robot: RobotInCorridor, time_s: float, body: Body) -> float:
        """Time to collision less what pulling aside takes.

        Where somebody walks and no collision threatens on the present lines, the moment they are
        abreast stands for that of the collision: the reactor cannot know that beforehand. A thing
        beside the way asks for nothing.
        """
        if self.walker is None:
            return math.inf
        at_s = deadline_s(self.person, self.walker, robot, time_s, body)
        if math.isinf(at_s) and self.person.speed_m_s > 0.0:
            in_line = replace(self.walker, y_m=robot.y_m, lateral_speed_m_s=0.0)
            at_s = deadline_s(self.person, in_line, robot, time_s, body)
        return at_s


def _crosses(walker: Walker) -> bool:
    """Whether he comes straight across from a door at the side."""
    return walker.lateral_speed_m_s != 0.0 and walker.speed_m_s == 0.0


class WithDoor:
    """A door opens into the corridor."""

    def __init__(self, number: int, door: Door) -> None:
        self.number = number
        self.closest_m = math.inf
        self._door = door
        self._time_s = door.begins_s

    def step(
        self, before: RobotInCorridor, robot: RobotInCorridor, time_s: float, dt_s: float
    ) -> bool:
        """It swings, whoever is about; gone when closed or well behind."""
        del before
        self._time_s = time_s + dt_s
        self.closest_m = min(self.closest_m, apart_m(self._door, robot, self._time_s))
        behind = self._door.at_m < robot.s_m - WALKED_PAST_M
        return self._time_s < self._door.over_s and not behind

    def touching(self, robot: RobotInCorridor) -> bool:
        """Whether the leaf touches the robot."""
        return touches(self._door, robot, self._time_s)

    def heard(self, robot: RobotInCorridor) -> tuple[Disc, ...]:
        """The edge, and the foot of the perpendicular."""
        return echoing(self._door, robot, self._time_s)

    def ahead_m(self, robot: RobotInCorridor) -> float:
        """How far ahead the hinge is."""
        return self._door.at_m - robot.s_m

    def react_by_s(self, robot: RobotInCorridor, time_s: float, body: Body) -> float:
        """When the robot would drive into the open leaf: to stop takes no time."""
        del body
        return time_s + meets_in_s(self._door, robot)
