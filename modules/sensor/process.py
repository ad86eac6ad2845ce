"""The sensor's messages: raw sonar and odometry in, range and pose distributions out."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bus.facts import Facts
from bus.messages import Odometry, PoseBelief, Ranges, Scan, Sonar
from bus.turns import Handler, Turn
from bus.wire import MessageId
from modules.sensor.pose import moved, start
from modules.sensor.ranges import range_belief
from modules.sensor.settings import Settings

POSE_EVERY = 5
"""Odometry reports between two pose beliefs."""

TURNED_RAD = math.radians(10.0)
"""More than the wheels miscount on a straight way: after such a turn nothing looks as before."""


class Sensor:
    """Keeps the pose and the ping before."""

    def __init__(self) -> None:
        self._pose = start()
        self._reports = 0
        self._speed_m_s = 0.0
        self._before: Sonar | None = None  # the ping before, while driving straight on
        self._before_id: MessageId = ("", -1)
        self._moved_by: tuple[MessageId, ...] = ()  # the last report of the wheels
        self.handlers: Mapping[str, Handler] = {
            "percept/odometry": self._odometry,
            "percept/sonar": self._sonar,
        }

    def _odometry(self, said: Odometry, turn: Turn) -> None:
        turn.work("note", 9)
        self._moved_by = (turn.heard,)
        self._pose = moved(self._pose, said.distance_m, said.turn_rad)
        self._speed_m_s = said.distance_m / said.elapsed_s if said.elapsed_s > 0 else 0.0
        if abs(said.turn_rad) > TURNED_RAD:
            self._before = None
        self._reports += 1
        if self._reports % POSE_EVERY == 0:
            turn.say(PoseBelief(self._pose.mean, self._pose.covariance))

    def _sonar(self, said: Sonar, turn: Turn) -> None:
        turn.work("echo", len(said.ranges_m))
        if said.action:
            self._before = None
            alone = range_belief(said.ranges_m, np.full_like(said.ranges_m, np.nan), 0.0)
            scan = Scan(said.ping, said.action, alone.mean_m, alone.sigma_m, alone.echo)
            turn.say(scan)
            return
        belief = range_belief(said.ranges_m, *self._expected(said))
        ranges = Ranges(
            said.ping,
            said.fired_ns,
            belief.mean_m,
            belief.sigma_m,
            belief.echo,
            self._speed_m_s,
        )
        turn.say(ranges, *self._moved_by, *self._before_from())
        self._before, self._before_id = said, turn.heard

    def _expected(self, said: Sonar) -> tuple[NDArray[np.float64], float]:
        """The ranges of the ping before, NaN if there is none, and the way driven since."""
        if self._before is None:
            return np.full_like(said.ranges_m, np.nan), 0.0
        elapsed_s = (said.fired_ns - self._before.fired_ns) / 1e9
        return self._before.ranges_m, self._speed_m_s * elapsed_s

    def _before_from(self) -> tuple[MessageId, ...]:
        return () if self._before is None else (self._before_id,)


def build(_facts: Facts, _settings: Settings, _seed: int) -> Sensor:
    """The sensor of one run."""
    return Sensor()
