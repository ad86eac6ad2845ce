"""What the page tells of decisions and of what led to them."""

from __future__ import annotations

import numpy as np
import pytest
from msgspec.structs import replace

from bus import messages as m
from logs.page.people import People
from logs.page.story import Story, outcome
from tests.logs.conftest import BUILDING, S, Speaker, entry

INF = float("inf")


def _path(explores: bool, known_s: float, unknown_s: float) -> m.PathDecision:
    """East for the true type of (0, 0), which is NE; nothing for the others."""
    direction = np.zeros(16, np.uint8)
    direction[1 | 2] = 2
    known, unknown, exploring = np.full(16, INF), np.full(16, INF), np.zeros(16, np.uint8)
    known[1 | 2], unknown[1 | 2], exploring[1 | 2] = known_s, unknown_s, explores
    return m.PathDecision(1, 1, direction, known, unknown, exploring, 5)


def _story(*said: m.Message) -> Story:
    speaker, story = Speaker(), Story()
    for message in said:
        speaker.say(10, message)
    for sent in speaker.said:
        story.hear(sent)
    return story


ARRIVED = (BUILDING, m.Arrival(1, 4, 9.0), m.TruePose(0.0, 1.0, 0.0, 0))


@pytest.mark.parametrize(
    ("decision", "words"),
    [
        (_path(True, 530, 412), "took the unknown way east at a NE junction: 412 s against 530 s"),
        (
            _path(True, INF, 412),
            "took the unknown way east at a NE junction: 412 s against no other",
        ),
        (
            _path(False, 9000, 9500),
            "took the known way east at a NE junction: 9,000 s against 9,500 s",
        ),
    ],
)
def test_a_path_is_told_by_the_branch_that_was_taken(decision: m.PathDecision, words: str) -> None:
    story = _story(decision, *ARRIVED, m.Departure(2, 2))
    told = story.tell(entry(1, "path", 0, 240, 50))
    assert (told.words, told.at_ns) == (words, 10 * S)


def _lost(looks: bool) -> m.RegistrationDecision:
    """At a NE junction: as if at 1,0 look at 1,1 first, or go at once."""
    nothing, at = np.full(16, INF), np.full(16, -1)
    now_s, look_s, acts_at, looks_at = nothing.copy(), nothing.copy(), at.copy(), at.copy()
    now_s[3], look_s[3], acts_at[3], looks_at[3] = 900, 700, 1, 3 if looks else -1
    return m.RegistrationDecision(
        1, 1, now_s, look_s, np.full(16, looks, np.uint8), acts_at, looks_at
    )


@pytest.mark.parametrize(
    ("looks", "words"),
    [
        (True, "went east at a NE junction to look at 1,1, if this is 1,0: 700 s against 900 s"),
        (False, "went east at a NE junction, as if this were 1,0: 900 s against 700 s"),
    ],
)
def test_a_path_of_a_lost_robot_is_told_with_what_it_took_the_place_for(
    looks: bool, words: str
) -> None:
    said = (_lost(looks), _path(looks, 900, 700), *ARRIVED, m.Departure(2, 2))
    assert _story(*said).tell(entry(1, "path", 0, 240, 50)).words == words


def test_after_a_hand_over_it_stands_where_it_stood() -> None:
    decision = _path(True, 530, 412)
    asked_again = replace(decision, visit=2)
    story = _story(*ARRIVED, m.AtErrand(2, 0, here=True), asked_again, m.Departure(3, 2))
    told = story.tell(entry(1, "path", 0, 240, 50)).words
    assert told == "took the unknown way east at a NE junction: 412 s against 530 s"


def test_a_path_that_was_not_taken_is_not_told_as_if_it_were() -> None:
    for departures in ((), (m.Departure(2, 8),)):
        told = _story(_path(True, 1, 2), *ARRIVED, *departures).tell(entry(1, "path", 0, 240, 50))
        assert told.words == "a way for every junction type; none was taken"


def test_a_way_that_ends_at_a_wall_is_told_so() -> None:
    story = _story(_path(True, 1, 2), *ARRIVED, m.Blocked(2, 8), m.Departure(3, 2))
    assert story.tell(entry(1, "path", 0, 240, 50)).words == "tried the way west and found a wall"


def test_a_sensing_decision_is_told_by_the_outcome_that_came() -> None:
    worth_s = np.array([1250.4, 0.0])
    said = m.SensingDecision(5, 1, 3, np.array([8, -1]), np.array([0, 7]), worth_s, 2)
    first = m.Reading(1, 3, 0, 2, 0.1, 0, 8)
    second = m.Reading(1, 4, 2, 6, 0.1, 0, 8)
    motion = m.Motion(1, 3, 4, 8, np.zeros((0, 2)))
    sensing = entry(5, "sensing", 0, 30, 20)
    assert _story(said, first).tell(sensing).words == "tested detector 8, worth 1,250 s"
    assert _story(said, first, motion, second).tell(sensing).words == (
        "tested feature 2 in wedge 6, worth 1,250 s"
    )
    sure = m.Reading(1, 3, 0, 2, 0.9, 1, 8)
    assert _story(said, sure).tell(sensing).words == "enough is known: a NES junction"
    assert _story(said).tell(sensing).words == "what to test next, for every outcome; none came"


def test_a_reaction_is_the_last_that_was_said_by_then() -> None:
    acts = [
        m.ReactionDecision(act, np.zeros(2), 0.9, 0, 0.65) for act in ("go on", "stop", "retreat")
    ]
    speaker, story = Speaker(), Story()
    for at_s, act in zip((1, 12, 14), acts, strict=True):
        story.hear(speaker.say(at_s, act))
    told = story.tell(entry(3, "reaction", 10, 15, 13))
    assert told.words == "stop: somebody approaches with probability 0.90"
    assert story.tell(entry(3, "reaction", 5, 15, 6)).words == "never decided"  # 1 s was before


def test_outcomes() -> None:
    assert outcome(entry(1, "path", 0, 240, 50)) == "190.0 s to spare"
    assert outcome(entry(1, "path", 0, 40, 50, cause="overrun")) == "late by 10.0 s: overrun; stand"
    assert outcome(entry(1, "path", 0, 40, None)) == "never came: unknown"


def test_a_person_is_the_echo_ahead_that_comes_nearer() -> None:
    speaker, people = Speaker(), People()
    people.hear(speaker.say(1, m.AskedReaction(1, 1, 0, 9 * S)))
    for at_s, ahead_m, beside_m in (
        (2, 8.0, 9.0),
        (3, 6.0, 5.0),
        (4, 10.0, np.nan),
        (5, np.nan, 4.0),
    ):
        ranges_m = np.array([ahead_m, beside_m, 1.0, np.nan])
        people.hear(speaker.say(at_s, m.Sonar(1, 0, at_s * S, ranges_m)))
    people.hear(speaker.say(6, m.TrueEncounter(1, True, 0.1, 3.0)))
    people.hear(speaker.say(7, m.Sonar(1, 0, 7 * S, np.ones(4))))
    (meeting,) = people.meetings
    assert meeting.seen == [(2 * S, 8.0, 0), (3 * S, 5.0, 1), (5 * S, 4.0, 1)]
    assert (meeting.over_ns, meeting.collided) == (6 * S, True)
