"""Payloads wait for the grant that names them; a gap among them is an error."""

from __future__ import annotations

import pytest

from bus.inbox import GapError, Inbox, LostPayloadError
from bus.messages import ActionEnded
from bus.wire import Sent


def payload(sequence: int, previous: int, topic: str = "percept/action") -> Sent:
    return Sent(topic, "world", sequence, previous, 0, (), ActionEnded(sequence))


def test_payloads_are_taken_by_name_in_the_order_of_the_grant() -> None:
    inbox = Inbox()
    inbox.put(payload(4, -1))
    names = (("world", 9), ("world", 4))
    assert not inbox.has(names)
    assert inbox.missing(names) == [("world", 9)]
    inbox.put(payload(9, 4))
    assert inbox.has(names)
    assert [sent.sequence for sent in inbox.take(names)] == [9, 4]
    assert inbox.missing(names) == [*names]


def test_each_topic_of_a_source_is_counted_by_itself() -> None:
    inbox = Inbox()
    inbox.put(payload(0, -1))
    inbox.put(payload(1, -1, "percept/arrival"))
    inbox.put(payload(5, 0))
    inbox.put(payload(6, 1, "percept/arrival"))


@pytest.mark.parametrize("previous", [1, 0, -1])
def test_a_gap_names_both_numbers(previous: int) -> None:
    inbox = Inbox()
    inbox.put(payload(2, -1))
    with pytest.raises(GapError) as error:
        inbox.put(payload(7, previous))
    assert str(error.value) == (
        f"percept/action from world: message 7 follows {previous}, but the last one received was 2"
    )


def test_what_never_came_is_said_with_who_waited_for_it() -> None:
    assert str(LostPayloadError("sensor", 70, [("world", 3)], 20.0)) == (
        "sensor: granted [('world', 3)] at 70 ns, but they did not come within 20 s"
    )
