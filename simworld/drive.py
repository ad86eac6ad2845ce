"""A drive along one corridor, and whoever is met on it.

Positions are corridor coordinates (see :mod:`simworld.people`): ``s`` from the port where the
drive began. Nothing here knows the clock: the drive is advanced to a time whenever somebody
asks, in steps of 50 ms while anyone is about and in one step otherwise.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from simworld.people import (
    Act,
    Body,
    Person,
    RobotInCorridor,
    Walker,
    advance,
    along_m_s,
    collides,
    deadline_s,
    separation,
    walked,
)

STEP_NS = 50_000_000
COLLISION_STOP_NS = 10_000_000_000
"""How long robot and person stand after they have run into each other (assumption)."""


@dataclass(frozen=True)
class Met:
    """How a meeting went."""

    collided: bool
    closest_m: float
    delay_s: float


class CorridorDrive:
    """The robot under way in a corridor of ``length_m`` from port to port."""

    def __init__(self, began_ns: int, length_m: float, body: Body) -> None:
        self.length_m = length_m
        self._body = body
        self._began_ns = began_ns
        self._now_ns = began_ns
        self._act: Act = "continue"
        self._stands_until_ns = began_ns
        self.robot = RobotInCorridor(0.0, speed_m_s=body.speed_m_s, radius_m=body.radius_m)
        self.person: Person | None = None
        self.walker: Walker | None = None
        self.met: Met | None = None
        self._closest_m = math.inf
        self._collided = False

    def enter(self, person: Person) -> None:
        """Somebody steps into the corridor now."""
        self.person, self.walker, self.met = person, None, None
        self._closest_m, self._collided = math.inf, False
        self.walker = walked(person, None, self.robot, self._now_ns / 1e9 - 1e-9, 1e-9)

    def act(self, act: Act, now_ns: int) -> None:
        """The robot does something else from now on."""
        self.advance_to(now_ns)
        self._act = act

    def advance_to(self, now_ns: int) -> None:
        """Bring the drive up to a time."""
        while self._now_ns < now_ns:
            step_ns = now_ns - self._now_ns
            if self.person is not None:
                step_ns = min(step_ns, STEP_NS)
            elif self._stands_until_ns > self._now_ns:
                step_ns = min(step_ns, self._stands_until_ns - self._now_ns)
            self._step(step_ns)

    def _step(self, step_ns: int) -> None:
        dt_s = step_ns / 1e9
        stands = self._now_ns < self._stands_until_ns
        before = self.robot
        moved = advance(before, "stop" if stands else self._act, dt_s, self._body)
        self.robot = replace(moved, s_m=max(0.0, moved.s_m))
        if self.person is not None:
            self._meet(before, dt_s)
        self._now_ns += step_ns

    def _meet(self, before: RobotInCorridor, dt_s: float) -> None:
        assert self.person is not None
        now_s = self._now_ns / 1e9
        self.walker = walked(self.person, self.walker, before, now_s, dt_s)
        if self.walker is None:
            self.leave()
            return
        self._closest_m = min(self._closest_m, separation(self.walker, self.robot))
        if collides(self.person, self.walker, self.robot):
            self._collided = True
            self._stands_until_ns = self._now_ns + COLLISION_STOP_NS
            self.leave()

    def leave(self) -> None:
        """Whoever was met is gone."""
        if self.person is not None:
            lost_s = (self._now_ns - self._began_ns) / 1e9 - self.robot.s_m / self._body.speed_m_s
            self.met = Met(self._collided, self._closest_m, lost_s)
        self.person, self.walker = None, None

    def arrives_ns(self) -> int | None:
        """When the far port is reached if nothing changes; None while not driving ahead."""
        speed = along_m_s(self._act, self._body)
        if speed <= 0.0:
            return None
        begins_ns = max(self._now_ns, self._stands_until_ns)
        left_m = max(0.0, self.length_m - self.robot.s_m)
        return begins_ns + math.ceil(left_m / speed * 1e9)

    def react_by_ns(self) -> int | None:
        """The latest moment for a decision about whoever is ahead; None if nobody is.

        Where no collision threatens on the present lines, the moment they are abreast stands
        for that of the collision: the reactor cannot know that beforehand.
        """
        if self.person is None or self.walker is None:
            return None
        now_s = self._now_ns / 1e9
        at_s = deadline_s(self.person, self.walker, self.robot, now_s, self._body)
        if math.isinf(at_s):
            in_line = replace(self.walker, y_m=self.robot.y_m, lateral_speed_m_s=0.0)
            at_s = deadline_s(self.person, in_line, self.robot, now_s, self._body)
        return None if math.isinf(at_s) else int(at_s * 1e9)
