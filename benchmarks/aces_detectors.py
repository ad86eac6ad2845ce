"""Feature detectors on a real robot's laser scans at the junctions of the ACES building.

    python -m benchmarks.aces_detectors [--log FILE] [--within M]

Builds the floor plan from the log, surveys it, and enters every junction by every corridor it
has. Each detector whose view was scanned interprets what a ring at its vantage would have heard
(:mod:`simworld.laser_ring`), the classifier multiplies the likelihoods of the evidence. Nothing
was fitted to this building. The truth is the survey's, which agrees with the map by eye; there are
rooms and stubs at some junctions that no scan can tell from corridors, so what is found is also
compared with the sides that are open, by the plan, for ``OPEN_M`` straight on.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from bus.features import DOOR_JAMB, FEATURES, USUAL
from bus.grid import DIRECTIONS, LETTER, OPPOSITE, type_name
from modules.classifier.geometry import presence
from modules.classifier.likelihood import Reading, junction_likelihood
from modules.classifier.sensor_model import SHIPPED, SensorModel, load_sensor_model
from modules.detectors.interpret import interpret
from modules.detectors.views import view_of
from simworld.carmen import Scan, read_carmen
from simworld.floor_plan import FloorPlan
from simworld.laser_ring import ring_readings
from simworld.motion import HEADING_RAD
from simworld.occupancy import plan_of_scans
from simworld.survey import Junction, survey
from simworld.survey.space import Space, space_of
from simworld.survey.surveying import ROBOT_RADIUS_M

LOG = Path("../shared/maps/aces/aces-corrected.log.gz")
WIDTH_M = 2.0
NEEDED = 4
"""Transducers to each side of the view that detectors listen to: 50 degrees and its cone."""

OPEN_M = 4.0
"""A side is open if the robot could drive so far out of it from the junction's middle."""


@dataclass(frozen=True)
class Entry:
    """One junction entered by one heading: the evidence, and the types' probabilities.

    ``open_sides`` is the junction type that the plan shows if stubs are corridors.
    """

    junction: Junction
    open_sides: int
    heading: int
    readings: tuple[Reading, ...]
    posterior: tuple[float, ...]

    @property
    def found(self) -> int:
        """The most probable type."""
        return int(np.argmax(self.posterior))


def entries(scans: tuple[Scan, ...], within_m: float, model: SensorModel) -> Iterator[Entry]:
    """Every way into every junction that the scans show."""
    plan = plan_of_scans(scans)
    found = survey(plan)
    space = space_of(plan, ROBOT_RADIUS_M)
    for junction in found.junctions:
        if junction.at_m is None:
            continue
        c, s = math.cos(-found.turn_rad), math.sin(-found.turn_rad)
        x, y = junction.at_m
        at_m = c * x - s * y, s * x + c * y
        axes = {side: HEADING_RAD[side] - found.turn_rad for side in DIRECTIONS}
        sides = sum(side for side in DIRECTIONS if _open(plan, space, at_m, axes[side]))
        for heading in DIRECTIONS:
            if junction.type & OPPOSITE[heading]:
                readings = tuple(_readings(scans, at_m, axes[heading], within_m))
                posterior = _posterior(readings, heading, model)
                yield Entry(junction, sides, heading, readings, posterior)


def _open(plan: FloorPlan, space: Space, at_m: tuple[float, float], axis_rad: float) -> bool:
    """Whether the robot could drive straight on from a point for OPEN_M."""
    far = np.linspace(0.0, OPEN_M, 81)
    u, v = plan.to_image(at_m[0] + far * math.cos(axis_rad), at_m[1] + far * math.sin(axis_rad))
    return all(space.clearance_m(a, b) > ROBOT_RADIUS_M for a, b in zip(u, v, strict=True))


def _readings(
    scans: tuple[Scan, ...], at_m: tuple[float, float], axis_rad: float, within_m: float
) -> Iterator[Reading]:
    """What each detector finds whose view was scanned; none for the others."""
    for feature in range(len(FEATURES)):
        for wedge in range(USUAL.count):
            view = view_of(feature, wedge)
            along_m = (view.vantage - 1.0) * WIDTH_M / 2
            x, y = at_m[0] + along_m * math.cos(axis_rad), at_m[1] + along_m * math.sin(axis_rad)
            ranges_m, seen = ring_readings(scans, x, y, axis_rad + view.facing_rad, within_m)
            whole = seen[:, np.arange(-NEEDED, NEEDED + 1)].all(axis=1)
            if not whole.any():
                continue
            finding = interpret(
                feature, wedge, ranges_m[whole], np.zeros(int(whole.sum())), WIDTH_M
            )
            yield Reading(USUAL.code(feature, wedge), finding.evidence)


def _posterior(
    readings: tuple[Reading, ...], heading: int, model: SensorModel
) -> tuple[float, ...]:
    """Over the types that can be entered by this heading, equally likely before."""
    likelihood = junction_likelihood(readings, heading, model)
    return tuple((likelihood / likelihood.sum()).tolist())


def right(entry: Entry, reading: Reading) -> bool:
    """Whether the evidence agrees with the truth; a door jamb that may be there counts as right."""
    chance = presence(entry.junction.type, entry.heading)[USUAL.parts(reading.detector)]
    return 0.0 < chance < 1.0 or bool(chance) == (reading.evidence >= 2)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--log", type=Path, default=LOG)
    parser.add_argument("--within", type=float, default=1.0, help="metres from a vantage")
    given = parser.parse_args()
    found = list(entries(read_carmen(given.log).scans, given.within, load_sensor_model(SHIPPED)))
    console = Console(width=110)
    table = Table(title="junctions, by how they are entered")
    for name in ("junction", "true type", "open", "heading", "detectors", "right", "found"):
        table.add_column(name)
    for entry in found:
        table.add_row(
            str(list(entry.junction.place)),
            type_name(entry.junction.type),
            type_name(entry.open_sides),
            LETTER[entry.heading],
            str(len(entry.readings)),
            str(sum(right(entry, reading) for reading in entry.readings)),
            type_name(entry.found) if entry.readings else "(nothing seen)",
        )
    console.print(table)
    console.print(_by_feature(found))
    seen = [entry for entry in found if entry.readings]
    good = sum(entry.found == entry.junction.type for entry in seen)
    sides = sum(entry.found == entry.open_sides for entry in seen)
    console.print(f"of {len(seen)} entries, the most probable type is the true one in {good},")
    console.print(f"and that of the open sides, stubs and rooms among them, in {sides}")


def _by_feature(found: list[Entry]) -> Table:
    table = Table(title="readings that agree with the truth")
    for name in ("feature", "where it is present", "where it is not"):
        table.add_column(name)
    for feature, name in enumerate(FEATURES[:DOOR_JAMB]):  # nobody wrote down where doors are
        counted = {True: [0, 0], False: [0, 0]}
        for entry in found:
            present = presence(entry.junction.type, entry.heading)[feature]
            for reading in entry.readings:
                looked_for, wedge = USUAL.parts(reading.detector)
                if looked_for == feature:
                    counted[bool(present[wedge])][0] += right(entry, reading)
                    counted[bool(present[wedge])][1] += 1
        table.add_row(name, *(f"{good} of {of}" for good, of in counted.values()))
    return table


if __name__ == "__main__":
    main()
