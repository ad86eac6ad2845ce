"""Driving along a corridor: pings, odometry, and whoever is met, until the far port."""

from __future__ import annotations

from collections.abc import Callable, Generator
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeAlias

import numpy as np
import simpy
from numpy.typing import NDArray

from bus.messages import Odometry, Sonar
from simworld.body import Body
from simworld.door import Disc
from simworld.drive import CorridorDrive
from simworld.encounters import Encounters
from simworld.keeping import Beside
from simworld.meetings import Room
from simworld.motion import Pose
from simworld.people import Act
from simworld.people import Body as CorridorBody
from simworld.settings import FalseEchoSettings
from simworld.sonar import SonarRing
from simworld.voice import Speaker

Steps: TypeAlias = Generator[simpy.Event, Any, None]

QUICKEST_PING_NS = 240_000_000
"""The ring fires no more often: four transducers at once, 40 ms apart (assumption)."""

ROOM_EVERY_M = 0.1

ODOMETRY_EVERY = 5
"""Pings for each report of the wheels while nothing is near."""


class Senses:
    """Fires the ring and reports odometry, from wherever the body is."""

    def __init__(
        self,
        env: simpy.Environment,
        body: Body,
        speaker: Speaker,
        ring: SonarRing,
        false_echoes: tuple[FalseEchoSettings, ...],
    ) -> None:
        self._ring = ring
        self._false_echoes = false_echoes
        self._env = env
        self._body = body
        self._say = speaker.say
        self._pings = 0
        self._reported_ns = 0

    def odometry(self) -> None:
        """Say what the wheels counted since the last time."""
        now_ns = int(self._env.now)
        distance_m, turn_rad = self._body.odometry()
        self._say(Odometry(distance_m, turn_rad, (now_ns - self._reported_ns) / 1e9))
        self._reported_ns = now_ns

    def ping(self, action: int, people: tuple[tuple[float, float, float], ...] = ()) -> None:
        """Fire the ring once and say what came back."""
        self._pings += 1
        fired_ns = int(self._env.now)
        crossed = crossed_share(self._ring, self._false_echoes, fired_ns)
        self._say(Sonar(self._pings, action, fired_ns, self._body.ping(people, crossed)))


def crossed_share(
    ring: SonarRing, false_echoes: tuple[FalseEchoSettings, ...], now_ns: int
) -> NDArray[np.float64] | None:
    """Share of crossed readings of each transducer, (transducers,); None for the ring's own."""
    shares = np.full(ring.transducers, ring.cross_talk)
    now = [f for f in false_echoes if 0.0 <= now_ns / 1e9 - f.at_s < f.lasts_s]
    for false_echo in now:
        shares[list(false_echo.transducers)] = false_echo.share
    return shares if now else None


@dataclass(frozen=True)
class Way:
    """One corridor to drive: its number in the map, from which pose, how far to the far port."""

    corridor: int
    begins: Pose
    length_m: float


class Travel:
    """The robot's drives. ``period_ns`` is how often the ring fires while nothing is near.

    ``stuck`` is called when a drive has come no further for ``patience_ns``: what the robot
    does about something in its way does not get it past.
    """

    def __init__(
        self,
        env: simpy.Environment,
        body: Body,
        senses: Senses,
        encounters: Encounters,
        kinematics: CorridorBody,
        period_ns: int,
        patience_ns: int,
        stuck: Callable[[], None],
    ) -> None:
        self._env = env
        self._patience_ns = patience_ns
        self._stuck = stuck
        self._body = body
        self._senses = senses
        self._encounters = encounters
        self._kinematics = kinematics
        self._calm_ns = period_ns
        self._period_ns = period_ns
        self._pings = 0
        self._drive: CorridorDrive | None = None
        self._changed = env.event()

    def react(self, act: Act, aside_m: float) -> None:
        """Do something about what is ahead from now on, so far aside if it goes aside."""
        if self._drive is not None:
            self._drive.act(act, int(self._env.now), aside_m)
            self._wake()

    def attend(self, period_s: float) -> None:
        """Fire the ring at another period while driving; 0 is the usual one."""
        asked_ns = round(period_s * 1e9)
        self._period_ns = max(QUICKEST_PING_NS, asked_ns) if asked_ns else self._calm_ns
        self._wake()

    def _wake(self) -> None:
        if not self._changed.triggered:
            self._changed.succeed()

    def along(self, way: Way, visit: int) -> Steps:
        """Drive a corridor from port to port."""
        drive = CorridorDrive(
            int(self._env.now), way.length_m, self._kinematics, self._room_along(way)
        )
        self._drive = drive
        pinged_ns = came_ns = int(self._env.now)
        farthest_m = 0.0
        while drive.robot.s_m < drive.length_m - 1e-9:
            now_ns = int(self._env.now)
            due_ns = min(pinged_ns + self._period_ns, came_ns + self._patience_ns)
            yield from self._pause(drive, now_ns, due_ns)
            now_ns = int(self._env.now)
            self._move(drive, way, now_ns)
            self._encounters.over(drive)
            if drive.robot.s_m > farthest_m:
                farthest_m, came_ns = drive.robot.s_m, now_ns
            elif now_ns - came_ns >= self._patience_ns:
                self._stuck()
                yield self._env.event()  # nothing comes after
            if now_ns >= pinged_ns + self._period_ns:
                pinged_ns = now_ns
                self._ping(drive, way, visit, now_ns)
        drive.leave()
        self._encounters.over(drive)
        self._drive = None

    def _room_along(self, way: Way) -> Room:
        """Room beside the middle of a way, looked up every ``ROOM_EVERY_M``."""

        @cache
        def room(step: int) -> Beside:
            return self._body.room_m(way.begins.after(step * ROOM_EVERY_M))

        return lambda at_m: room(round(at_m / ROOM_EVERY_M))

    def _pause(self, drive: CorridorDrive, now_ns: int, due_ns: int) -> Steps:
        """Until something is due, the arrival, or a change of mind."""
        arrives_ns = drive.arrives_ns()
        until_ns = due_ns if arrives_ns is None else min(due_ns, arrives_ns)
        self._changed = self._env.event()
        yield self._env.timeout(max(0, until_ns - now_ns)) | self._changed

    def _move(self, drive: CorridorDrive, way: Way, now_ns: int) -> None:
        before_m = drive.robot.s_m
        drive.advance_to(now_ns)
        middle = self._body.in_the_middle(way.begins.after(drive.robot.s_m))
        self._body.place(middle.beside(drive.robot.y_m), drive.robot.s_m - before_m, 0.0)

    def _ping(self, drive: CorridorDrive, way: Way, visit: int, now_ns: int) -> None:
        self._encounters.step_in(drive, way.corridor, now_ns)
        self._encounters.seen(drive, visit, now_ns)
        if self._period_ns < self._calm_ns or self._pings % ODOMETRY_EVERY == 0:
            self._senses.odometry()
        self._pings += 1
        self._senses.ping(0, tuple(self._placed(way, disc) for disc in drive.heard()))

    def _placed(self, way: Way, disc: Disc) -> Disc:
        """A disc in corridor coordinates as one in the world's: x, y, radius."""
        s_m, y_m, radius_m = disc
        at = self._body.in_the_middle(way.begins.after(s_m)).beside(y_m)
        return at.x_m, at.y_m, radius_m
