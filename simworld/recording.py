"""A real robot's log, laid onto the grid of a building: all that is needed to play it back."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from simworld.building import Building
from simworld.carmen import CarmenError, Scan, read_carmen
from simworld.floor_plan import FloorPlan, FloorPlanError
from simworld.laser_ring import ring_readings
from simworld.motion import Pose
from simworld.occupancy import plan_of_scans
from simworld.playback import Timed, log_begins_s, percepts
from simworld.registration import Registration, register
from simworld.sonar import SonarRing, true_ranges_m
from simworld.tour import Stop, tour

WITHIN_M = 1.0
"""A scan tells what would be heard so near to where it was taken."""


@dataclass(frozen=True, eq=False)
class Recording:
    """A log on the grid lines of a building.

    - ``percepts``: what the robot sensed and where it was, with times, in order.
    - ``stops``: the junctions that it came through.
    - ``scans``, ``plan``: its scans, and the floor plan that they show, on the grid lines.
    """

    percepts: tuple[Timed, ...]
    stops: tuple[Stop, ...]
    scans: tuple[Scan, ...]
    plan: FloorPlan

    def ring_m(self, pose: Pose, ring: SonarRing) -> NDArray[np.float64]:
        """What a ring at a pose would have heard, (transducers,) in metres, nan for no echo.

        By the nearest scan, filled up by others within ``WITHIN_M``; where none of them looked,
        by the floor plan that the whole log shows.
        """
        heard_m = true_ranges_m(ring, self.plan, pose.x_m, pose.y_m, pose.heading_rad)
        heard_m = np.where(heard_m <= ring.farthest_m, heard_m, np.nan)
        near_m, seen = ring_readings(self.scans, pose.x_m, pose.y_m, pose.heading_rad, WITHIN_M)
        return np.where(seen[0], near_m[0], heard_m) if len(seen) else heard_m


def record(path: Path | str, building: Building) -> Recording:
    """Read a CARMEN log and lay it onto a building's grid lines.

    Raises CarmenError for a log that cannot be read, or that shows no plan on which the grid fits.
    """
    log = read_carmen(path)
    try:
        begins_s = log_begins_s(log)
        laid = register(plan_of_scans(log.scans), building.columns_m, building.rows_m)
        scans = moved_scans(log.scans, laid)
        said = percepts(log, scans, building)
    except (CarmenError, FloorPlanError) as error:
        raise CarmenError(f"{path}: {error}") from None
    return Recording(said, tour(scans, begins_s, building), scans, laid.plan)


def moved_scans(scans: Sequence[Scan], laid: Registration) -> tuple[Scan, ...]:
    """The scans with their poses turned and shifted as a plan was."""
    c, s = math.cos(laid.turn_rad), math.sin(laid.turn_rad)
    return tuple(
        replace(
            scan,
            x_m=c * scan.x_m - s * scan.y_m + laid.shift_m[0],
            y_m=s * scan.x_m + c * scan.y_m + laid.shift_m[1],
            heading_rad=math.remainder(scan.heading_rad + laid.turn_rad, math.tau),
        )
        for scan in scans
    )
