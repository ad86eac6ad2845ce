"""The sensor's messages: raw sonar and odometry in, range and pose distributions out."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from bus.facts import Facts
from bus.messages import Odometry, PoseBelief, Ranges, Sonar
from bus.turns import Handler, Turn
from bus.wire import MessageId
from modules.sensor.pose import moved, start
from modules.sensor.ranges import range_belief
from modules.sensor.settings import Settings

POSE_EVERY = 20
"""Odometry reports between two pose beliefs."""


class Sensor:
    """Keeps the pose and the ping before."""

    def __init__(self) -> None:
        self._pose = start()
        self._reports = 0
        self._driven_m = 0.0
        self._speed_m_s = 0.0
        self._before_m = np.full(0, np.nan)
        self._before_from: tuple[MessageId, ...] = ()  # the message of the ping before
        self._moved_by: tuple[MessageId, ...] = ()  # the last report of the wheels
        self.handlers: Mapping[str, Handler] = {
            "percept/odometry": self._odometry,
            "percept/sonar": self._sonar,
        }

    def _odometry(self, said: Odometry, turn: Turn) -> None:
        turn.work("note", 9)
        self._moved_by = (turn.heard,)
        self._pose = moved(self._pose, said.distance_m, said.turn_rad)
        self._driven_m += said.distance_m
        self._speed_m_s = said.distance_m / said.elapsed_s if said.elapsed_s > 0 else 0.0
        if said.turn_rad:
            self._before_m = np.full(0, np.nan)
        self._reports += 1
        if self._reports % POSE_EVERY == 0:
            turn.say(PoseBelief(self._pose.mean, self._pose.covariance))

    def _sonar(self, said: Sonar, turn: Turn) -> None:
        turn.work("echo", len(said.ranges_m))
        driving = said.action == 0
        known = driving and self._before_m.shape == said.ranges_m.shape
        before_m = self._before_m if known else np.full(len(said.ranges_m), np.nan)
        belief = range_belief(said.ranges_m, before_m, self._driven_m)
        self._before_m = said.ranges_m if driving else np.full(0, np.nan)
        self._driven_m = 0.0
        speed_m_s = self._speed_m_s if driving else 0.0
        turn.say(
            Ranges(
                said.ping,
                said.action,
                said.fired_ns,
                belief.mean_m,
                belief.sigma_m,
                belief.echo,
                speed_m_s,
            ),
            *(self._moved_by if driving else ()),
            *(self._before_from if known else ()),
        )
        self._before_from = (turn.heard,)


def build(_facts: Facts, _settings: Settings, _seed: int) -> Sensor:
    """The sensor of one run."""
    return Sensor()
