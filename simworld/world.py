"""The simulated world as one process: its robot, its people, its errands and its deadlines."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import simpy
from numpy.typing import NDArray

from bus.coordinator import Done, Grant, Handled
from bus.grid import EAST, NORTH, SOUTH, WEST
from bus.messages import (
    Attention,
    Motion,
    PathDecision,
    ReactionDecision,
    Reading,
    RunEnded,
    SensingDecision,
    TrueBuilding,
)
from bus.topics import MODULES, WORLD
from bus.wire import MessageId, Sent
from simworld.body import Body
from simworld.building import Building
from simworld.deadlines import Deadlines
from simworld.encounters import Coming, Encounters
from simworld.errands import Errand, ErrandQueue
from simworld.people import Body as CorridorBody
from simworld.recorded_robot import RecordedRobot
from simworld.recording import Recording
from simworld.robot import Robot
from simworld.settings import WorldSettings, ring_of
from simworld.sonar import Surroundings
from simworld.travel import Senses, Travel
from simworld.voice import Mailbox, Outlet, Speaker

DIRECTION = {"N": NORTH, "E": EAST, "S": SOUTH, "W": WEST}


@dataclass(frozen=True, eq=False)
class Plan:
    """A world as it was drawn: what a seed makes of a scenario.

    ``recording``, if there is one, is played back in place of the robot's day. A robot that is
    ``lost`` does not know when it is at an errand's end: it looks whether somebody waits there.
    """

    settings: WorldSettings
    building: Building
    surroundings: Surroundings
    start: int
    heading: int
    errands: tuple[Errand, ...]
    people: tuple[Coming, ...]
    recording: Recording | None = None
    lost: bool = False


class World:
    """Everything that is not a module.

    ``decided_by`` finds the handler that made a decision, ``why_late`` says why a process has
    not decided at a deadline; both are the clock's.
    """

    def __init__(
        self,
        env: simpy.Environment,
        plan: Plan,
        seed: int,
        outlet: Outlet,
        decided_by: Callable[[MessageId], Handled | None],
        why_late: Callable[[str], str],
    ) -> None:
        self._env = env
        self._plan = plan
        self._decided_by = decided_by
        self._why_late = why_late
        self._speaker = Speaker(env, outlet, WORLD)
        self._mail = Mailbox(env)
        self.ended = env.event()
        self.deadlines = Deadlines(env, self._speaker.say, why_late, self._missed)
        self._build_robot(seed)
        self.handlers: Mapping[str, Callable[[Sent], None]] = {
            "decision/sensing": self._sensing,
            "decision/path": self._path,
            "decision/reaction": self._reaction,
            "command/motion": self._motion,
            "command/attention": self._attention,
            "reading/feature": self._reading,
        }

    def _build_robot(self, seed: int) -> None:
        plan, settings = self._plan, self._plan.settings
        body_rng = np.random.default_rng([seed, 1])
        ring = ring_of(settings.sonar)
        body = Body(ring, plan.surroundings, settings.speed_m_s, body_rng)
        senses = Senses(self._env, body, self._speaker, ring, settings.false_echo)
        self.encounters = Encounters(
            plan.people, ring.farthest_m, self.deadlines, self._speaker.say
        )
        self._travel = Travel(
            self._env,
            body,
            senses,
            self.encounters,
            CorridorBody(speed_m_s=settings.speed_m_s),
            round(settings.ping_period_s * 1e9),
            round(settings.patience_s * 1e9),
            lambda: self.end("stuck"),
        )
        self.errands = ErrandQueue(plan.errands, plan.start)
        self.robot = Robot(
            self._env,
            plan.building,
            body,
            self._travel,
            senses,
            self.errands,
            self.deadlines,
            self._speaker,
            self._mail,
            settings.speed_m_s,
            self._stands,
            plan.lost,
        )

    def start(self) -> None:
        """Put the robot into its corridor and let the day begin."""
        plan = self._plan
        self._speaker.say(
            TrueBuilding(
                np.array(plan.building.columns_m),
                np.array(plan.building.rows_m),
                plan.building.corridor_width_m,
                _copy(plan.building.corridors),
                plan.start,
            )
        )
        self._env.process(self._day())
        limit = self._env.timeout(round(plan.settings.until_s * 1e9))
        limit.callbacks.append(lambda _: self.end("time"))

    def _day(self) -> Any:
        if self._plan.recording is None:
            start = self._plan.settings.start
            ahead_m = 5.0 if start == "anywhere" else start.ahead_m
            yield from self.robot.live(self._plan.start, self._plan.heading, ahead_m)
        else:
            yield from self._recorded(self._plan.recording).live()
        self.end("done")

    def _recorded(self, recording: Recording) -> RecordedRobot:
        return RecordedRobot(
            self._env,
            recording,
            self._plan.building,
            ring_of(self._plan.settings.sonar),
            self.deadlines,
            self._speaker,
            self._mail,
        )

    def end(self, reason: str) -> None:
        """The run ends now, for this reason; only the first counts."""
        if not self.ended.triggered:
            self.deadlines.close_all(self.robot.stands_since_ns)
            self._speaker.say(RunEnded(reason))
            self.ended.succeed(reason)

    def lost(self, process: str, how: str) -> None:
        """A process is ``down`` or ``frozen``: no verdict on this run would be honest."""
        self.end(f"process {how}: {process}")

    def _missed(self, process: str, cause: str) -> None:
        """After a miss: nobody can wait for a process that is gone."""
        if cause == "process down":
            self.end(f"process down: {process}")

    def _stands(self) -> None:
        """The robot begins to wait for what it was not told: not for ever."""
        alarm = self._env.timeout(round(self._plan.settings.patience_s * 1e9))
        alarm.callbacks.append(lambda _: self._if_stuck())

    def _if_stuck(self) -> None:
        patience_ns = round(self._plan.settings.patience_s * 1e9)
        since_ns = self.robot.stands_since_ns
        if since_ns is None or int(self._env.now) - since_ns < patience_ns:
            return
        down = [name for name in MODULES if self._why_late(name) == "process down"]
        self.end(f"process down: {down[0]}" if down else "stuck")

    def take_turn(self, grant: Grant, heard: tuple[Sent, ...]) -> Done:
        """Take in what the modules said. It costs nothing: the world does not compute."""
        for sent in heard:
            self.handlers[sent.topic](sent)
        at_ns = grant.time_ns
        handled = tuple(Handled(s.topic, s.source, s.sequence, at_ns, at_ns, 0) for s in heard)
        return Done(WORLD, at_ns, handled, ())

    def _sensing(self, sent: Sent) -> None:
        said = _as(SensingDecision, sent)
        self._settle("sensing", said.decision, sent.id, said.look_ahead)
        self._mail.put(("sensing", said.visit, said.action), said)

    def _path(self, sent: Sent) -> None:
        said = _as(PathDecision, sent)
        self._settle("path", said.decision, sent.id, said.hypotheses)
        self._mail.put(("path", said.visit), said)

    def _settle(self, kind: str, decision: int, by: MessageId, size: int) -> None:
        handler = self._decided_by(by)
        self.deadlines.decided(decision, handler, size, self.robot.waits_since_ns(kind))

    def _reaction(self, sent: Sent) -> None:
        said = _as(ReactionDecision, sent)
        acts = len(said.expected_utility)
        self.encounters.decided(self._decided_by(sent.id), acts, said.fired_ns)
        self._travel.react(said.act, said.aside_m)

    def _motion(self, sent: Sent) -> None:
        said = _as(Motion, sent)
        self._mail.put(("motion", said.visit, said.after), said)

    def _attention(self, sent: Sent) -> None:
        self._travel.attend(_as(Attention, sent).period_s)

    def _reading(self, sent: Sent) -> None:
        said = _as(Reading, sent)
        self._mail.put(("reading", said.action), said)


def _as(kind: type[Any], sent: Sent) -> Any:
    assert isinstance(sent.message, kind)
    return sent.message


def _copy(array: NDArray[np.uint8]) -> NDArray[np.uint8]:
    return array.copy()
