"""The shipped scenarios, held against committed baselines: no decision comes at another time."""

from __future__ import annotations

import pytest

from scenarios.testing.baselines import Baseline
from scenarios.testing.runs import Runs

SEEDS = range(1, 3)


def of(scenario: str, profile: str) -> object:
    marked = pytest.mark.waywiser(scenario, seeds=SEEDS, set={"compute.profile": profile})
    return pytest.param(f"{scenario}-{profile}", marks=marked, id=f"{scenario}-{profile}")


@pytest.mark.parametrize(
    "name",
    [
        of("aces", "host"),
        of("aces", "huey-1990"),
        of("office-4x4", "host"),
        of("office-4x4", "huey-1990"),
    ],
)
def test_every_decision_is_what_it_was(name: str, runs: Runs, baseline: Baseline) -> None:
    assert baseline.holds(runs, name)
    assert all(run.ended == "done" for run in runs)
    assert runs.deadlines("path").slack_at_least("5 s")
    # The classifier takes the longest plans that fit, and may take all the time there is.
    assert runs.deadlines("sensing").slack_at_least("1 s")
    assert runs.deadlines("reaction").all_met()
