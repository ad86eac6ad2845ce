"""CARMEN logs of a robot that drives through a made-up floor plan."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from simworld.floor_plan import FloorPlan
from simworld.motion import Pose

SPEED_M_S = 0.4
BEGINS_S = 100.0
"""The logger's clock when the first line is written."""

EVERY_M = 0.8
FARTHEST_M = 20.0


def way_through(corners_m: Sequence[tuple[float, float]]) -> list[Pose]:
    """Poses every EVERY_M along straight legs, and at their ends."""
    poses = []
    for (ax, ay), (bx, by) in pairwise(corners_m):
        heading = math.atan2(by - ay, bx - ax)
        steps = max(1, round(math.dist((ax, ay), (bx, by)) / EVERY_M))
        shares = np.arange(steps) / steps
        poses += [Pose(ax + s * (bx - ax), ay + s * (by - ay), heading) for s in shares.tolist()]
    last = corners_m[-1]
    return [*poses, Pose(last[0], last[1], poses[-1].heading_rad)]


def log_text(plan: FloorPlan, poses: Iterable[Pose], beams: int = 180) -> str:
    """A corrected log: the wheels, a scan, and the line that a mapper adds without a time."""
    lines, time_s, before = ["# message formats defined: ODOM FLASER"], BEGINS_S, None
    for pose in poses:
        if before is not None:
            time_s += math.dist((pose.x_m, pose.y_m), (before.x_m, before.y_m)) / SPEED_M_S
            time_s += abs(math.remainder(pose.heading_rad - before.heading_rad, math.tau))
        at = f"{pose.x_m:.6f} {pose.y_m:.6f} {pose.heading_rad:.6f}"
        ranges = " ".join(f"{r:.2f}" for r in ranges_m(plan, pose, beams))
        lines.append(f"ODOM {at} 0 0 0 {time_s:.6f} host {time_s:.6f}")
        lines.append(f"FLASER {beams} {ranges} {at} {at} {time_s:.6f} host {time_s:.6f}")
        lines.append(f"ODOM {at} 0 0 0 0 host 0")
        before = pose
    return "\n".join(lines) + "\n"


def ranges_m(plan: FloorPlan, pose: Pose, beams: int) -> NDArray[np.float64]:
    """How far each beam gets: on and on by the clearance, which it cannot overshoot."""
    step_rad = math.pi / (beams - beams % 2)
    angles = pose.heading_rad - math.pi / 2 + np.arange(beams) * step_rad
    far_m = np.zeros(beams)
    for _ in range(200):
        x_m, y_m = pose.x_m + far_m * np.cos(angles), pose.y_m + far_m * np.sin(angles)
        free_m = plan.clearance_m(x_m, y_m)
        far_m = np.minimum(far_m + 0.7 * free_m, FARTHEST_M)
    return far_m
