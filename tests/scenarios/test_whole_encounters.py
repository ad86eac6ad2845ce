"""People meet the robot in the whole system: a decision in time never ends in a collision."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from bus.messages import (
    AskedReaction,
    LedgerEntry,
    Message,
    Ranges,
    ReactionDecision,
    RunEnded,
    TrueEncounter,
    TrueErrand,
)
from bus.topics import REACTOR, heard_by
from bus.turns import Module, Turn
from bus.wire import Sent
from scenarios.draw import draw
from scenarios.in_process import run_in_process
from scenarios.modules import build_module
from scenarios.scenario import Scenario, check
from simworld.people import ACTS
from tests.scenarios.runs import everything_said, of_kind

LASTS_S = 26.0
"""From one person to the next: the slowest needs 12 m / 0.8 m/s = 15 s, and 3 s of quiet."""


def somebody(rng: np.random.Generator, at_s: float) -> dict[str, Any]:
    """A person of any line, speed and manners."""
    return {
        "enters": {"at_s": at_s, "ahead_m": float(rng.uniform(7.0, 10.0))},
        "walks_m_s": float(rng.uniform(0.8, 1.8)),
        "offset_m": float(rng.uniform(-0.75, 0.75)),
        "yields": bool(rng.random() < 0.5),
    }


def corridor(seed: int, people: int, compute: dict[str, Any]) -> dict[str, Any]:
    """A scenario: the robot under way in a long corridor, and people who come towards it."""
    rng = np.random.default_rng([seed, 5])
    return {
        "about": "Somebody comes",
        "seed": seed,
        "world": {
            "columns_m": [0.0, 32.0],
            "rows_m": [0.0],
            "start": {"junction": [1, 0], "heading": "E", "ahead_m": 28.0},
            "until_s": 3.0 + LASTS_S * people,
            "person": [somebody(rng, 3.0 + LASTS_S * k) for k in range(people)],
        },
        "compute": compute,
    }


@dataclass(frozen=True)
class Meeting:
    """One encounter of a run: its entry in the ledger, what it came to, what was said in it."""

    entry: LedgerEntry
    truth: TrueEncounter
    said: tuple[str, ...]


def meetings(seed: int, people: int, compute: dict[str, Any]) -> list[Meeting]:
    """The encounters of a run."""
    scenario = check(corridor(seed, people, compute), "corridor")
    sent: list[Sent] = []
    run_in_process(scenario, draw(scenario, "corridor"), sent.append)
    messages = [one.message for one in sent]
    asked = [m for m in messages if isinstance(m, AskedReaction)]
    entries = {m.decision: m for m in messages if isinstance(m, LedgerEntry)}
    truths = {m.encounter: m for m in messages if isinstance(m, TrueEncounter)}
    said = [(one.said_ns, one.message) for one in sent if one.topic == "decision/reaction"]
    ends_ns = [one.asked_ns for one in asked[1:]] + [2**62]
    return [
        Meeting(
            entries[one.decision],
            truths[one.encounter],
            tuple(
                m.act
                for at_ns, m in said
                if isinstance(m, ReactionDecision) and one.asked_ns <= at_ns < until_ns
            ),
        )
        for one, until_ns in zip(asked, ends_ns, strict=True)
    ]


@pytest.mark.parametrize("profile", ["free", "host"])
def test_in_time_nobody_is_touched(profile: str) -> None:
    share = range(0, 200, 2) if profile == "free" else range(1, 200, 2)
    met = [m for seed in share for m in meetings(seed, 1 + seed % 4 // 2, {"profile": profile})]
    assert len(met) == 150
    assert Counter(m.entry.cause for m in met) == {"": 150}
    assert all(m.entry.slack_ns > 0 and m.entry.cells > 0 for m in met)
    assert [m.truth for m in met if m.truth.collided] == []
    assert max(len(m.said) for m in met) <= 5
    assert sum(len(m.said) > 3 for m in met) <= 3
    assert all(m.said[-1] == "continue" for m in met)


def test_too_late_every_miss_is_an_overrun_and_people_are_run_into() -> None:
    slow = {"profile": "host", "slower": {"reaction": 8.0}}
    met = [m for seed in range(50) for m in meetings(seed, 1 + seed % 2, slow)]
    late = [m for m in met if m.entry.cause]
    assert {m.entry.cause for m in late} == {"overrun"}
    assert len(late) > 0.9 * len(met)
    assert sum(m.truth.collided for m in late) > 0.2 * len(met)
    assert not any(m.truth.collided for m in met if not m.entry.cause)
    assert all(m.entry.slack_ns < 0 for m in late)


def test_a_late_decision_about_one_person_does_not_count_for_the_next() -> None:
    # The first is thought about for 45 s; what comes of it is heard while the second comes.
    slow = {"profile": "free", "slower": {"reaction": 25.0}}
    first, second = meetings(1, 2, slow)
    assert first.entry.cause == second.entry.cause == "overrun"
    assert second.said != ()


def standing(offset_m: float, **world: Any) -> Scenario:
    """Something stands in a short corridor through which an errand leads."""
    person = {"enters": {"at_s": 3, "ahead_m": 3.0}, "walks_m_s": 0.0, "offset_m": offset_m}
    start = {"junction": [1, 0], "heading": "E", "ahead_m": 8.0}
    lines = {"columns_m": [0.0, 12.0], "rows_m": [0.0], "until_s": 5000.0}
    table = {
        "about": "Something was left in the corridor",
        "world": {**lines, "start": start, "person": [person], **world},
        "errand": [{"from": [1, 0], "to": [0, 0]}],
        "compute": {"profile": "host"},
    }
    return check(table, "a thing")


def end_of(said: tuple[Sent, ...]) -> tuple[str, int]:
    """Why a run ended, and when (ns)."""
    (end,) = [one for one in said if isinstance(one.message, RunEnded)]
    assert isinstance(end.message, RunEnded)
    return end.message.reason, end.said_ns


@pytest.mark.parametrize("offset_m", [-0.4, -0.2, 0.0, 0.2, 0.4])
def test_what_stands_is_passed_and_the_errand_done(offset_m: float) -> None:
    said = everything_said(standing(offset_m))
    assert end_of(said)[0] == "done"
    assert len(of_kind(said, TrueErrand)) == 1
    (met,) = of_kind(said, TrueEncounter)
    assert not met.collided and met.closest_m > 0.5
    acts = [one.act for one in of_kind(said, ReactionDecision)]
    assert acts[0].startswith("pass") and acts[-1] == "continue" and len(acts) <= 4


class Halts:
    """A reactor that stops the robot at the first ping, for ever."""

    def __init__(self) -> None:
        self.handlers = {topic.name: self._hear for topic in heard_by(REACTOR)}
        self._said = False

    def _hear(self, said: Message, turn: Turn) -> None:
        turn.work("note", 1)
        if isinstance(said, Ranges) and not self._said:
            self._said = True
            turn.say(ReactionDecision("stop", np.zeros(len(ACTS)), 0.0, said.fired_ns, 0.0))


def halting(name: str, *arguments: Any) -> Module:
    """What builds a run's modules, with a reactor that stops."""
    return Halts() if name == REACTOR else build_module(name, *arguments)


def test_a_robot_that_is_kept_standing_ends_the_run_when_its_patience_does() -> None:
    said = everything_said(standing(0.0, patience_s=100.0), halting)
    stopped = next(one.said_ns for one in said if one.topic == "decision/reaction")
    reason, ended = end_of(said)
    assert reason == "stuck"
    assert 100.0 <= (ended - stopped) / 1e9 <= 100.1


def test_the_same_seed_meets_alike() -> None:
    assert meetings(3, 1, {"profile": "host"}) == meetings(3, 1, {"profile": "host"})
