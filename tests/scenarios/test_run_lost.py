"""A robot that has lost its place: what it believes is the posterior over (place, map) pairs.

Whole runs on a 3 by 3 grid, where all 1759 connected maps can be listed for every place.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from bus.facts import Recall
from bus.grid import EAST, Grid
from bus.messages import AtErrand, Blocked, Registrations, RunEnded, TrueErrand
from bus.wire import Sent
from modules.geographer.registration import Registration
from scenarios.ground import draw_ground, generator
from scenarios.scenario import Scenario
from tests.decider.path_reference import all_maps
from tests.scenarios.joint import Moment
from tests.scenarios.joint_lost import LostWalk, lost_walk
from tests.scenarios.outcomes import unmoved
from tests.scenarios.runs import Table, everything_said, of_kind, scenario_of
from tests.scenarios.test_run_beliefs import AGREES, MAPS, SENSOR

GRID = Grid(3, 3)

LOST: Table = {
    "about": "a robot that may be in three places",
    "world": {
        "columns_m": [0.0, 20.0, 40.0],
        "rows_m": [0.0, 20.0, 40.0],
        "start": {"junction": [1, 1], "heading": "E", "ahead_m": 6.0},
        "until_s": 20_000,
    },
    "recall": {
        "may_be_at": [
            {"at": [1, 1], "probability": 0.4},
            {"at": [2, 1], "probability": 0.3},
            {"at": [1, 2], "probability": 0.3},
        ],
        "places": [
            {"at": [1, 1], "open": "NEW", "certain": 0.6},
            {"at": [0, 0], "open": "NE", "certain": 0.9},
        ],
    },
    "errand": [{"from": [0, 0], "to": [2, 0]}, {"from": [2, 2], "to": [0, 2]}],
    "compute": {"profile": "free"},
}


def building(seed: int) -> list[list[tuple[int, int]]]:
    """A connected building where the robot can begin in the middle and do its errands."""
    rng = np.random.default_rng(seed)
    west = GRID.corridor(0, 1, EAST)
    types = GRID.junction_types(MAPS)
    fit = MAPS[(MAPS[:, west] == 1) & (types[:, [0, 2, 6, 8]] > 0).all(axis=1)]
    chosen = fit[rng.integers(len(fit))]
    return [
        [GRID.place(a), GRID.place(b)]
        for a, b in (GRID.ends(int(c)) for c in np.flatnonzero(chosen))
    ]


HASTY: dict[str, Any] = {
    "world__sonar": {"dropout": 0.5, "cross_talk": 0.3},
    "modules__classifier": {"wrong_type_s": 200.0, "heeds_stakes": False},
}
"""Hears badly and hardly looks: it mistakes junctions, and runs into walls."""


def lost(seed: int) -> Scenario:
    changes = HASTY if seed in MISTAKEN else {}
    return scenario_of(LOST, seed=seed, world__corridors=building(seed), **changes)


@dataclass(frozen=True)
class Checked:
    said: Sequence[Sent]
    moments: list[Moment]
    robot: LostWalk


def checked(seed: int, build: Any = unmoved) -> Checked:
    scenario = lost(seed)
    said = everything_said(scenario, build)
    recall = draw_ground(scenario, generator(scenario)).facts.recall
    assert isinstance(recall, Recall)
    return Checked(said, *lost_walk(GRID, MAPS, SENSOR.probability, SENSOR.astray, recall, said))


run = cache(checked)
MISTAKEN = (5, 6)
SEEDS = (1, 3, *MISTAKEN)


def worst(found: Checked) -> float:
    return max(float(np.abs(moment.said - moment.expected).max()) for moment in found.moments)


def test_the_grid_is_that_of_the_list() -> None:
    assert len(all_maps(GRID)) == len(MAPS)


@pytest.mark.parametrize("seed", SEEDS)
def test_every_belief_is_the_posterior_over_places_and_maps(seed: int) -> None:
    found = run(seed)
    assert found.robot.most > 1
    assert len(found.moments) > 20
    assert worst(found) < AGREES


@pytest.mark.parametrize("seed", SEEDS)
def test_errands_are_done_and_looked_for(seed: int) -> None:
    said = run(seed).said
    assert [ended.reason for ended in of_kind(said, RunEnded)] == ["done"]
    assert [done.errand for done in of_kind(said, TrueErrand)] == [0, 1]
    seen = of_kind(said, AtErrand)
    assert [one.waypoint for one in seen if one.here] == [0, 2, 8, 6]
    # nobody tells where the robot is before it was found out
    told = [s.message for s in said if isinstance(s.message, AtErrand | Registrations)]
    first = next(k for k, one in enumerate(told) if isinstance(one, AtErrand) and one.here)
    assert not any(isinstance(one, Registrations) for one in told[first:])


def test_the_runs_hold_what_could_go_wrong() -> None:
    nobody = [one for seed in SEEDS for one in of_kind(run(seed).said, AtErrand) if not one.here]
    assert nobody
    assert any(of_kind(run(seed).said, Blocked) for seed in SEEDS)
    assert any(run(seed).robot.most == 3 for seed in SEEDS)


def test_weights_without_what_was_scaled_away_are_noticed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = Registration.classified

    def scaled(self: Registration, likelihood: Any) -> Registration:
        found = whole(self, likelihood)
        return replace(found, record=replace(found.record, log_scale=self.record.log_scale))

    monkeypatch.setattr(Registration, "classified", scaled)
    assert any(worst(checked(seed)) > 1e-3 for seed in SEEDS)
