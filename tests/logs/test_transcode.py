"""The short way into the log and the long one end in the same bytes, and refuse the same."""

from __future__ import annotations

from pathlib import Path

import msgpack
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bus import messages as m
from bus.topics import TOPICS
from bus.wire import RefusedError, Sent, pack, unpack
from logs.reader import read_run
from logs.schema import encode
from logs.transcode import Taker
from tests.bus.made_up import bits, sent

TAKER = Taker()


def _the_long_way(topic: str, data: bytes) -> tuple[bytes, int] | str:
    try:
        said = unpack(topic, data)
    except RefusedError as error:
        return str(error)
    return encode(said), said.said_ns


def _the_short_way(topic: str, data: bytes) -> tuple[bytes, int] | str:
    try:
        entry = TAKER.take(topic, data)
    except RefusedError as error:
        return str(error)
    assert entry.id == unpack(topic, data).id
    return entry.record, entry.said_ns


@pytest.mark.parametrize("topic", TOPICS)
@given(data=st.data())
@settings(max_examples=15)
def test_both_ways_end_in_the_same_bytes(topic: str, data: st.DataObject) -> None:
    packed = pack(data.draw(sent(topic)))
    assert _the_short_way(topic, packed) == _the_long_way(topic, packed)


@given(st.data(), st.sampled_from(sorted(TOPICS)))
@settings(max_examples=150)
def test_spoilt_bytes_are_refused_alike(data: st.DataObject, topic: str) -> None:
    packed = bytearray(pack(data.draw(sent(topic))))
    for _ in range(data.draw(st.integers(1, 3))):
        packed[data.draw(st.integers(0, len(packed) - 1))] = data.draw(st.integers(0, 255))
    whole = data.draw(st.booleans())
    spoilt = bytes(packed if whole else packed[: data.draw(st.integers(0, len(packed)))])
    try:
        long = _the_long_way(topic, spoilt)
    except ValueError:  # a number that no record holds: the short way says so as a refusal
        with pytest.raises(RefusedError):
            TAKER.take(topic, spoilt)
        return
    assert _the_short_way(topic, spoilt) == long


@given(st.binary(max_size=60))
@example(b"")
@example(b"\x96")
def test_garbage_is_refused_alike(garbage: bytes) -> None:
    assert _the_short_way("percept/sonar", garbage) == _the_long_way("percept/sonar", garbage)


def test_nearly_all_of_a_real_run_is_taken_the_short_way(late_run: Path) -> None:
    said = list(read_run(late_run))
    entries = [TAKER.take(sent.topic, pack(sent)) for sent in said]
    assert [entry.record for entry in entries] == [encode(sent) for sent in said]
    assert [(e.id, e.said_ns) for e in entries] == [(sent.id, sent.said_ns) for sent in said]
    # what keeps its bytes was not unpacked
    assert sum(isinstance(e.said, bytes) for e in entries) > 0.98 * len(said)
    assert [bits(e.sent.message) for e in entries] == [bits(sent.message) for sent in said]


@pytest.mark.parametrize("number", [2**63, 2**64 - 1])
def test_a_number_that_no_record_holds_is_refused(number: int) -> None:
    fields = (number, 2)
    packed = msgpack.packb(("world", 4, -1, 0, (), fields))
    assert unpack("percept/departure", packed).message == m.Departure(*fields)
    with pytest.raises(RefusedError, match="percept/departure: message 4 of world") as refused:
        TAKER.take("percept/departure", packed)
    assert (refused.value.topic, refused.value.sequence) == ("percept/departure", 4)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_numbers_that_are_not_finite_are_refused_where_they_must_be(value: float) -> None:
    decision = m.ReactionDecision("stop", np.array([-1.0, value]), 0.9, 0, 0.65)
    said = Sent("decision/reaction", "reactor", 0, -1, 0, (), decision)
    with pytest.raises(RefusedError, match=r"expected_utility.*not finite"):
        TAKER.take("decision/reaction", pack(said))
