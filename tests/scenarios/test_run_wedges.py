"""Whole runs with other numbers of wedges, and among doors that stand open."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from bus.features import Wedges
from bus.messages import LedgerEntry, MapBelief, Motion, Reading, RunEnded, TrueBuilding, TrueErrand
from bus.wire import Sent
from logs.truth import Truth
from scenarios.calibrate_detectors import calibrate
from scenarios.modules import ModuleRefusedError
from tests.scenarios.outcomes import probability_of_truth
from tests.scenarios.runs import LITTLE, everything_said, of_kind, scenario_of

CAREFUL = {"modules__classifier__wrong_type_s": 1e7}


@pytest.fixture(scope="module", params=[4, 12])
def made(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A number of wedges and the file of a small model for it."""
    path = tmp_path_factory.mktemp("models") / f"{request.param}.json"
    path.write_text(calibrate(60, seed=1, wedges=Wedges(request.param)).as_json())
    return request.param, path


def whole(said: tuple[Sent, ...]) -> None:
    """The errands are done, the map is known, nothing was late."""
    assert [ended.reason for ended in of_kind(said, RunEnded)] == ["done"]
    assert len(of_kind(said, TrueErrand)) == 2
    assert all(not entry.cause for entry in of_kind(said, LedgerEntry))
    (building,) = of_kind(said, TrueBuilding)
    assert probability_of_truth(of_kind(said, MapBelief)[-1], building) > 0.99


def test_a_run_with_another_number_of_wedges(made: tuple[int, Path]) -> None:
    count, path = made
    said = everything_said(
        scenario_of(LITTLE, sensing__wedges=count, modules__classifier__sensor_model=str(path))
    )
    whole(said)
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


def test_doors_that_stand_open_beside_the_junctions_are_no_corridors() -> None:
    west, south = [[0, 0], [0, 1]], [[0, 0], [1, 0]]
    doors = [
        {"corridor": west, "at_m": 0.2, "side": "left", "depth_m": 3.0},
        {"corridor": west, "at_m": 18.0, "side": "left", "depth_m": 3.0},
        {"corridor": south, "at_m": 20.1, "side": "right", "depth_m": 3.0},
        {"corridor": south, "at_m": 0.0, "side": "right", "width_m": 0.8},
    ]
    said = everything_said(scenario_of(LITTLE, world__doorway=doors, **CAREFUL))
    whole(said)
    truth = Truth()
    for sent in said:
        truth.hear(sent.message)
        if isinstance(sent.message, Reading):
            assert truth.feature(sent.message) == (sent.message.evidence >= 2)
    assert len(of_kind(said, Reading)) > 6
