"""The chain store of section 2 as a whole run: looked for, acted on, found out; never told."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from bus.grid import EAST, SOUTH, WEST, Grid
from bus.messages import (
    AtErrand,
    LedgerEntry,
    MapBelief,
    PathDecision,
    RegistrationDecision,
    Registrations,
    RunEnded,
    TrueErrand,
    TruePose,
)
from bus.wire import Sent
from scenarios.replaying import replay
from tests.scenarios.launches import waywiser
from tests.scenarios.runs import everything_said, log_in_process, log_of_processes, of_kind, shipped

NAME = "familiar-place"
GRID = Grid(7, 4)
A, B, ELSEWHERE = (GRID.intersection(*place) for place in ((4, 1), (2, 1), (3, 1)))
CORNER, BY_B, END = (GRID.intersection(*place) for place in ((4, 0), (2, 0), (3, 3)))
ALIKE = EAST | SOUTH | WEST

QUIET = "world.ping_period_s=30"
AT_A = "world.start.junction=[4, 1]"
AT_LEISURE = "errand.0.late_price=0"
HURRIED = "errand.0.due_s=1000"


@cache
def run(*changes: str) -> tuple[Sent, ...]:
    return everything_said(shipped(NAME, QUIET, *changes).scenario)


def first(said: tuple[Sent, ...]) -> RegistrationDecision:
    return of_kind(said, RegistrationDecision)[0]


def places(said: tuple[Sent, ...]) -> list[int]:
    return [pose.place for pose in of_kind(said, TruePose)]


def done_s(said: tuple[Sent, ...]) -> float:
    (done,) = of_kind(said, TrueErrand)
    return done.ended_ns / 1e9


def test_it_looks_for_the_corner_and_is_in_time() -> None:
    said = run()
    why = first(said)
    assert why.detour[ALIKE]
    assert (why.acts_at[ALIKE], why.looks_at[ALIKE]) == (A, CORNER)
    assert why.look_s[ALIKE] < why.now_s[ALIKE]
    # south of B is no corner as south of A: it turns round, and goes east and north
    assert places(said)[:3] == [B, BY_B, B]
    assert places(said)[-1] == END
    due_s = shipped(NAME).scenario.errand[0].due_s
    assert due_s is not None and done_s(said) < due_s


def test_at_leisure_a_mistake_can_be_put_right_and_it_goes_at_once() -> None:
    said = run(AT_LEISURE)
    why = first(said)
    assert not why.detour[ALIKE]
    assert why.acts_at[ALIKE] == A
    assert why.now_s[ALIKE] <= why.look_s[ALIKE] < np.inf
    # taken for A, B leads to the wrong end, where nobody waits; from there to the right one
    wrong = GRID.intersection(1, 3)
    assert BY_B not in places(said)
    assert places(said).index(wrong) < places(said).index(END)
    left = [len(r.places) for r in of_kind(said, Registrations)]
    assert left[0] == 3 and left == sorted(left, reverse=True)
    assert done_s(said) > done_s(run())


def test_in_a_hurry_the_right_answer_would_come_too_late_after_a_look() -> None:
    why = first(run(HURRIED))
    assert not why.detour[ALIKE]
    assert why.now_s[ALIKE] <= why.look_s[ALIKE]
    # where it truly is at A that is as fast as can be
    quick = run(HURRIED, AT_A)
    assert places(quick) == [A, ELSEWHERE, GRID.intersection(3, 2), END]


def test_nobody_tells_the_robot_where_it_is() -> None:
    at_b, at_a = run(), run(AT_A)
    # what it says before anything is sensed is the same to the bit, wherever it truly is
    for kind in (Registrations, MapBelief, RegistrationDecision, PathDecision):
        one, other = of_kind(at_b, kind)[0], of_kind(at_a, kind)[0]
        assert repr(one) == repr(other)
    prior = of_kind(at_b, Registrations)[0]
    assert dict(zip(prior.places.tolist(), prior.weights.tolist(), strict=True)) == pytest.approx(
        {A: 0.6, B: 0.2, ELSEWHERE: 0.2}, abs=0.02
    )
    # whether its place was that of the landmark or another: it comes to know, and it is right
    for said, truth in ((at_b, BY_B), (at_a, CORNER)):
        looked = of_kind(said, Registrations)[2]
        best = int(looked.places[looked.weights.argmax()])
        assert looked.weights.max() > 0.9
        assert best == places(said)[2], f"it came back from {truth}"


def test_the_errand_s_end_settles_it() -> None:
    said = run(AT_LEISURE)
    seen = of_kind(said, AtErrand)
    assert [one.here for one in seen] == [False] * (len(seen) - 1) + [True]
    assert of_kind(said, RunEnded) == [RunEnded("done")]
    last = of_kind(said, MapBelief)[-1]
    assert GRID.intersection(last.x, last.y) == END


def test_every_decision_has_its_reason_and_its_time() -> None:
    said = run()
    paths = {decision.decision: decision for decision in of_kind(said, PathDecision)}
    assert len(of_kind(said, RegistrationDecision)) > 3
    for why in of_kind(said, RegistrationDecision):
        path = paths[why.decision]
        assert why.now_s.tobytes() == path.known_s.tobytes()
        assert why.look_s.tobytes() == path.unknown_s.tobytes()
        assert why.detour.tolist() == path.explores.tolist()
    assert all(entry.slack_ns > 0 for entry in of_kind(said, LedgerEntry))


def test_at_the_prices_of_1990_three_beliefs_take_longer_than_the_first_drive() -> None:
    said = run("compute.profile=huey-1990")
    assert first(said).detour[ALIKE]
    late = [e for e in of_kind(said, LedgerEntry) if e.kind == "path" and e.slack_ns < 0]
    # visible, not fatal; the decider itself has what it needs of the time that is left
    assert [entry.cause for entry in late] == ["late input"] * len(late)
    assert {entry.visit for entry in late} >= {0}
    assert of_kind(said, RunEnded) == [RunEnded("done")]


def test_the_log_of_processes_is_that_of_one_and_each_module_repeats(tmp_path: Path) -> None:
    script = shipped(NAME, QUIET)
    alone, apart = tmp_path / "alone.mcap", tmp_path / "apart.mcap"
    launched, data = log_of_processes(script, apart)
    assert (launched.reason, launched.failed) == ("done", {})
    assert data == log_in_process(script, alone)
    for module in ("geographer", "decider", "classifier"):
        replayed = replay(apart, module)
        assert (replayed.first, replayed.incomplete) == (None, ())
    said = waywiser("analyse", str(apart), "--json")
    assert said.status == 0
    (log,) = said.json["logs"]
    assert sum(row["late"] for row in log["decisions"]) == 0


def test_it_is_launched_by_its_name_and_held_to_its_expectations(tmp_path: Path) -> None:
    log = str(tmp_path / "run.mcap")
    said = waywiser("launch", NAME, "--set", QUIET, "--in-process", "--log", log, "--json")
    assert (said.status, said.json["reason"]) == (0, "done")
