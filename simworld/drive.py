"""A drive along one corridor, and whatever is met on it.

Positions are corridor coordinates (see :mod:`simworld.people`): ``s`` from the port where the
drive began. Nothing here knows the clock: the drive is advanced to a time whenever somebody
asks, in steps of 50 ms while anyone is about and in one step otherwise.
"""

from __future__ import annotations

import math
from dataclasses import replace

from simworld.door import Disc, Door
from simworld.keeping import Beside
from simworld.meetings import Meeting, Met, Room, WithDoor, WithPerson
from simworld.people import Act, Body, Person, RobotInCorridor, advance, along_m_s

STEP_NS = 50_000_000
COLLISION_STOP_NS = 10_000_000_000
"""How long robot and person stand after they have run into each other (assumption)."""


TWO_ABREAST_M = 0.5
"""Room beside the middle, left and right together, in which two can pass each other."""

LOOKED_EVERY_M = 0.1


def wide_open(_at_m: float) -> Beside:
    """A corridor whose walls are in nobody's way."""
    return Beside(math.inf, math.inf)


class CorridorDrive:
    """The robot under way in a corridor of ``length_m`` from port to port.

    ``room`` says how far to the left and right its walls leave room for the robot.
    """

    def __init__(self, began_ns: int, length_m: float, body: Body, room: Room = wide_open) -> None:
        self.length_m = length_m
        self._body = body
        self.room = room
        self._began_ns = began_ns
        self._now_ns = began_ns
        self._act: Act = "continue"
        self._stands_until_ns = began_ns
        self.robot = RobotInCorridor(0.0, speed_m_s=body.speed_m_s, radius_m=body.radius_m)
        self.meetings: list[Meeting] = []
        self.met: list[Met] = []

    def enter(self, number: int, what: Person | Door) -> None:
        """Somebody steps into the corridor now, or a door of it begins to open."""
        if isinstance(what, Door):
            self.meetings.append(WithDoor(number, what))
        else:
            self.meetings.append(WithPerson(number, what, self.robot, self.room))

    def act(self, act: Act, now_ns: int, aside_m: float | None = None) -> None:
        """The robot does something else from now on, ``aside_m`` off the centre line."""
        self.advance_to(now_ns)
        self._act = act
        if aside_m is not None:
            self._body = replace(self._body, aside_m=max(0.0, aside_m))

    def advance_to(self, now_ns: int) -> None:
        """Bring the drive up to a time."""
        while self._now_ns < now_ns:
            step_ns = now_ns - self._now_ns
            if self.meetings:
                step_ns = min(step_ns, STEP_NS)
            elif self._stands_until_ns > self._now_ns:
                step_ns = min(step_ns, self._stands_until_ns - self._now_ns)
            self._step(step_ns)

    def _step(self, step_ns: int) -> None:
        dt_s = step_ns / 1e9
        stands = self._now_ns < self._stands_until_ns
        before = self.robot
        moved = advance(before, "stop" if stands else self._act, dt_s, self._body)
        self.robot = self._kept_off_walls(replace(moved, s_m=max(0.0, moved.s_m)))
        for meeting in tuple(self.meetings):
            self._meet(meeting, before, dt_s)
        self._now_ns += step_ns

    def _kept_off_walls(self, robot: RobotInCorridor) -> RobotInCorridor:
        """The reflex that stops at a wall on the way aside."""
        if robot.y_m == 0.0:
            return robot
        left_m, right_m, _ = self.room(robot.s_m)
        return replace(robot, y_m=max(-right_m, min(left_m, robot.y_m)))

    def _meet(self, meeting: Meeting, before: RobotInCorridor, dt_s: float) -> None:
        if not meeting.step(before, self.robot, self._now_ns / 1e9, dt_s):
            self._over(meeting, collided=False)
        elif meeting.touching(self.robot):
            self._stands_until_ns = self._now_ns + COLLISION_STOP_NS
            self._over(meeting, collided=True)

    def leave(self) -> None:
        """Whoever was met is gone."""
        for meeting in tuple(self.meetings):
            self._over(meeting, collided=False)

    def _over(self, meeting: Meeting, collided: bool) -> None:
        self.meetings.remove(meeting)
        lost_s = (self._now_ns - self._began_ns) / 1e9 - self.robot.s_m / self._body.speed_m_s
        self.met.append(Met(meeting.number, collided, meeting.closest_m, lost_s))

    def two_can_pass(self, ahead_m: float) -> bool:
        """Whether for so far ahead the middle is clear and there is room for two abreast."""
        steps = math.ceil(ahead_m / LOOKED_EVERY_M)
        room = (self.room(self.robot.s_m + k * LOOKED_EVERY_M) for k in range(steps + 1))
        return all(r.clear and r.left_m + r.right_m >= TWO_ABREAST_M for r in room)

    def heard(self) -> tuple[Disc, ...]:
        """What echoes of those who are met."""
        return tuple(disc for meeting in self.meetings for disc in meeting.heard(self.robot))

    def arrives_ns(self) -> int | None:
        """When the far port is reached if nothing changes; None while not driving ahead."""
        speed = along_m_s(self._act, self._body)
        if speed <= 0.0:
            return None
        begins_ns = max(self._now_ns, self._stands_until_ns)
        left_m = max(0.0, self.length_m - self.robot.s_m)
        return begins_ns + math.ceil(left_m / speed * 1e9)

    def react_by_ns(self, meeting: Meeting) -> int | None:
        """The latest moment for a decision about something met; None if it needs none."""
        at_s = meeting.react_by_s(self.robot, self._now_ns / 1e9, self._body)
        return None if math.isinf(at_s) else int(at_s * 1e9)
