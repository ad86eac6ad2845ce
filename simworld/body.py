"""The robot's body: where it really is, what its steps do, and what it senses.

The low-level reflexes live here, as the paper has them below its decision processes: following
a corridor and stopping at the port of an LDP, both by echoes (:mod:`simworld.approach`). They leave
the robot a little beside and a little askew of the port; that error is what detectors must bear.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from bus.messages import DRIVE, PING, TURN
from simworld.abeam import look_abeam
from simworld.approach import GATE, LOOKS_FROM_M, Expected, Stop, approach
from simworld.building import Building
from simworld.crossing import crossing_m
from simworld.keeping import Beside, in_the_middle, room_beside
from simworld.motion import (
    Drive,
    Ping,
    Pose,
    Primitive,
    Rates,
    Turn,
    duration_ns,
    random_odometer,
)
from simworld.ports import ears_of
from simworld.sonar import People, SonarRing, Surroundings, echoes

BACK_SIGMA_M = 0.03
BACK_SIGMA_RAD = math.radians(1.0)
"""How far off the place where it stopped at first the robot is back after a sensing action, along
and across the corridor, and how askew (assumptions)."""

FOLLOWS_SIGMA_M = 0.05
FOLLOWS_SIGMA_RAD = math.radians(2.0)
"""How far beside the middle of a corridor, and how askew, the robot drives (assumptions)."""

COUNT_SHARE = 0.01
OFF_LINE_M = 0.15
"""What the robot thinks that a port may be off the place that it expects: its wheels miscount a
share of the corridor, and junctions lie beside the lines of the grid (assumptions)."""

SLIP_SHARE = 0.01
"""How far a step misses what was commanded (assumption: wheels slip by 1 %)."""

KINDS: dict[int, type[Drive] | type[Turn]] = {DRIVE: Drive, TURN: Turn}


def primitive(kind: int, amount: float) -> Primitive:
    """A step of a sensing action as a primitive of motion."""
    return Ping(round(amount)) if kind == PING else KINDS[kind](amount)


class Body:
    """Executes steps with their errors, counts its wheels, and fires the ring."""

    def __init__(
        self,
        ring: SonarRing,
        surroundings: Surroundings,
        speed_m_s: float,
        rng: np.random.Generator,
    ) -> None:
        self._ring = ring
        self._surroundings = surroundings
        self._rates = Rates(drive_m_s=speed_m_s, transducers=ring.transducers)
        self._rng = rng
        self._odometer = random_odometer(rng)
        self._ears = ears_of(ring)
        self.pose = Pose(0.0, 0.0, 0.0)
        self._distance_m = 0.0
        self._turned_rad = 0.0
        self._at_port = self.pose
        self._unsure: Stop | None = None

    def takes_ns(self, step: Primitive) -> int:
        """How long a primitive of motion takes."""
        return duration_ns(step, self._rates)

    def approach(
        self,
        port: Pose,
        driven_m: float,
        width_m: float,
        left: bool = True,
        right: bool = True,
    ) -> Stop:
        """Where the robot stops at the end of a corridor, its port being expected at ``port``.

        It has counted ``driven_m`` since it was last sure of its place; corridors are
        ``width_m`` wide, and may begin ``left`` and ``right`` by the grid. Nobody is about so near
        to a junction.
        """
        sigma_m = math.hypot(OFF_LINE_M, COUNT_SHARE * driven_m)
        way_m = min(LOOKS_FROM_M + GATE * sigma_m, driven_m)
        counted_m, _ = self._odometer.read(driven_m, 0.0, self._rng)
        beside, askew = self._rng.standard_normal(2)
        begins = self.in_the_middle(port.after(driven_m - counted_m - way_m))
        begins = begins.beside(FOLLOWS_SIGMA_M * beside).after(0.0, FOLLOWS_SIGMA_RAD * askew)
        expected = Expected(way_m, sigma_m, width_m, left, right)
        return approach(begins, expected, self._ears, self._listen, self._slipped)

    def arrive(self, stop: Stop) -> None:
        """Stand where an approach ended."""
        self.pose = self._at_port = stop.pose
        self._unsure = None if stop.sure else stop

    def find_doorway(self) -> int:
        """Where the approach could not tell the port, look for a doorway beside the junction.

        Stands at its port then, if there is one. Returns the nanoseconds that this takes.
        """
        stop, self._unsure = self._unsure, None
        if stop is None:
            return 0
        took_ns: list[int] = []

        def move(pose: Pose, forward_m: float, turn_rad: float) -> Pose:
            took_ns.extend((self.takes_ns(Drive(forward_m)), self.takes_ns(Turn(turn_rad))))
            return self._slipped(pose, forward_m, turn_rad)

        abeam = look_abeam(stop, self._ears, self._listen, move)
        port_m = abeam.begun_m if abeam.port_m is None else abeam.port_m
        self.pose = self._at_port = move(abeam.pose, port_m, 0.0)
        return sum(took_ns)

    def back_at_port(self) -> None:
        """Be back where the approach ended, or near."""
        along, beside, askew = self._rng.standard_normal(3)
        near = self._at_port.after(BACK_SIGMA_M * along).beside(BACK_SIGMA_M * beside)
        self.pose = near.after(0.0, BACK_SIGMA_RAD * askew)

    def _listen(self, pose: Pose) -> NDArray[np.float64]:
        x_m, y_m, heading_rad = pose.x_m, pose.y_m, pose.heading_rad
        return echoes(self._ring, self._surroundings, x_m, y_m, heading_rad, self._rng)

    def _slipped(self, pose: Pose, forward_m: float, turn_rad: float) -> Pose:
        forward, turn = 1.0 + SLIP_SHARE * self._rng.standard_normal(2)
        return pose.after(float(forward) * forward_m, float(turn) * turn_rad)

    def step(self, step: Drive | Turn) -> None:
        """Be where a commanded step really ends."""
        really = 1.0 + SLIP_SHARE * float(self._rng.standard_normal())
        if isinstance(step, Drive):
            self.pose = self.pose.after(really * step.distance_m)
            self._distance_m += step.distance_m
        else:
            self.pose = self.pose.after(0.0, really * step.angle_rad)
            self._turned_rad += step.angle_rad

    def in_the_middle(self, on_line: Pose) -> Pose:
        """A pose on a grid line, moved to the middle of the corridor there."""
        return in_the_middle(self._surroundings, on_line)

    def crossing_m(self, building: Building, place: int) -> tuple[float, float]:
        """Where the corridors of a junction meet, x and y."""
        return crossing_m(self._surroundings, building, place)

    def room_m(self, on_line: Pose) -> Beside:
        """How far left and right of the middle of a corridor its walls let the robot be."""
        return room_beside(self._surroundings, self.in_the_middle(on_line))

    def place(self, pose: Pose, driven_m: float, turned_rad: float) -> None:
        """Be somewhere, having driven and turned so much since."""
        self.pose = pose
        self._distance_m += driven_m
        self._turned_rad += turned_rad

    def odometry(self) -> tuple[float, float]:
        """Distance and turn since the last report, as the wheels counted them."""
        counted = self._odometer.read(self._distance_m, self._turned_rad, self._rng)
        self._distance_m = self._turned_rad = 0.0
        return counted

    def ping(
        self, people: People = (), crossed_share: NDArray[np.float64] | None = None
    ) -> NDArray[np.float64]:
        """One firing of the ring from where the robot is; arguments as of ``sonar.echoes``."""
        pose = self.pose
        return echoes(
            self._ring,
            self._surroundings,
            pose.x_m,
            pose.y_m,
            pose.heading_rad,
            self._rng,
            people,
            crossed_share,
        )
