"""The ACES building, over and over: the errands are done and the map is learnt."""

from __future__ import annotations

import pytest

from modules.geographer import ConnectedMaps
from tests.scenarios.outcomes import Outcome, outcomes, unmoved
from tests.scenarios.runs import MAPS

SEEDS = range(1, 21)
PLAN = MAPS / "aces" / "aces.yaml"


@pytest.fixture(scope="module")
def runs() -> list[Outcome]:
    return outcomes("aces", SEEDS, "compute.profile=host")


def test_all_errands_are_done(runs: list[Outcome]) -> None:
    assert [(run.reason, run.errands) for run in runs] == [("done", 6)] * len(SEEDS)


def test_the_true_map_is_known_in_the_end(runs: list[Outcome]) -> None:
    # one of 1759 maps, and nobody told the robot which
    assert ConnectedMaps(3, 3).count == 1759
    unsure = [run.seed for run in runs if run.true_map <= 0.99]
    assert len(unsure) <= 1, unsure


def test_no_decision_is_late_at_the_prices_of_this_machine(runs: list[Outcome]) -> None:
    assert {run.seed: run.late for run in runs if run.late} == {}


def test_nobody_is_run_into(runs: list[Outcome]) -> None:
    assert sum(run.collisions for run in runs) == 0


@pytest.mark.skipif(not PLAN.is_file(), reason=f"needs the floor plan {PLAN}")
def test_the_map_is_learnt_from_the_echoes_of_the_real_building() -> None:
    # Things stand in the middle of that building's corridors. A robot that knows no way round
    # them would wait for them for ever, so it drives on here; what is shown is the perception.
    changes = (f"world.floor_plan={PLAN}", "world.person=[]", "world.until_s=20000")
    runs = outcomes("aces", range(1, 9), *changes, build=unmoved)
    assert [(run.reason, run.errands) for run in runs] == [("done", 6)] * len(runs)
    assert not any(run.late for run in runs)
    sure = [run.seed for run in runs if run.most_probable and run.true_map > 0.99]
    # where the plan's recesses and doors look like what they are not, a corridor is lost
    assert len(sure) >= 6, sure


@pytest.mark.skipif(not PLAN.is_file(), reason=f"needs the floor plan {PLAN}")
def test_a_day_is_done_among_the_echoes_and_the_people_of_the_real_building() -> None:
    # door frames and what stands about are passed, not waited for
    runs = outcomes("aces", (1, 2), f"world.floor_plan={PLAN}")
    assert [(run.reason, run.errands) for run in runs] == [("done", 6)] * 2
    # three people a day, who may come from behind a door frame: some are heard late
    assert sum(run.collisions for run in runs) <= 2
    assert all(cause.endswith("late input") for run in runs for cause in run.late)
