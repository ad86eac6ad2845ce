"""The shipped encounters: nobody is touched, and what it costs, against simple policies."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from bus.messages import Arrival, LedgerEntry, ReactionDecision, RunEnded, TrueEncounter
from bus.turns import Module
from scenarios.modules import build_module
from scenarios.scenario import check
from tests.scenarios.encounters import KINDS, Stops, drawn, replacing
from tests.scenarios.outcomes import unmoved
from tests.scenarios.runs import everything_said, of_kind, shipped

SEEDS = range(3)


def touched(kind: str, seed: int, build: Callable[..., Module]) -> bool:
    said = everything_said(check(drawn(kind, seed), kind), build)
    return any(met.collided for met in of_kind(said, TrueEncounter))


@pytest.mark.parametrize("name", sorted({name for name, _ in KINDS.values()}))
def test_the_shipped_encounter_ends_well(name: str) -> None:
    said = everything_said(shipped(name).scenario)
    assert of_kind(said, RunEnded)[-1].reason == "done"
    assert not any(met.collided for met in of_kind(said, TrueEncounter))
    assert not any(entry.cause for entry in of_kind(said, LedgerEntry))


@pytest.mark.parametrize(
    "kind", ["person walks by", "person does not yield", "box put down", "door opens", "false echo"]
)
def test_nobody_is_touched_whatever_is_drawn(kind: str) -> None:
    assert not any(touched(kind, seed, build_module) for seed in SEEDS)


@pytest.mark.parametrize("kind", ["person does not yield", "box put down", "door opens"])
def test_a_robot_that_never_reacts_is_touched(kind: str) -> None:
    assert any(touched(kind, seed, unmoved) for seed in SEEDS)


def test_a_robot_that_always_stops_is_run_into_and_never_gets_past_a_box() -> None:
    stops = replacing(Stops)
    assert touched("person does not yield", 0, stops)
    said = everything_said(check(drawn("box put down", 0), "box"), stops)
    assert of_kind(said, RunEnded)[-1].reason == "stuck"
    assert of_kind(said, Arrival) == []


def test_a_false_echo_is_not_taken_for_somebody() -> None:
    said = everything_said(shipped("false-echo").scenario)
    assert all(one.act != "stop" for one in of_kind(said, ReactionDecision))
    first = of_kind(said, Arrival)[0].drive_s - 17.0 / 0.085
    assert first < 20.0


def test_the_same_seed_is_drawn_alike() -> None:
    assert all(drawn(kind, 5) == drawn(kind, 5) != drawn(kind, 6) for kind in KINDS)
