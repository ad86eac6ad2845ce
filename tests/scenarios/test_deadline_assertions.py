"""Assertions about deadlines name the worst decision, and no other."""

from __future__ import annotations

from pathlib import Path

import pytest

from bus.messages import LedgerEntry
from scenarios.testing.deadlines import Deadlines, Settled

S = 10**9


def settled(seed: int, slack_s: float | None) -> Settled:
    decided_ns = -1 if slack_s is None else round((200 - slack_s) * S)
    slack_ns = -1 if slack_s is None else round(slack_s * S)
    entry = LedgerEntry(
        seed, "path", 1, 100 * S, 200 * S, decided_ns, slack_ns, 1, 1, 0, "", "overrun"
    )
    return Settled(seed, Path(f"{seed}.mcap"), entry, None)


def deadlines(*slacks_s: float | None) -> Deadlines:
    each = tuple(settled(seed, slack_s) for seed, slack_s in enumerate(slacks_s, start=1))
    return Deadlines("path", len(each), each)


@pytest.mark.parametrize(
    "slacks_s, worst",
    [((3.0, -1.0, -2.0, -0.5), 3), ((-1.0, None, -2.0), 2), ((-0.001, 0.0, 5.0), 1)],
)
def test_the_worst_is_the_one_with_the_least_slack(
    slacks_s: tuple[float | None, ...], worst: int
) -> None:
    with pytest.raises(AssertionError) as raised:
        deadlines(*slacks_s).all_met()
    text = str(raised.value)
    assert f"worst: path {worst} (visit 1) of seed {worst}:" in text
    assert f"waywiser analyse {worst}.mcap" in text


def test_at_its_deadline_a_decision_is_in_time() -> None:
    assert deadlines(0.0, 1.0).all_met()
    assert deadlines(5.0, 6.0).slack_at_least("5 s")
    with pytest.raises(AssertionError, match="1 of 2 path decisions in 2 runs had less slack"):
        deadlines(4.999999999, 6.0).slack_at_least(5)


def test_a_probability_is_met_as_far_as_it_is_shown() -> None:
    many = [1.0] * 299
    assert deadlines(*many).met_with(0.99)
    for too_few in (many[1:], [*many, -1.0]):
        with pytest.raises(AssertionError, match=r"expected 0\.99"):
            deadlines(*too_few).met_with(0.99)
    assert deadlines(*[1.0] * 473, -1.0).met_with(0.99)
