"""Deadlines to the nanosecond: how late a slowed decision is, why, and what it cost.

A hop takes 0.1 ms. The compute profile is ``free``, so that nothing takes time but what
``[compute.slower]`` says.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from bus.messages import (
    DRIVE,
    PING,
    TURN,
    ActionEnded,
    Arrival,
    AskedPath,
    AskedSensing,
    DeadlineMissed,
    LedgerEntry,
    Motion,
    PathDecision,
    Reading,
    RunEnded,
)
from bus.wire import Sent
from scenarios.scenario import Scenario
from tests.scenarios.runs import (
    LITTLE,
    everything_said,
    log_in_process,
    log_of_processes,
    of_kind,
    scenario_of,
    script_of,
)

HOP_NS = 100_000
SECOND_NS = 1_000_000_000
FIRST_DRIVE_NS = math.ceil(6.0 / 0.085 * 1e9)
"""The robot begins 6 m before the port of the first LDP, and is due there after so long. It finds
the port by its echoes, a little before or beyond."""

PATIENCE_NS = 600 * SECOND_NS
"""How long a robot stands before its day is given up (`world.patience_s` as it is)."""

Run = tuple[Sent, ...]


def slowed(**changes: Any) -> Scenario:
    """The little building, nobody in it, and no computing time but what the test adds."""
    free = {"compute__profile": "free", "world__person": []}
    return scenario_of(LITTLE, **free, **changes)


def asked(said: Run, kind: type[AskedSensing] | type[AskedPath]) -> dict[int, Any]:
    return {question.decision: question for question in of_kind(said, kind)}


def late(said: Run, kind: str) -> list[LedgerEntry]:
    entries = of_kind(said, LedgerEntry)
    return [e for e in entries if e.kind == kind and e.cause]


def ending(said: Run) -> tuple[str, int]:
    """Why the run ended, and when."""
    ((reason, at_ns),) = (
        (s.message.reason, s.said_ns) for s in said if isinstance(s.message, RunEnded)
    )
    return reason, at_ns


def came_ns(said: Run, visit: int) -> int:
    """When the robot was at the LDP of a visit."""
    (at_ns,) = (
        s.said_ns for s in said if isinstance(s.message, Arrival) and s.message.visit == visit
    )
    return at_ns


def stood_ns(said: Run, entry: LedgerEntry) -> int:
    """How long the robot stood for a late first decision: it stands when it is there."""
    return max(0, entry.decided_ns - max(entry.until_ns, came_ns(said, entry.visit)))


def takes_ns(motion: Motion) -> int:
    """How long a sensing action takes, from its steps: 0.085 m/s, 15 degrees/s, 0.96 s a ping."""
    each = {
        DRIVE: lambda amount: math.ceil(abs(amount) / 0.085 * 1e9),
        TURN: lambda amount: math.ceil(abs(amount) / math.radians(15.0) * 1e9),
        PING: lambda amount: 960_000_000 * round(amount),
    }
    return sum(each[round(kind)](amount) for kind, amount in motion.steps.tolist())


def test_a_miss_is_said_at_exactly_the_deadline() -> None:
    said = everything_said(slowed(compute__slower={"sensing": 100.0, "path": 400.0}))
    missed = [(s.said_ns, s.message) for s in said if isinstance(s.message, DeadlineMissed)]
    assert {miss.kind for _, miss in missed} == {"sensing", "path"}
    assert [said_ns for said_ns, _ in missed] == [miss.until_ns for _, miss in missed]
    late_ones = sorted(e.decision for e in of_kind(said, LedgerEntry) if e.cause)
    assert sorted(miss.decision for _, miss in missed) == late_ones


def test_a_slow_sensing_decision_is_late_by_what_it_took_less_the_action() -> None:
    slow_ns = 100 * SECOND_NS
    said = everything_said(slowed(compute__slower={"sensing": 100.0}))
    questions = asked(said, AskedSensing)
    motions = {motion.action: motion for motion in of_kind(said, Motion)}
    entries = late(said, "sensing")
    checked = 0
    for entry in entries:
        question = questions[entry.decision]
        if question.action == 0:
            continue
        # The question is heard one hop after it was asked, the classifier is idle then, and its
        # answer is heard one hop after its end: 2 hops + 100 s. It was due when the action ends.
        action_ns = takes_ns(motions[question.action])
        assert entry.until_ns - entry.asked_ns == action_ns
        assert -entry.slack_ns == 2 * HOP_NS + slow_ns - action_ns
        assert entry.decided_ns == entry.until_ns - entry.slack_ns
        # the robot stands from the end of the action until it hears what to do next
        assert entry.idle_ns == -entry.slack_ns
        assert (entry.cause, entry.instead) == ("overrun", "stood and waited")
        checked += 1
    assert checked >= 3


def test_the_first_sensing_decision_waits_for_the_prior() -> None:
    # The departure is heard by the geographer after 1 hop and its prior by the classifier after
    # 2; the answer is heard after 3 hops + 100 s. It was due after 6 m at 0.085 m/s.
    said = everything_said(slowed(compute__slower={"sensing": 100.0}))
    first = late(said, "sensing")[0]
    assert first.visit == 0
    assert -first.slack_ns == 3 * HOP_NS + 100 * SECOND_NS - FIRST_DRIVE_NS
    assert first.idle_ns == stood_ns(said, first) > 0
    assert first.cause == "overrun"


@pytest.mark.parametrize("beyond_ns", [-1, 0, 1])
def test_what_is_heard_at_the_very_deadline_is_in_time(beyond_ns: int) -> None:
    slow_s = (FIRST_DRIVE_NS - 3 * HOP_NS + beyond_ns) / 1e9
    scenario = slowed(compute__slower={"sensing": slow_s}, world__until_s=300)
    said = everything_said(scenario)
    first = next(e for e in of_kind(said, LedgerEntry) if e.kind == "sensing")
    assert first.slack_ns == -beyond_ns
    assert first.cause == ("overrun" if beyond_ns > 0 else "")
    assert first.idle_ns == stood_ns(said, first)


@pytest.mark.parametrize("beyond_ns", [-1, 0, 1])
def test_a_robot_that_is_still_under_way_at_the_deadline_stands_for_nobody(beyond_ns: int) -> None:
    # it goes on beyond where the port was expected, so that it comes after the deadline
    came = came_ns(everything_said(slowed(world__until_s=100)), 0)
    assert came > FIRST_DRIVE_NS
    slow_s = (came - 3 * HOP_NS + beyond_ns) / 1e9
    said = everything_said(slowed(compute__slower={"sensing": slow_s}, world__until_s=300))
    first = late(said, "sensing")[0]
    assert first.decided_ns == came + beyond_ns
    assert (first.cause, first.idle_ns) == ("overrun", max(0, beyond_ns))


def test_a_slow_path_decision_is_late_by_what_it_took_less_the_drive() -> None:
    # Departure to the geographer: 1 hop. Belief to the decider: 1 hop. Path to the world: 1 hop.
    # The LDP before is classified by then, since the robot waited there for the path too.
    slow_ns = 400 * SECOND_NS
    said = everything_said(slowed(compute__slower={"path": 400.0}))
    stood = waits(said)
    entries = late(said, "path")
    assert len(entries) > 2
    for entry in entries:
        heard_ns = entry.asked_ns + 3 * HOP_NS + slow_ns
        assert entry.decided_ns == heard_ns
        assert entry.slack_ns == entry.until_ns - heard_ns < 0
        assert entry.cause == "overrun"
        # it stands from its arrival, or from the end of its last sensing action
        assert entry.idle_ns == max(0, heard_ns - max(entry.until_ns, stood[entry.visit]))
    assert any(entry.idle_ns for entry in entries)


def waits(said: Run) -> dict[int, int]:
    """Since when the robot stands at the LDP of a visit: its last movement there."""
    since: dict[int, int] = {}
    visit = 0
    for sent in said:
        if isinstance(sent.message, Arrival):
            visit = sent.message.visit
        if isinstance(sent.message, Arrival | ActionEnded):
            since[visit] = sent.said_ns
    return since


def test_a_slow_geographer_makes_the_decisions_that_wait_for_it_late() -> None:
    # Its belief is said 1 hop + 300 s after the departure and heard 1 hop later; what the
    # classifier and the decider make of it in no time is heard 1 hop after that.
    said = everything_said(slowed(compute__slower={"belief": 300.0}))
    for kind in ("path", "sensing"):
        first = next(e for e in late(said, kind) if e.visit == 0)
        assert first.cause == "late input"
        assert -first.slack_ns == 3 * HOP_NS + 300 * SECOND_NS - FIRST_DRIVE_NS
    sensing = next(e for e in late(said, "sensing") if e.visit == 0)
    assert sensing.idle_ns == stood_ns(said, sensing) > 0
    # both came at once: the robot stood for want of the first, and no time counts twice
    assert next(e for e in late(said, "path") if e.visit == 0).idle_ns == 0
    assert {e.cause for e in of_kind(said, LedgerEntry)} <= {"", "late input"}


def killed(at_s: float, **changes: Any) -> Scenario:
    return slowed(fault=[{"kill": "decider", "at_s": at_s}], **changes)


@pytest.mark.parametrize("at_s, visit", [(30.0, 1), (0.00005, 0)])
def test_a_dead_process_ends_the_run_at_the_next_deadline_that_it_misses(
    at_s: float, visit: int
) -> None:
    # before 30 s it has answered for visit 0 already, so that the next question is for visit 1
    said = everything_said(killed(at_s))
    question = next(q for q in of_kind(said, AskedPath) if q.visit == visit)
    assert ending(said) == ("process down: decider", question.until_ns)
    (entry,) = late(said, "path")
    assert (entry.decision, entry.cause) == (question.decision, "process down")
    assert (entry.decided_ns, entry.slack_ns, entry.idle_ns) == (-1, 0, 0)
    assert [m.decision for m in of_kind(said, DeadlineMissed)] == [question.decision]


@pytest.mark.parametrize("at_s", [10.0, 100.0, 120.0])
def test_a_robot_that_hears_no_echoes_says_nothing_of_what_it_sensed(at_s: float) -> None:
    # No deadline falls due: the robot has its next step for every reading, but gets no reading.
    said = everything_said(slowed(fault=[{"kill": "sensor", "at_s": at_s}]))
    last_ns = max(s.said_ns for s in said if isinstance(s.message, ActionEnded))
    assert ending(said) == ("process down: sensor", last_ns + PATIENCE_NS)
    assert not [r for r in said if isinstance(r.message, Reading) and r.said_ns >= last_ns]


def test_what_a_process_would_have_said_after_its_death_is_never_said() -> None:
    # it has the question and the belief after 0.2 ms, computes for 20 s, and dies after 10 s
    said = everything_said(killed(10.0, compute__slower={"path": 20.0}))
    assert not of_kind(said, PathDecision)
    assert ending(said) == ("process down: decider", FIRST_DRIVE_NS)


@pytest.mark.parametrize("what", ["slow", "killed"])
def test_the_log_of_late_decisions_is_the_same_over_the_bus(what: str, tmp_path: Path) -> None:
    slow = slowed(compute__slower={"sensing": 100.0, "belief": 300.0})
    script = script_of(slow if what == "slow" else killed(30.0))
    alone = log_in_process(script, tmp_path / "alone.mcap")
    launched, apart = log_of_processes(script, tmp_path / "apart.mcap")
    assert launched.failed == {}
    assert launched.reason == ("done" if what == "slow" else "process down: decider")
    assert apart == alone
