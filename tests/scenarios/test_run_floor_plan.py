"""A robot among the echoes of a floor plan whose corridors lie beside the grid lines."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from bus.grid import LETTER
from bus.messages import Arrival, TruePose
from scenarios.draw import draw
from scenarios.scenario import check
from simworld.crossing import crossing_m
from simworld.floor_plan import FloorPlan
from simworld.motion import HEADING_RAD
from simworld.occupancy import write_floor_plan
from tests.scenarios.outcomes import unmoved
from tests.scenarios.runs import everything_said
from tests.simworld.drawn_plans import drawn_plan

WIDTH_M = 1.8
OFF_M = 0.5
"""The northern corridor and the western one lie so far from their lines."""


def table(plan: Path) -> dict[str, object]:
    return {
        "about": "a ring, two of its corridors beside their lines",
        "world": {
            "columns_m": [0.0, 20.0],
            "rows_m": [0.0, 16.0],
            "corridor_width_m": WIDTH_M,
            "floor_plan": str(plan),
            "start": {"junction": [1, 0], "heading": "E"},
            "until_s": 1500.0,
        },
        "random_errands": {"count": 5},
        "compute": {"profile": "free"},
    }


def test_it_stops_at_the_ports_of_the_real_corridors(tmp_path: Path) -> None:
    west, north, half = OFF_M, 16.0 - OFF_M, WIDTH_M / 2
    boxes = [
        (west - half, -half, 20.0 + half, half),
        (west - half, north - half, 20.0 + half, north + half),
        (west - half, -half, west + half, north + half),
        (20.0 - half, -half, 20.0 + half, north + half),
    ]
    path = tmp_path / "ring.yaml"
    write_floor_plan(drawn_plan(boxes, resolution_m=0.05), path)
    scenario = check(table(path), "a ring")
    drawn = draw(scenario, "a ring")
    plan, building = drawn.plan.surroundings, drawn.plan.building
    assert isinstance(plan, FloorPlan)
    assert drawn.facts.corridor_width_m == WIDTH_M
    arrived: list[tuple[int, TruePose]] = []
    heading = 0
    for sent in everything_said(scenario, unmoved):
        if isinstance(sent.message, Arrival):
            heading = sent.message.heading
        elif isinstance(sent.message, TruePose):
            arrived.append((heading, sent.message))
    assert len({pose.place for _, pose in arrived}) == 4
    for heading, pose in arrived:
        x_m, y_m = crossing_m(plan, building, pose.place)
        c, s = math.cos(HEADING_RAD[heading]), math.sin(HEADING_RAD[heading])
        port = x_m - c * half, y_m - s * half
        # The reflex errs by 3 cm each way (one standard deviation).
        assert math.dist(port, (pose.x_m, pose.y_m)) < 0.15, (LETTER[heading], pose)
    lines = {p: building.position_m(*building.grid.place(p)) for p in range(4)}
    off_m = [math.dist(crossing_m(plan, building, p), lines[p]) for p in range(4)]
    assert max(off_m) == pytest.approx(OFF_M / math.sqrt(2), abs=0.15)
