"""From the floor plan of a real building to a robot that learns its map: survey, scenario, run."""

from __future__ import annotations

import pytest

from benchmarks.floor_plans import MAPS as PLANS
from benchmarks.floor_plans import day, surveyed
from tests.scenarios.outcomes import unmoved
from tests.scenarios.runs import MAPS

LOST: dict[str, set[tuple[tuple[int, int], tuple[int, int]]]] = {
    "aces": set(),
    "k-wing": {((0, 0), (1, 0)), ((2, 0), (2, 1)), ((3, 0), (3, 1)), ((4, 0), (4, 1))},
}
"""Corridors that are lost on some days: rungs of the K-wing that begin with doorways, one of which
leads through a room (benchmarks/README.md)."""


@pytest.mark.parametrize("name", LOST)
def test_a_surveyed_building_is_learnt_from_its_echoes(name: str) -> None:
    path = MAPS / PLANS[name]
    if not path.is_file():
        pytest.skip(f"needs the floor plan {path}")
    ended = day(surveyed(path), 12, unmoved, 3)
    assert (ended.reason, ended.errands, ended.late) == ("done", 12, 0)
    assert set(ended.wrong) <= LOST[name]
    assert len(ended.wrong) <= 1
    assert (ended.true_map > 0.9) == (not ended.wrong)
