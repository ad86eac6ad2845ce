"""Whole runs with other numbers of wedges, and among doors beside the junctions."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from bus.features import Wedges
from bus.grid import NORTH, Grid
from bus.messages import (
    Blocked,
    LedgerEntry,
    MapBelief,
    Motion,
    Reading,
    RunEnded,
    TrueBuilding,
    TrueErrand,
)
from bus.wire import Sent
from logs.truth import Truth
from scenarios.calibrate_detectors import calibrate
from scenarios.modules import ModuleRefusedError
from tests.scenarios.outcomes import probability_of_truth
from tests.scenarios.runs import LITTLE, everything_said, of_kind, scenario_of


@pytest.fixture(scope="module", params=[4, 12])
def made(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A number of wedges and the file of a small model for it."""
    path = tmp_path_factory.mktemp("models") / f"{request.param}.json"
    path.write_text(calibrate(40, seed=1, wedges=Wedges(request.param)).as_json())
    return request.param, path


SURE = {4: 0.9, 12: 0.99}
"""How probable the true map is at least in the end, by the number of wedges. Four hold no corners:
the robot is content with less."""


def whole(said: tuple[Sent, ...], sure: float) -> None:
    """The errands are done, the map is known, nothing was late."""
    assert [ended.reason for ended in of_kind(said, RunEnded)] == ["done"]
    assert len(of_kind(said, TrueErrand)) == 2
    assert all(not entry.cause for entry in of_kind(said, LedgerEntry))
    (building,) = of_kind(said, TrueBuilding)
    assert probability_of_truth(of_kind(said, MapBelief)[-1], building) > sure


def test_a_run_with_another_number_of_wedges(made: tuple[int, Path]) -> None:
    count, path = made
    said = everything_said(
        scenario_of(LITTLE, sensing__wedges=count, modules__classifier__sensor_model=str(path))
    )
    whole(said, SURE[count])
    readings = of_kind(said, Reading)
    assert {reading.wedges for reading in readings} == {count}
    tested = [Wedges(count).code(reading.feature, reading.wedge) for reading in readings]
    assert tested == [motion.detector for motion in of_kind(said, Motion)]


def test_a_model_of_another_number_of_wedges_is_refused(made: tuple[int, Path]) -> None:
    count, path = made
    for changes, says in (
        ({"sensing__wedges": count}, f"made with 8 wedges, expected {count}"),
        ({"modules__classifier__sensor_model": str(path)}, f"made with {count} wedges, expected 8"),
    ):
        with pytest.raises(ModuleRefusedError, match=says):
            everything_said(scenario_of(LITTLE, **changes))


LADDER: dict[str, Any] = {
    "about": "a ring of six corridors whose middle rung is missing, doors where it would end",
    "world": {
        "columns_m": [0.0, 20.0, 40.0],
        "rows_m": [0.0, 18.0],
        "corridors": [
            [[0, 0], [1, 0]], [[1, 0], [2, 0]], [[0, 1], [1, 1]],
            [[1, 1], [2, 1]], [[0, 0], [0, 1]], [[2, 0], [2, 1]],
        ],
        "start": {"junction": [0, 0], "heading": "S", "ahead_m": 6.0},
        "doorway": [
            {"corridor": [[0, 0], [1, 0]], "at_m": 20.2, "side": "left"},
            {"corridor": [[0, 1], [1, 1]], "at_m": 19.8, "side": "right"},
        ],
    },
    "errand": [
        {"from": [0, 0], "to": [2, 1], "expected_again": 3.0},
        {"from": [2, 1], "to": [0, 0], "expected_again": 3.0},
    ],
    "compute": {"profile": "host"},
}  # fmt: skip


DOORS = (1, 4)
"""The junctions that have a door beside them."""

RUNG = Grid(3, 2).corridor(1, 0, NORTH)


def misread(said: tuple[Sent, ...]) -> tuple[list[int | None], int]:
    """At which junctions a reading was wrong, and how many readings there were beside doors."""
    truth = Truth()
    wrong, of_the_doors = [], 0
    for sent in said:
        truth.hear(sent.message)
        if isinstance(sent.message, Reading):
            place = truth.place(sent.message.visit)
            of_the_doors += place in DOORS
            if truth.feature(sent.message) != (sent.message.evidence >= 2):
                wrong.append(place)
    return wrong, of_the_doors


@pytest.mark.parametrize("seed", [1, 2])
def test_closed_doors_beside_the_junctions_are_no_corridors(seed: int) -> None:
    said = everything_said(scenario_of(LADDER, seed=seed))
    assert [ended.reason for ended in of_kind(said, RunEnded)] == ["done"]
    assert of_kind(said, MapBelief)[-1].corridors[RUNG] < 0.01
    wrong, of_the_doors = misread(said)
    assert not wrong
    assert of_the_doors
    assert not of_kind(said, Blocked)


@pytest.mark.parametrize("seed", [1, 2])
def test_an_open_door_that_reads_as_an_opening_is_found_out(seed: int) -> None:
    # it leads 3 m into a room: what tells it from a corridor's doorway is that there is no way on
    doors = [{**door, "depth_m": 3.0} for door in LADDER["world"]["doorway"]]
    said = everything_said(scenario_of(LADDER, seed=seed, world__doorway=doors))
    assert [ended.reason for ended in of_kind(said, RunEnded)] == ["done"]
    assert of_kind(said, MapBelief)[-1].corridors[RUNG] < 0.01
    wrong, of_the_doors = misread(said)
    assert of_the_doors
    assert set(wrong) <= set(DOORS)
    assert len(of_kind(said, Blocked)) == (1 if wrong else 0)
