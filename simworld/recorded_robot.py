"""A recorded robot's day: it senses what its log says, and comes to junctions when it came there.

Nobody steers it. At each junction of its tour the classifier may test features: the readings are
those that a ring at each detector's vantage would have heard (:meth:`Recording.ring_m`), for the
robot did not stop to look. The decider is asked which way it would take; the robot takes its own.
"""

from __future__ import annotations

from collections.abc import Generator
from typing import Any, TypeAlias

import numpy as np
import simpy

from bus.messages import (
    ActionEnded,
    Arrival,
    AskedPath,
    AskedSensing,
    Departure,
    Motion,
    Sonar,
)
from simworld.body import primitive
from simworld.building import Building
from simworld.crossing import crossing_m
from simworld.deadlines import Deadlines
from simworld.motion import HEADING_RAD, Drive, Ping, Pose, Rates, Turn, duration_ns
from simworld.recording import Recording
from simworld.robot import STOP
from simworld.sonar import SonarRing
from simworld.tour import Stop
from simworld.voice import Mailbox, Speaker

Steps: TypeAlias = Generator[simpy.Event, Any, None]


AFTERWARDS_NS = 1_000_000_000
"""A run goes on for so long after the last line of a log."""


class RecordedRobot:
    """Plays back a recording."""

    def __init__(
        self,
        env: simpy.Environment,
        recording: Recording,
        building: Building,
        ring: SonarRing,
        deadlines: Deadlines,
        speaker: Speaker,
        mail: Mailbox,
    ) -> None:
        self._env = env
        self._recording = recording
        self._building = building
        self._ring = ring
        self._rates = Rates(transducers=ring.transducers)
        self._deadlines = deadlines
        self._say = speaker.say
        self._mail = mail
        self._pings = len(recording.scans)

    @property
    def _now_ns(self) -> int:
        return int(self._env.now)

    def live(self) -> Steps:
        """The whole log, and until its last percept has been dealt with."""
        self._env.process(self._tour())
        for at_ns, percept in self._recording.percepts:
            yield from self._until(at_ns)
            self._say(percept)
        yield self._env.timeout(AFTERWARDS_NS)

    def _until(self, at_ns: int) -> Steps:
        if at_ns > self._now_ns:
            yield self._env.timeout(at_ns - self._now_ns)

    def _tour(self) -> Steps:
        """From junction to junction, at the times of the log or as soon as one is through."""
        stops = self._recording.stops
        for visit, stop in enumerate(stops[1:]):
            yield from self._until(stops[visit].left_ns)
            self._say(Departure(visit, stop.heading))
            began_ns, arrives_ns = self._now_ns, max(stop.came_ns, self._now_ns)
            self._ask_path(visit, arrives_ns, [later.place for later in stops[visit + 2 :]])
            self._ask_sensing(visit, 0, arrives_ns)
            yield from self._until(arrives_ns)
            self._say(Arrival(visit, stop.heading, (arrives_ns - began_ns) / 1e9))
            yield from self._classify(visit, stop)

    def _ask_path(self, visit: int, until_ns: int, goals: list[int]) -> None:
        if not goals:
            return
        decision = self._deadlines.ask("path", visit, until_ns)
        tasks, expected = np.zeros((0, 2), np.int64), np.zeros(0)
        waypoints = np.array(goals, np.int64)
        self._say(AskedPath(decision, visit, waypoints, tasks, expected, self._now_ns, until_ns))

    def _ask_sensing(self, visit: int, action: int, until_ns: int) -> None:
        decision = self._deadlines.ask("sensing", visit, until_ns)
        self._say(AskedSensing(decision, visit, action, self._now_ns, until_ns))

    def _await(self, *about: Any) -> Generator[simpy.Event, Any, Any]:
        if not self._mail.has(about):
            yield self._mail.wait(about)
        return self._mail.take(about)

    def _classify(self, visit: int, stop: Stop) -> Steps:
        """Sense for as long as the classifier finds it worth while."""
        decision = yield from self._await("sensing", visit, 0)
        outcome, action = 0, 0
        while decision.next_detector[outcome] != STOP:
            motion = yield from self._await("motion", visit, action)
            action = motion.action
            yield from self._sense(motion, stop)
            reading = yield from self._await("reading", action)
            decision = yield from self._await("sensing", visit, action)
            outcome = reading.evidence

    def _sense(self, motion: Motion, stop: Stop) -> Steps:
        """The pings of a sensing action, from where its steps would have led.

        The way there takes no time, for it was not driven; the way back takes that of a ping, by
        which the last one has been heard.
        """
        steps = [primitive(round(kind), amount) for kind, amount in motion.steps.tolist()]
        pings = sum(step.count for step in steps if isinstance(step, Ping))
        ping_ns = duration_ns(Ping(1), self._rates)
        ends_ns = self._now_ns + (pings + 1) * ping_ns
        self._ask_sensing(motion.visit, motion.action, ends_ns)
        pose = self._port(stop)
        for step in steps:
            if isinstance(step, Ping):
                yield from self._ping(motion.action, step.count, pose, ping_ns)
            else:
                pose = _after(pose, step)
        yield from self._until(ends_ns)
        self._say(ActionEnded(motion.action))

    def _ping(self, action: int, count: int, pose: Pose, ping_ns: int) -> Steps:
        for _ in range(count):
            yield self._env.timeout(ping_ns)
            self._pings += 1
            heard_m = self._recording.ring_m(pose, self._ring)
            self._say(Sonar(self._pings, action, self._now_ns, heard_m))

    def _port(self, stop: Stop) -> Pose:
        """The port by which the robot came to a junction."""
        x_m, y_m = crossing_m(self._recording.plan, self._building, stop.place)
        pose = Pose(x_m, y_m, HEADING_RAD[stop.heading])
        return pose.after(-self._building.corridor_width_m / 2)


def _after(pose: Pose, step: Drive | Turn) -> Pose:
    """Where a step leads that errs by nothing."""
    if isinstance(step, Drive):
        return pose.after(step.distance_m)
    return pose.after(0.0, step.angle_rad)
