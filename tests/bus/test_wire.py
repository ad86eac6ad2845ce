"""Bytes on the wire: every message comes back bit for bit, and nothing else gets in."""

from __future__ import annotations

from typing import Any

import msgpack
import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus import messages as m
from bus.topics import TOPICS
from bus.wire import ARRAY_EXT, RefusedError, Sent, pack, unpack
from tests.bus.made_up import bits, sent

topics = st.sampled_from(sorted(TOPICS))


@pytest.mark.parametrize("topic", TOPICS)
@given(data=st.data())
@settings(max_examples=15, deadline=None)
def test_every_message_comes_back_bit_for_bit(topic: str, data: st.DataObject) -> None:
    said = data.draw(sent(topic))
    back = unpack(topic, pack(said))
    assert bits(back.message) == bits(said.message)
    assert type(back.message) is TOPICS[topic].type
    assert (back.topic, back.id, back.previous) == (topic, said.id, said.previous)
    assert (back.said_ns, back.parents) == (said.said_ns, said.parents)


@given(st.data(), topics)
@settings(max_examples=100, deadline=None)
def test_arrays_arrive_read_only_in_order_and_aligned(data: st.DataObject, topic: str) -> None:
    back = unpack(topic, pack(data.draw(sent(topic))))
    for value in msgspec.structs.astuple(back.message):
        if isinstance(value, np.ndarray):
            assert not value.flags.writeable
            assert value.flags.c_contiguous
            assert value.flags.aligned
            with pytest.raises(ValueError, match="cannot set WRITEABLE"):
                value.setflags(write=True)  # nobody can take it back


def test_an_array_is_one_run_of_bytes_and_never_a_list() -> None:
    ranges_m = np.arange(24) / 7
    packed = pack(Sent("percept/sonar", "world", 0, -1, 0, (), m.Sonar(1, 2, 3, ranges_m)))
    assert packed.count(ranges_m.tobytes()) == 1
    found: list[Any] = []
    msgpack.unpackb(packed, ext_hook=lambda code, data: found.append((code, len(data))))
    assert found == [(ARRAY_EXT, 8 + ranges_m.nbytes)]
    # The array that arrives is a view of the bytes that came.
    back = unpack("percept/sonar", packed).message
    assert isinstance(back, m.Sonar)
    assert isinstance(back.ranges_m.base, np.ndarray | bytes)


def test_a_strided_array_is_sent_in_its_order() -> None:
    steps = np.asfortranarray(np.arange(6.0).reshape(3, 2))
    said = Sent("command/motion", "detectors", 0, -1, 0, (), m.Motion(1, 0, 1, 2, steps))
    back = unpack("command/motion", pack(said)).message
    assert isinstance(back, m.Motion)
    assert back.steps.tolist() == steps.tolist()


# What may not be let in.


def prior(value: np.ndarray, source: str = "geographer") -> Sent:
    return Sent("prior/junction", source, 5, -1, 0, (), m.JunctionPrior(1, 0, 0, 1, value))


def refused(topic: str, data: bytes) -> RefusedError:
    with pytest.raises(RefusedError) as error:
        unpack(topic, data)
    return error.value


def spoiled(value: float) -> np.ndarray:
    even = np.full(16, 1 / 16)
    even[3] = value
    return even


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        (spoiled(0.5), "field 'prior': sums to 1.4375, expected 1"),
        (spoiled(1 / 16 + 1e-8), "field 'prior': sums to 1.00000001, expected 1"),
        (spoiled(-0.25), "field 'prior': holds -0.25, expected nothing below zero"),
        (spoiled(np.nan), "field 'prior': holds a number that is not finite"),
        (spoiled(np.inf), "field 'prior': holds a number that is not finite"),
        (spoiled(1e308 * 1.5), "field 'prior': sums to 1.5e+308, expected 1"),
        (np.full(15, 1 / 15), "field 'prior': found shape (15,), expected 16 along the last axis"),
        (np.zeros(0), "field 'prior': found shape (0,), expected 16 along the last axis"),
        (
            np.full((1, 16), 1 / 16),
            "field 'prior': found float64 with shape (1, 16), expected float64 with 1 dimension(s)",
        ),
        (
            np.arange(16),
            "field 'prior': found int64 with shape (16,), expected float64 with 1 dimension(s)",
        ),
    ],
)
def test_what_is_no_distribution_is_refused(value: np.ndarray, reason: str) -> None:
    error = refused("prior/junction", pack(prior(value)))
    assert (error.topic, error.source, error.sequence) == ("prior/junction", "geographer", 5)
    assert error.reason == f"FieldError: {reason}"
    assert str(error) == f"prior/junction: message 5 of geographer: FieldError: {reason}"


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        (spoiled(-1e-300), "holds -1e-300, expected nothing below zero"),
        (spoiled(np.nan), "holds a number that is not finite"),
        (np.zeros(16), "is zero everywhere, expected a positive likelihood"),
    ],
)
def test_what_is_no_likelihood_is_refused(value: np.ndarray, reason: str) -> None:
    message = m.JunctionLikelihood(1, value, 2, True)
    error = refused(
        "likelihood/junction",
        pack(Sent("likelihood/junction", "classifier", 8, 7, 0, (), message)),
    )
    assert error.reason == f"FieldError: field 'likelihood': {reason}"


def test_a_list_is_no_array() -> None:
    data = msgpack.packb(("world", 0, -1, 0, (), (1, 2, 3, [0.5])))
    error = refused("percept/sonar", data)
    assert (error.source, error.sequence) == ("world", 0)
    assert "expected ndarray" in error.reason


def test_another_source_is_refused() -> None:
    error = refused("prior/junction", pack(prior(np.full(16, 1 / 16), source="intruder")))
    assert (error.source, error.sequence) == ("intruder", 5)
    assert error.reason == "FieldError: found source 'intruder', expected 'geographer'"


def test_an_unknown_topic_is_refused() -> None:
    error = refused("prior/weather", pack(prior(np.full(16, 1 / 16))))
    assert (error.topic, error.source, error.sequence) == ("prior/weather", "geographer", 5)
    assert error.reason == "FieldError: unknown topic"


@pytest.mark.parametrize(
    "envelope",
    [
        (7, 0, -1, 0, (), (1,)),
        ("world", 0.0, -1, 0, (), (1,)),
        ("world", True, -1, 0, (), (1,)),
        ("world", 2**63, -1, 0, (), (1,)),
        ("world", 0, -1, 2**64 - 1, (), (1,)),
        ("world", 0, -1, 0, ("world", 1), (1,)),
        ("world", 0, -1, 0, (("world",),), (1,)),
        ("world" * 1000, 0, -1, 0, (), (1,)),
        ("world", 0, -1, 0, ()),
        ("world", 0, -1, 0, (), (1,), 2),
        "world!",
        None,
    ],
)
def test_an_envelope_that_is_none_is_refused(envelope: object) -> None:
    error = refused("percept/action", msgpack.packb(envelope))
    assert len(str(error)) < 500
    assert error.sequence in (-1, 0)


@pytest.mark.parametrize(
    "fields", [(), (1, 2), ("1",), (1.5,), (None,), 1, {"action": 1}], ids=repr
)
def test_fields_of_another_type_are_refused(fields: object) -> None:
    error = refused("percept/action", msgpack.packb(("world", 4, 3, 0, (), fields)))
    assert (error.source, error.sequence) == ("world", 4)


@given(topics, st.binary(max_size=200))
@settings(max_examples=300, deadline=None)
def test_random_bytes_are_refused(topic: str, data: bytes) -> None:
    error = refused(topic, data)
    assert error.topic == topic
    assert error.reason


@given(st.data(), topics)
@settings(max_examples=100, deadline=None)
def test_a_message_cut_short_or_with_a_tail_is_refused(data: st.DataObject, topic: str) -> None:
    whole = pack(data.draw(sent(topic)))
    refused(topic, whole[: data.draw(st.integers(0, len(whole) - 1))])
    refused(topic, whole + b"\0")


@given(st.data(), topics)
@settings(max_examples=150, deadline=None)
def test_a_flipped_bit_is_refused_or_leaves_a_valid_message(
    data: st.DataObject, topic: str
) -> None:
    whole = bytearray(pack(data.draw(sent(topic))))
    bit = data.draw(st.integers(0, 8 * len(whole) - 1))
    whole[bit // 8] ^= 1 << bit % 8
    try:
        back = unpack(topic, bytes(whole))
    except RefusedError as error:
        assert error.topic == topic
        return
    assert back.source == TOPICS[topic].publisher
    assert bits(unpack(topic, pack(back)).message) == bits(back.message)


@pytest.mark.parametrize(
    "ext",
    [
        msgpack.ExtType(ARRAY_EXT, b""),
        msgpack.ExtType(ARRAY_EXT, b"\0\1\1\0"),
        msgpack.ExtType(ARRAY_EXT, b"\7\1\1\0\0\0\0\0" + bytes(8)),
        msgpack.ExtType(ARRAY_EXT, b"\0\1\2\0\0\0\0\0" + bytes(8)),
        msgpack.ExtType(ARRAY_EXT, b"\0\1\xff\xff\xff\xff\0\0" + bytes(8)),
        msgpack.ExtType(ARRAY_EXT, b"\0\xff" + bytes(1200)),
        msgpack.ExtType(ARRAY_EXT + 1, b"\0\1\1\0\0\0\0\0" + bytes(8)),
        msgpack.Timestamp(0),
    ],
    ids=range(8),
)
def test_an_array_that_is_none_is_refused(ext: object) -> None:
    error = refused("percept/sonar", msgpack.packb(("world", 4, 3, 0, (), (1, 2, 3, ext))))
    assert error.topic == "percept/sonar"


def test_what_cannot_be_sent_is_said() -> None:
    with pytest.raises(TypeError, match="cannot send a object"):
        pack(Sent("run/ended", "world", 0, -1, 0, (), m.RunEnded(object())))  # type: ignore[arg-type]
