"""Where the robot is relative to where it began, by odometry alone: a Gaussian that grows.

First-order dead reckoning (Smith and Cheeseman, On the Representation and Estimation of
Spatial Uncertainty, 1986).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

DISTANCE_SHARE = 0.02
TURN_SIGMA_RAD = math.radians(0.2)
"""Errors of the wheels' counts: 2 % of the distance, 0.2 degrees a report (assumptions)."""


@dataclass(frozen=True)
class Pose:
    """Mean (x_m, y_m, heading_rad) and covariance (3, 3)."""

    mean: NDArray[np.float64]
    covariance: NDArray[np.float64]


def start() -> Pose:
    """The pose at the beginning, known by definition."""
    return Pose(np.zeros(3), np.zeros((3, 3)))


def moved(pose: Pose, distance_m: float, turn_rad: float) -> Pose:
    """The pose after driving ``distance_m`` straight and then turning."""
    x_m, y_m, heading_rad = pose.mean
    c, s = math.cos(heading_rad), math.sin(heading_rad)
    after_rad = math.remainder(heading_rad + turn_rad, math.tau)
    mean = np.array([x_m + c * distance_m, y_m + s * distance_m, after_rad])
    by_pose = np.array([[1.0, 0.0, -s * distance_m], [0.0, 1.0, c * distance_m], [0.0, 0.0, 1.0]])
    by_motion = np.array([[c, 0.0], [s, 0.0], [0.0, 1.0]])
    noise = np.diag([(DISTANCE_SHARE * distance_m) ** 2, TURN_SIGMA_RAD**2])
    covariance = by_pose @ pose.covariance @ by_pose.T + by_motion @ noise @ by_motion.T
    return Pose(mean, covariance)
