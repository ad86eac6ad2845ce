"""The reactor's messages: what it says, when, and what work it reports."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bus.costs import CostModel
from bus.facts import Facts
from bus.messages import Attention, Departure, Ranges, ReactionDecision
from bus.turns import Turn
from modules.reactor.cone import USUAL
from modules.reactor.meeting import ACTS
from modules.reactor.process import Reactor, build
from modules.reactor.settings import Settings
from tests.reactor.things import NAN, echoes_of_disc, tracker_with, walker

FACTS = Facts(2, 1, 0, 2, 0.085)
SILENCE = [NAN] * len(USUAL.numbers)


def hear(reactor: Reactor, time_s: float, echoes: list[float]) -> Turn:
    """One ping of which only the forward transducers heard anything."""
    mean = np.full(24, NAN)
    mean[USUAL.numbers] = echoes
    sigma = 0.01 * np.nan_to_num(mean) + 0.01
    turn = Turn(0, CostModel("free"), ("sensor", 0))
    said = Ranges(0, round(time_s * 1e9), mean, sigma, np.ones(24), 0.085)
    reactor.handlers["belief/ranges"](said, turn)
    return turn


def walk_by(reactor: Reactor, left_m: float, begins_s: float = 10.0, quiet: int = 24) -> list[Turn]:
    """Somebody comes from 8 m ahead at 1.2 m/s and passes; then nothing is heard for so long."""
    ahead = [8.0 - 0.25 * 1.285 * k for k in range(26)]
    heard = [echoes_of_disc(d, left_m) if d > 0.5 else SILENCE for d in ahead]
    heard += [SILENCE] * quiet
    return [hear(reactor, begins_s + 0.25 * k, echoes) for k, echoes in enumerate(heard)]


def decisions(turns: list[Turn]) -> list[ReactionDecision]:
    """What was said about acts."""
    return [m for turn in turns for m, _ in turn.said if isinstance(m, ReactionDecision)]


def test_who_will_pass_well_clear_is_answered_once_with_continue() -> None:
    reactor = build(FACTS, Settings(), 1)
    # From echoes alone it would not know early enough on which line he walks.
    clear = walker(8.0, 1.2, 0.65, 1.0, pings=3)
    reactor._tracker = replace(tracker_with(clear), time_s=9.9)
    said = decisions(walk_by(reactor, 0.65))
    assert [one.act for one in said] == ["continue"]
    assert said[0].approaching > 0.95
    assert len(said[0].expected_utility) == len(ACTS)
    assert said[0].expected_utility.argmax() == ACTS.index("continue")
    assert 10.0 <= said[0].fired_ns / 1e9 < 11.0


def test_who_comes_head_on_is_answered_by_an_act_and_continue_at_the_end() -> None:
    turns = walk_by(build(FACTS, Settings(), 1), 0.3)
    assert [one.act for one in decisions(turns)] == ["pull aside right", "continue"]


def test_a_second_person_is_answered_though_the_act_is_the_same() -> None:
    reactor = build(FACTS, Settings(), 1)
    first = walk_by(reactor, 0.3, quiet=0)
    assert [one.act for one in decisions(first)] == ["pull aside right"]
    again = walk_by(reactor, 0.3, begins_s=16.5)
    assert [one.act for one in decisions(again)] == ["pull aside right", "continue"]


def test_thinking_is_reported_as_work_whatever_comes_of_it() -> None:
    turns = walk_by(build(FACTS, Settings(), 1), 0.3)
    thought = [turn for turn in turns if dict(turn.works).get("reaction", 0) > 0]
    assert len(thought) > 10 * len(decisions(turns))
    assert all("reaction" in dict(turn.works) for turn in turns if decisions([turn]))
    quiet = hear(build(FACTS, Settings(), 1), 1.0, SILENCE)
    assert [kind for kind, _ in quiet.works] == ["track"]


def test_attention_is_asked_for_once_and_given_back() -> None:
    turns = walk_by(build(FACTS, Settings(attention_s=0.3), 1), 0.3)
    asked = [m.period_s for turn in turns for m, _ in turn.said if isinstance(m, Attention)]
    assert asked == [0.3, 0.0]


def test_a_departure_is_only_noted_and_forgets_who_was_met() -> None:
    reactor = build(FACTS, Settings(), 1)
    walk_by(reactor, 0.3)
    turn = Turn(0, CostModel("free"), ("world", 0))
    reactor.handlers["percept/departure"](Departure(2, 2), turn)
    assert turn.works == [("note", 1)]
    assert decisions([turn]) == []
