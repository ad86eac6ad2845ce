"""Grants, dones, commits and refusals as bytes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import msgpack
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus import protocol
from bus.coordinator import Done, Grant, Handled, Said
from bus.topics import TOPICS
from bus.wire import RefusedError, pack
from tests.bus.made_up import NAMES, NUMBERS, sent

ids = st.tuples(NAMES, NUMBERS)
handled = st.builds(Handled, NAMES, NAMES, NUMBERS, NUMBERS, NUMBERS, NUMBERS, NUMBERS)

READ: dict[str, Callable[[bytes], Any]] = {
    "grant": lambda data: protocol.unpack_grant("sensor", data),
    "done": protocol.unpack_done,
    "commit": protocol.unpack_commit,
    "refused": protocol.unpack_refusal,
}


@given(NUMBERS, st.lists(ids, max_size=4).map(tuple))
def test_grants(time_ns: int, messages: tuple[tuple[str, int], ...]) -> None:
    grant = Grant("sensor", time_ns, messages)
    assert protocol.unpack_grant("sensor", protocol.pack_grant(grant)) == grant


@given(
    NAMES,
    NUMBERS,
    st.lists(handled, max_size=3).map(tuple),
    st.lists(st.tuples(NAMES, NUMBERS, NUMBERS), max_size=3),
)
def test_dones(
    process: str, time_ns: int, work: tuple[Handled, ...], said: list[tuple[str, int, int]]
) -> None:
    all_said = tuple(Said(topic, process, number, at_ns) for topic, number, at_ns in said)
    done = Done(process, time_ns, work, all_said)
    assert protocol.unpack_done(protocol.pack_done(done)) == done


@given(st.lists(ids | st.sampled_from(sorted(TOPICS)).flatmap(sent), max_size=4), st.booleans())
def test_commits(entries: list[protocol.CommitEntry], last: bool) -> None:
    back, back_last = protocol.unpack_commit(protocol.pack_commit(entries, last=last))
    assert back_last == last
    for one, other in zip(back, entries, strict=True):
        assert one == (other if isinstance(other, tuple) else (other.topic, pack(other)))


@given(NAMES, NAMES, NUMBERS, NAMES)
def test_refusals(topic: str, source: str, sequence: int, reason: str) -> None:
    error = RefusedError(topic, source, sequence, reason)
    back = protocol.unpack_refusal(protocol.pack_refusal(error))
    assert str(back) == str(error)
    assert (back.topic, back.source, back.sequence, back.reason) == (
        topic,
        source,
        sequence,
        reason,
    )


@pytest.mark.parametrize("kind", READ)
@given(data=st.binary(max_size=60))
def test_random_bytes_are_refused_by_the_name_of_what_they_should_be(
    kind: str, data: bytes
) -> None:
    with pytest.raises(RefusedError) as error:
        READ[kind](data)
    assert (error.value.topic, error.value.source, error.value.sequence) == (kind, "", -1)


@pytest.mark.parametrize(
    ("kind", "value"),
    [
        ("grant", (5, (("world", 1.0),))),
        ("grant", ("5", ())),
        ("done", ("sensor", 5, (), (("topic", 1),))),
        ("done", ("sensor", 5, (("topic", "world", 0, 0, 0, 0),), ())),
        ("commit", ((("world", None),), True)),
        ("commit", ((), 1)),
        ("refused", ("topic", "source", "3", "reason")),
    ],
)
def test_other_types_are_refused(kind: str, value: object) -> None:
    with pytest.raises(RefusedError, match="ValidationError"):
        READ[kind](msgpack.packb(value))
