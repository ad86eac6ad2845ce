"""From the floor plan of a real building to a robot that learns its map: survey, scenario, run."""

from __future__ import annotations

import pytest

from benchmarks.floor_plans import MAPS as PLANS
from benchmarks.floor_plans import day, surveyed
from tests.scenarios.outcomes import unmoved
from tests.scenarios.runs import MAPS

ROOM = (4, 0), (4, 1)
"""The K-wing's fifth rung leads through a room: from the corridors its doors of 0.7 m are walls."""

RECESSES = (1, 0), (2, 0)
"""The corridor of ACES that is lost on some days: at its ends, recesses look like what they are
not (benchmarks/README.md)."""


@pytest.mark.parametrize(
    ("name", "always", "sometimes"), [("aces", (), (RECESSES,)), ("k-wing", (ROOM,), ())]
)
def test_a_surveyed_building_is_learnt_from_its_echoes(
    name: str, always: tuple[object, ...], sometimes: tuple[object, ...]
) -> None:
    path = MAPS / PLANS[name]
    if not path.is_file():
        pytest.skip(f"needs the floor plan {path}")
    ended = day(surveyed(path), 12, unmoved, 3)
    assert (ended.reason, ended.errands, ended.late) == ("done", 12, 0)
    assert set(always) <= set(ended.wrong) <= {*always, *sometimes}
    assert (ended.true_map > 0.99) == (not ended.wrong)
