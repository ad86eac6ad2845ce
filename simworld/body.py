"""The robot's body: where it really is, what its steps do, and what it senses.

The low-level reflexes live here, as the paper has them below its decision processes: keeping
to the middle of a corridor, and stopping at the port of an LDP. They leave the robot a little
beside and a little askew of the port; that error is what detectors must bear.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.grid import EAST, NORTH, SOUTH, WEST
from simworld.sonar import People, SonarRing, Surroundings, echoes

HEADING_RAD = {EAST: 0.0, NORTH: math.pi / 2, WEST: math.pi, SOUTH: -math.pi / 2}

TURN_RAD_S = math.radians(15.0)
PING_NS = 960_000_000
"""A ring fires one transducer every 40 ms: 24 of them in 0.96 s."""

PORT_SIGMA_M = 0.03
PORT_SIGMA_RAD = math.radians(1.0)
STEP_SHARE = 0.01
"""How far a step misses what was commanded (assumption: wheel slip of 1 %)."""

ODOMETRY_SHARE = 0.02
ODOMETRY_SIGMA_RAD = math.radians(0.2)
"""Errors of odometry (assumption): 2 % of the distance, 0.2 degrees a report."""


@dataclass(frozen=True)
class Pose:
    """Position in metres, east and north, and heading in radians from east."""

    x_m: float
    y_m: float
    heading_rad: float

    def ahead(self, distance_m: float, left_m: float = 0.0) -> Pose:
        """The pose so far ahead, and so far to the left."""
        c, s = math.cos(self.heading_rad), math.sin(self.heading_rad)
        return Pose(
            self.x_m + c * distance_m - s * left_m,
            self.y_m + s * distance_m + c * left_m,
            self.heading_rad,
        )

    def turned(self, angle_rad: float) -> Pose:
        """The pose turned, counter-clockwise."""
        return Pose(self.x_m, self.y_m, self.heading_rad + angle_rad)


class Body:
    """Executes steps with their errors and fires the ring."""

    def __init__(
        self,
        ring: SonarRing,
        surroundings: Surroundings,
        crawl_m_s: float,
        rng: np.random.Generator,
    ) -> None:
        self._ring = ring
        self._surroundings = surroundings
        self._crawl_m_s = crawl_m_s
        self._rng = rng
        self.pose = Pose(0.0, 0.0, 0.0)
        self._distance_m = 0.0
        self._turn_rad = 0.0

    def stop_at_port(self, port: Pose) -> None:
        """Stand where the reflex that stops at a port leaves the robot."""
        along, beside, askew = self._rng.standard_normal(3)
        near = port.ahead(PORT_SIGMA_M * along, PORT_SIGMA_M * beside)
        self.pose = near.turned(PORT_SIGMA_RAD * askew)

    def move_ns(self, distance_m: float) -> int:
        """How long a drive of a step takes."""
        return round(abs(distance_m) / self._crawl_m_s * 1e9)

    def turn_ns(self, angle_rad: float) -> int:
        """How long a turn takes."""
        return round(abs(angle_rad) / TURN_RAD_S * 1e9)

    def drive(self, distance_m: float) -> None:
        """Be where a commanded drive ends."""
        driven = distance_m * (1.0 + STEP_SHARE * self._rng.standard_normal())
        self.pose = self.pose.ahead(driven)
        self._distance_m += abs(driven)

    def turn(self, angle_rad: float) -> None:
        """Be where a commanded turn ends."""
        turned = angle_rad * (1.0 + STEP_SHARE * self._rng.standard_normal())
        self.pose = self.pose.turned(turned)
        self._turn_rad += turned

    def place(self, pose: Pose, driven_m: float, turned_rad: float) -> None:
        """Be somewhere, having driven and turned so much since."""
        self.pose = pose
        self._distance_m += driven_m
        self._turn_rad += turned_rad

    def odometry(self) -> tuple[float, float]:
        """Distance and turn since the last report, as the wheels counted them."""
        scale, drift = self._rng.standard_normal(2)
        counted = self._distance_m * (1.0 + ODOMETRY_SHARE * scale)
        turned = self._turn_rad + ODOMETRY_SIGMA_RAD * drift
        self._distance_m = self._turn_rad = 0.0
        return float(counted), float(turned)

    def ping(self, people: People = ()) -> NDArray[np.float64]:
        """One firing of the ring from where the robot is."""
        pose = self.pose
        return echoes(
            self._ring,
            self._surroundings,
            pose.x_m,
            pose.y_m,
            pose.heading_rad,
            self._rng,
            people,
        )
