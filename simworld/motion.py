"""How the robot's body moves: primitives of motion, what they take, and what odometry says of them.

Sensing actions are made of these primitives ("Each feature detector is realized as a control
process that directs the robot's movement and sensing", paper, section 2). Times are integer
nanoseconds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from bus.grid import EAST, NORTH, SOUTH, WEST

HEADING_RAD = {EAST: 0.0, NORTH: math.pi / 2, WEST: math.pi, SOUTH: -math.pi / 2}
"""The way that each direction bit points, counter-clockwise from east."""


class MotionError(ValueError):
    """A primitive or a rate that no body can follow."""


@dataclass(frozen=True)
class Pose:
    """Where the robot is and faces: metres east and north, radians counter-clockwise from east."""

    x_m: float
    y_m: float
    heading_rad: float

    def beside(self, left_m: float) -> Pose:
        """The pose so far to the left, facing the same way."""
        return Pose(
            self.x_m - left_m * math.sin(self.heading_rad),
            self.y_m + left_m * math.cos(self.heading_rad),
            self.heading_rad,
        )

    def ahead_of_m(self, other: Pose) -> float:
        """How far ahead of another pose it is, along the other's heading."""
        c, s = math.cos(other.heading_rad), math.sin(other.heading_rad)
        return (self.x_m - other.x_m) * c + (self.y_m - other.y_m) * s

    def after(self, distance_m: float, turn_rad: float = 0.0) -> Pose:
        """The pose after an arc of this length, turning evenly along it."""
        # The chord of an arc is shorter by sin(a) / a and leans by a, half the turn.
        half_rad = turn_rad / 2.0
        chord_m = distance_m * math.sin(half_rad) / half_rad if half_rad else distance_m
        along = self.heading_rad + half_rad
        return Pose(
            self.x_m + chord_m * math.cos(along),
            self.y_m + chord_m * math.sin(along),
            self.heading_rad + turn_rad,
        )


@dataclass(frozen=True)
class Drive:
    """Straight on, or back where the distance is negative."""

    distance_m: float


@dataclass(frozen=True)
class Turn:
    """On the spot, counter-clockwise where positive."""

    angle_rad: float


@dataclass(frozen=True)
class Ping:
    """Stand and fire the whole ring this many times."""

    count: int


Primitive: TypeAlias = Drive | Turn | Ping


@dataclass(frozen=True)
class Rates:
    """How fast the body does what. Raises MotionError unless all are positive.

    - ``drive_m_s``: 0.085, for the paper's four minutes between two LDPs (section 5) at the
      twenty metres of the buildings simulated here.
    - ``turn_rad_s``: 15 degrees a second (assumption).
    - ``fire_ns``: one transducer at a time, 40 ms apart (assumption: the echo from 6.8 m is back
      by then; a later one may be heard by the next transducer, as cross-talk).
    - ``transducers``: how many a ping fires.
    """

    drive_m_s: float = 0.085
    turn_rad_s: float = math.radians(15.0)
    fire_ns: int = 40_000_000
    transducers: int = 24

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (math.isfinite(value) and value > 0):
                raise MotionError(f"{name}: found {value}, expected a positive number")


def duration_ns(primitive: Primitive, rates: Rates) -> int:
    """What a primitive takes, rounded up to a nanosecond.

    Raises MotionError for a distance or angle that is not finite and a negative ping count.
    """
    if isinstance(primitive, Ping):
        if primitive.count < 0:
            raise MotionError(f"found {primitive}, expected a count of 0 or more")
        return primitive.count * rates.transducers * rates.fire_ns
    distance_m, turn_rad = _motion(primitive)
    if not math.isfinite(distance_m + turn_rad):
        raise MotionError(f"found {primitive}, expected a finite number")
    return math.ceil((abs(distance_m) / rates.drive_m_s + abs(turn_rad) / rates.turn_rad_s) * 1e9)


def _motion(primitive: Primitive) -> tuple[float, float]:
    """How far a primitive drives and turns in all."""
    if isinstance(primitive, Drive):
        return primitive.distance_m, 0.0
    return (0.0, primitive.angle_rad) if isinstance(primitive, Turn) else (0.0, 0.0)


@dataclass(frozen=True)
class Odometer:
    """Wheel encoders with errors of the two kinds that Borenstein and Feng measure (1996).

    Systematic: every distance is read ``distance_scale`` times too long, and the heading drifts
    by ``drift_rad_m`` a metre driven. Random: the standard deviations grow with the root of the
    distance and of the angle, so that reading in smaller steps changes no statistics.
    """

    distance_scale: float = 1.0
    drift_rad_m: float = 0.0
    distance_noise_m: float = 0.005
    """Standard deviation after one metre (assumption)."""
    heading_noise_rad: float = math.radians(0.5)
    """Standard deviation after one metre or one radian (assumption)."""

    def read(
        self, distance_m: float, turn_rad: float, rng: np.random.Generator
    ) -> tuple[float, float]:
        """What the encoders say of a true (distance, turn): metres, radians."""
        noise = rng.standard_normal(2)
        length_m = abs(distance_m)
        return (
            self.distance_scale * distance_m
            + self.distance_noise_m * math.sqrt(length_m) * float(noise[0]),
            turn_rad
            + self.drift_rad_m * length_m
            + self.heading_noise_rad * math.sqrt(length_m + abs(turn_rad)) * float(noise[1]),
        )


def random_odometer(
    rng: np.random.Generator,
    scale_sigma: float = 0.01,
    drift_sigma_rad_m: float = math.radians(0.3),
) -> Odometer:
    """The odometer of one robot, with systematic errors of its own (sigmas are assumptions)."""
    scale, drift = rng.standard_normal(2)
    return Odometer(1.0 + scale_sigma * float(scale), drift_sigma_rad_m * float(drift))
