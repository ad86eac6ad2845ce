"""Runs whose belief costs what the paper's network does: the misses and the waiting are real."""

from __future__ import annotations

import pytest

from benchmarks.deadline_story import CHANGES, CHOICE, DRIVE_S, GRID, LEFT_FOR_OTHERS_S, run
from benchmarks.paper_prices import Networks, forced, largest_in

SHORT = (*CHANGES, "world.until_s=900")
NETWORKS = Networks(GRID)
MIDDLE = (5, 6, 9, 10)
"""The four junctions in the middle of the grid: what is left around them has small cliques."""


def middle(*_asked: object) -> list[int]:
    return list(MIDDLE)


def corner(*_asked: object) -> list[int]:
    """Four junctions along an edge: the whole of the rest is unexplored."""
    return [0, 1, 2, 3]


def test_a_forced_size_that_does_not_fit_is_late_and_the_robot_stands(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("benchmarks.deadline_story.random_walk", corner)
    late = run(1, forced(10), NETWORKS, 4, SHORT, grows=False)
    takes_s = late.updates[0].seconds
    assert takes_s == pytest.approx(312.7, abs=0.1)  # 30 hypotheses would take 934 s
    first, *_ = late.on_the_way("path")
    assert first.cause in ("late input", "overrun")
    # it is heard a little more than an update after it was asked; all that is beyond is idle
    waited_s = -first.slack_ns / 1e9
    assert waited_s == pytest.approx(takes_s - DRIVE_S, abs=45.0)
    assert late.day.idle_s() > waited_s / 2


def test_the_same_size_is_in_time_once_the_middle_is_explored(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("benchmarks.deadline_story.random_walk", middle)
    found = run(1, forced(30), NETWORKS, 4, SHORT, grows=False)
    paths = found.on_the_way("path")
    assert paths
    assert not any(entry.cause or entry.idle_ns for entry in paths)


@pytest.mark.parametrize("walk", [corner, middle])
def test_the_fixed_time_procedure_takes_the_most_hypotheses_that_fit(
    walk: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("benchmarks.deadline_story.random_walk", walk)
    within_s = DRIVE_S - LEFT_FOR_OTHERS_S
    found = run(1, largest_in(NETWORKS, CHOICE, within_s), NETWORKS, 4, SHORT, grows=False)
    update = found.updates[0]
    larger = [n for n in CHOICE if n > update.states]
    assert update.seconds <= within_s
    for states in larger[:1]:
        assert 2.09 + 0.948e-3 * NETWORKS.cells(states, walk()) > within_s  # type: ignore[operator]
    assert not any(entry.cause for entry in found.on_the_way("path"))


def test_an_update_is_charged_the_largest_clique_at_table_1s_price() -> None:
    found = run(1, forced(10), NETWORKS, 6, SHORT, grows=True)
    for update in found.updates:
        assert update.seconds == pytest.approx(2.09 + 0.948e-3 * update.cells)
    lengths = [update.length for update in found.updates]
    assert lengths[0] == 6
    assert lengths == sorted(lengths)
