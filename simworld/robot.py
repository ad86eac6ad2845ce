"""The robot's day: from LDP to LDP, sensing, deciding by what the modules say, driving.

Runs as one SimPy process. Wherever it needs a decision that has not come, it stands and waits;
since when, and for which decision, is known, so that the ledger can tell how long it was idle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Generator, Hashable
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np
import simpy

from bus.grid import EAST, LEFT_OF, OPPOSITE, RIGHT_OF, STEP, WEST
from bus.messages import (
    ActionEnded,
    Arrival,
    AskedErrand,
    AskedPath,
    AskedSensing,
    AtErrand,
    Blocked,
    Departure,
    Motion,
    TrueErrand,
    TruePose,
)
from simworld.body import Body, primitive
from simworld.building import Building
from simworld.deadlines import Deadlines
from simworld.errands import ErrandQueue, shortest_s
from simworld.motion import HEADING_RAD, Drive, Ping, Pose, Turn
from simworld.travel import Senses, Steps, Travel, Way
from simworld.voice import Mailbox, Speaker

Choice: TypeAlias = Generator[simpy.Event, Any, int]

STOP = -1
"""In place of a next detector: the junction's type is concluded."""

HAND_OVER_NS = 20_000_000_000
"""How long a robot that did not know the place takes to see to an errand (assumption)."""


class Robot:
    """The executive: carries out decisions, and asks for the next ones."""

    def __init__(
        self,
        env: simpy.Environment,
        building: Building,
        body: Body,
        travel: Travel,
        senses: Senses,
        errands: ErrandQueue,
        deadlines: Deadlines,
        speaker: Speaker,
        mail: Mailbox,
        speed_m_s: float,
        stands: Callable[[], None],
        lost: bool = False,
    ) -> None:
        self._env = env
        self._building = building
        self._body = body
        self._travel = travel
        self._senses = senses
        self._errands = errands
        self._deadlines = deadlines
        self._say = speaker.say
        self._mail = mail
        self._speed_m_s = speed_m_s
        self._stands = stands
        self._lost = lost
        self._found: int | None = None  # the errand's end where it stands, not seen to yet
        self.visit = 0
        self.place = 0
        self.heading = 0
        self.stands_since_ns: int | None = None
        self._waits_for = ""

    @property
    def _now_ns(self) -> int:
        return int(self._env.now)

    def waits_since_ns(self, kind: str) -> int | None:
        """Since when the robot stands for want of this kind of decision; None if it does not."""
        return self.stands_since_ns if self._waits_for == kind else None

    def live(self, place: int, heading: int, ahead_m: float) -> Steps:
        """Drive to the first LDP, ``ahead_m`` away, then on until there is nothing more to do."""
        self.place, self.heading = place, heading
        begins = self._on_line().after(-self._half_m - ahead_m)
        self._body.place(begins, 0.0, 0.0)
        behind = self._corridor(place, OPPOSITE[heading])
        yield from self._go(Way(behind, begins, ahead_m), crossing_ns=0, turn_rad=0.0)
        while True:
            junction_type = yield from self._classify()
            yield from self._hand_over()
            direction = yield from self._way_out(junction_type)
            if direction == 0:
                return
            yield from self._leave(direction)

    # Going.

    @property
    def _half_m(self) -> float:
        return self._building.corridor_width_m / 2

    def _on_line(self) -> Pose:
        """The junction's middle, moved sideways onto the grid line that the robot drives on."""
        x_m, y_m = self._building.position_m(*self._building.grid.place(self.place))
        crossing_x_m, crossing_y_m = self._body.crossing_m(self._building, self.place)
        if self.heading in (EAST, WEST):
            return Pose(crossing_x_m, y_m, HEADING_RAD[self.heading])
        return Pose(x_m, crossing_y_m, HEADING_RAD[self.heading])

    def _corridor(self, place: int, direction: int) -> int:
        return self._building.grid.corridor(*self._building.grid.place(place), direction)

    def _leave(self, direction: int) -> Steps:
        """Cross the junction, drive the corridor that way, and be at the next LDP."""
        corridor = self._corridor(self.place, direction)
        turn_rad = _turn_rad(self.heading, direction)
        crossing_ns = self._takes_ns(2 * self._half_m, turn_rad)
        self.heading = direction
        begins = self._on_line().after(self._half_m)
        x, y = self._building.grid.place(self.place)
        dx, dy = STEP[direction]
        self.place = self._building.grid.intersection(x + dx, y + dy)
        ends = self._on_line().after(-self._half_m)
        length_m = abs(ends.x_m - begins.x_m) + abs(ends.y_m - begins.y_m)
        self.visit += 1
        yield from self._go(Way(corridor, begins, length_m), crossing_ns, turn_rad)

    def _go(self, way: Way, crossing_ns: int, turn_rad: float) -> Steps:
        """Ask for what must be decided on the way, and drive it."""
        self._moves()
        began_ns = self._now_ns
        self._say(Departure(self.visit, self.heading))
        arrives_ns = began_ns + crossing_ns + math.ceil(way.length_m / self._speed_m_s * 1e9)
        self._ask_path(arrives_ns)
        self._ask_sensing(0, arrives_ns)
        if crossing_ns:
            yield self._env.timeout(crossing_ns)
            self._body.place(way.begins, 2 * self._half_m, turn_rad)
        yield from self._arrive(way)
        self._senses.odometry()
        self._say(Arrival(self.visit, self.heading, (self._now_ns - began_ns) / 1e9))
        self._say_pose()
        self._look_about()
        self._errands_at(self.place)

    def _arrive(self, way: Way) -> Steps:
        """Drive until the reflex stops at what it takes for the port.

        Nothing that is met changes what its last metres sound like, so where it will stop is
        found first, and the drive ends there.
        """
        port = way.begins.after(way.length_m)
        left, right = (
            self._corridor(self.place, beside[self.heading]) >= 0 for beside in (LEFT_OF, RIGHT_OF)
        )
        stop = self._body.approach(port, way.length_m, 2 * self._half_m, left, right)
        reached_m = way.length_m + stop.pose.ahead_of_m(port)
        yield from self._travel.along(replace(way, length_m=reached_m), self.visit)
        if stop.beyond_m > 0.0:
            yield self._env.timeout(2 * self._body.takes_ns(Drive(stop.beyond_m)))
        self._body.arrive(stop)

    def _say_pose(self) -> None:
        pose = self._body.pose
        self._say(TruePose(pose.x_m, pose.y_m, pose.heading_rad, self.place))

    def _look_about(self) -> None:
        """See whether somebody here expects the robot, where it does not know the place itself."""
        waypoint = self._errands.waypoint
        if not self._lost or waypoint is None:
            return
        if self.place == waypoint:
            self._found = waypoint
        else:
            self._say(AtErrand(self.visit, waypoint, here=False))

    def _hand_over(self) -> Steps:
        """See to an errand's end that was come upon, and ask again for the path from here."""
        if self._found is None:
            return
        self._moves()
        self.visit += 1
        self._say(AtErrand(self.visit, self._found, here=True))
        self._found = None
        self._ask_path(self._now_ns + HAND_OVER_NS)
        yield self._env.timeout(HAND_OVER_NS)

    def _errands_at(self, place: int) -> None:
        for done in self._errands.reached(place, self._now_ns):
            legs = ((done.began_at, done.start), (done.start, done.goal))
            least_s = sum(shortest_s(self._building, self._speed_m_s, a, b) for a, b in legs)
            self._say(
                TrueErrand(done.number, done.start, done.goal, done.began_ns, self._now_ns, least_s)
            )

    # Deciding.

    def _ask_path(self, until_ns: int) -> None:
        waypoints = self._errands.waypoints()
        tasks, expected = self._errands.expected()
        decision = self._deadlines.ask("path", self.visit, until_ns)
        due = self._errands.due
        if due is not None:
            self._say(AskedErrand(self.visit, *due))
        self._say(
            AskedPath(decision, self.visit, waypoints, tasks, expected, self._now_ns, until_ns)
        )

    def _ask_sensing(self, action: int, until_ns: int) -> None:
        decision = self._deadlines.ask("sensing", self.visit, until_ns)
        self._say(AskedSensing(decision, self.visit, action, self._now_ns, until_ns))

    def _await(self, kind: str, *about: Hashable) -> Generator[simpy.Event, Any, Any]:
        """What was said about something; the robot stands until it is heard."""
        if not self._mail.has((kind, *about)):
            if self.stands_since_ns is None:
                self.stands_since_ns = self._now_ns
                self._stands()
            self._waits_for = kind
            yield self._mail.wait((kind, *about))
            self._waits_for = ""
        return self._mail.take((kind, *about))

    def _moves(self) -> None:
        self.stands_since_ns = None

    def _classify(self) -> Choice:
        """Sense for as long as the classifier finds it worth while: the type it concludes."""
        decision = yield from self._await("sensing", self.visit, 0)
        outcome, action = 0, 0
        while decision.next_detector[outcome] != STOP:
            motion: Motion = yield from self._await("motion", self.visit, action)
            if action == 0:
                yield from self._find_doorway()
            action = motion.action
            yield from self._sense(motion)
            reading = yield from self._await("reading", action)
            decision = yield from self._await("sensing", self.visit, action)
            outcome = reading.evidence
        return int(decision.concluded[outcome])

    def _find_doorway(self) -> Steps:
        """Before the first look around, stand where the walls say that the port is."""
        self._moves()
        took_ns = self._body.find_doorway()
        if took_ns:
            yield self._env.timeout(took_ns)

    def _sense(self, motion: Motion) -> Steps:
        """Carry out the steps of a sensing action, having asked what to do after it."""
        self._moves()
        steps = [primitive(round(kind), amount) for kind, amount in motion.steps.tolist()]
        self._ask_sensing(motion.action, self._now_ns + sum(map(self._body.takes_ns, steps)))
        for step in steps:
            if isinstance(step, Ping):
                yield from self._pings(motion.action, step.count)
            else:
                yield self._env.timeout(self._body.takes_ns(step))
                self._body.step(step)
        self._body.back_at_port()
        self._senses.odometry()
        self._say(ActionEnded(motion.action))

    def _pings(self, action: int, count: int) -> Steps:
        for _ in range(count):
            yield self._env.timeout(self._body.takes_ns(Ping(1)))
            self._senses.ping(action)

    def _takes_ns(self, distance_m: float, turn_rad: float) -> int:
        return self._body.takes_ns(Drive(distance_m)) + self._body.takes_ns(Turn(turn_rad))

    def _way_out(self, junction_type: int) -> Choice:
        """The direction decided for this type; a wall in that direction is found by trying."""
        while True:
            decision = yield from self._await("path", self.visit)
            direction = int(decision.direction[junction_type])
            corridor = self._corridor(self.place, direction) if direction else -1
            if direction == 0 or (corridor >= 0 and self._building.corridors[corridor]):
                return direction
            yield from self._bump(direction)
            junction_type = (junction_type & ~direction) | OPPOSITE[self.heading]

    def _bump(self, direction: int) -> Steps:
        """Go where the way should be, find a wall, and come back to the port."""
        self._moves()
        turn_rad = _turn_rad(self.heading, direction)
        there_ns = self._takes_ns(self._half_m, turn_rad)
        yield self._env.timeout(there_ns)
        self.visit += 1
        self._say(Blocked(self.visit, direction))
        self._ask_path(self._now_ns + there_ns)
        yield self._env.timeout(there_ns)
        self._body.back_at_port()


def _turn_rad(heading: int, direction: int) -> float:
    """The turn from one heading to another, the short way round; a half turn is to the left."""
    turn = math.remainder(HEADING_RAD[direction] - HEADING_RAD[heading], 2 * math.pi)
    return abs(turn) if np.isclose(abs(turn), math.pi) else turn
