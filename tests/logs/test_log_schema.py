"""Every topic's protobuf schema: exact both ways, and clear about what does not fit."""

from __future__ import annotations

import struct
from typing import Any, get_type_hints

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as stn

from bus import messages as m
from bus.fields import Spec, array_specs
from bus.topics import TOPICS
from bus.wire import Sent
from logs.schema import SchemaError, decode, encode, schema

INT64 = st.integers(-(2**63), 2**63 - 1)
SCALARS: dict[type, st.SearchStrategy[Any]] = {
    int: INT64,
    float: st.floats(),
    str: st.text(max_size=8),
    bool: st.booleans(),
}


def _array(spec: Spec) -> st.SearchStrategy[Any]:
    shapes = stn.array_shapes(
        min_dims=spec.dimensions, max_dims=spec.dimensions, min_side=0, max_side=3
    )
    return stn.arrays(spec.dtype, shapes)


def _message(message_type: type[m.Message]) -> st.SearchStrategy[m.Message]:
    specs, hints = array_specs(message_type), get_type_hints(message_type)
    fields = [
        _array(specs[name]) if name in specs else SCALARS[hints[name]]
        for name in message_type.__struct_fields__
    ]
    return st.tuples(*fields).map(lambda values: message_type(*values))


def _exact(value: Any) -> Any:
    """Something that is equal only where every bit is."""
    if isinstance(value, np.ndarray):
        return (value.dtype, value.shape, value.tobytes())
    return struct.pack("<d", value) if isinstance(value, float) else value


@pytest.mark.parametrize("topic", TOPICS)
@given(data=st.data())
@settings(max_examples=20, deadline=None)
def test_every_message_comes_back_bit_for_bit(topic: str, data: st.DataObject) -> None:
    message = data.draw(_message(TOPICS[topic].type))
    parents = data.draw(st.lists(st.tuples(st.text(max_size=4), INT64), max_size=3))
    numbers = data.draw(st.tuples(INT64, INT64, INT64))
    sent = Sent(topic, data.draw(st.text(max_size=4)), *numbers, tuple(parents), message)
    back = decode(topic, encode(sent))
    envelope = (back.topic, back.source, back.sequence, back.previous, back.said_ns, back.parents)
    assert envelope == (topic, sent.source, *numbers, sent.parents)
    assert type(back.message) is TOPICS[topic].type
    found = [_exact(value) for value in msgspec.structs.astuple(back.message)]
    assert found == [_exact(value) for value in msgspec.structs.astuple(message)]


def test_a_read_array_cannot_be_changed() -> None:
    sent = Sent("percept/sonar", "world", 0, -1, 0, (), m.Sonar(1, 2, 0, np.array([1.0])))
    back = decode(sent.topic, encode(sent)).message
    assert isinstance(back, m.Sonar)
    with pytest.raises(ValueError, match="read-only"):
        back.ranges_m[0] = 2.0


def _declared(topic: str) -> list[tuple[int, str, int, bool]]:
    """(number, name, type, repeated) of every field; types: 1 double, 3 int64, 9 string, ..."""
    (declared,) = schema(topic).file[0].message_type
    return [(f.number, f.name, f.type, f.label == 3) for f in declared.field]


def test_the_envelope_comes_first_in_every_schema() -> None:
    envelope = [
        (1, "source", 9, False),
        (2, "sequence", 3, False),
        (3, "previous", 3, False),
        (4, "said_ns", 3, False),
        (5, "parents", 11, True),
    ]
    for topic in TOPICS:
        assert _declared(topic)[:5] == envelope


def test_fields_follow_in_the_order_of_the_message_type() -> None:
    assert _declared("truth/building")[5:] == [
        (6, "columns_m", 1, True),
        (7, "rows_m", 1, True),
        (8, "corridor_width_m", 1, False),
        (9, "corridors", 12, False),  # uint8 array: bytes
        (10, "start", 3, False),
    ]


def test_an_array_of_more_dimensions_is_followed_by_its_shape() -> None:
    fields = {name: (number, kind) for number, name, kind, _ in _declared("belief/map")}
    for name, kind in (("junctions", 1), ("maps", 12)):
        number = fields[name][0]
        assert fields[name][1] == kind
        assert fields[f"{name}_shape"] == (number + 1, 3)
    assert "corridors_shape" not in fields


def test_a_field_called_as_one_of_the_envelope_is_what_the_message_is_about() -> None:
    names = [name for _, name, _, _ in _declared("clock/span")[5:]]
    assert names[:4] == ["process", "topic", "about_source", "about_sequence"]


def test_each_schema_is_self_contained_and_no_two_share_a_name() -> None:
    files = [schema(topic).file for topic in TOPICS]
    assert all(len(file) == 1 and not file[0].dependency for file in files)
    names = [file[0].name for file in files]
    assert len(set(names)) == len(names)


def test_numbers_of_numpy_are_recorded_as_numbers() -> None:
    pose: Any = m.TruePose(np.float64(1.5), np.float32(0.25), 3, np.int64(7))  # type: ignore[arg-type]
    back = decode("truth/pose", encode(Sent("truth/pose", "world", 0, -1, 0, (), pose))).message
    assert back == m.TruePose(1.5, 0.25, 3.0, 7)


BAD: dict[str, tuple[Any, str]] = {
    "another type": (m.RunEnded("done"), "found a RunEnded, expected a Sonar"),
    "dtype": (m.Sonar(0, 0, 0, np.array([1])), "'ranges_m': found int64"),
    "dimensions": (m.Sonar(0, 0, 0, np.zeros((2, 2))), r"shape \(2, 2\)"),
    "no array": (m.Sonar(0, 0, 0, [1.0]), "message 5 of world"),  # type: ignore[arg-type]
    "too large": (m.Sonar(2**63, 0, 0, np.zeros(1)), "out of range"),
    "no number": (m.Sonar("1", 0, 0, np.zeros(1)), "message 5 of world"),  # type: ignore[arg-type]
}


@pytest.mark.parametrize("case", BAD)
def test_what_does_not_fit_is_refused_by_name(case: str) -> None:
    message, words = BAD[case]
    with pytest.raises(SchemaError, match=words) as error:
        encode(Sent("percept/sonar", "world", 5, -1, 0, (), message))
    assert "percept/sonar" in str(error.value)


def test_text_that_is_not_unicode_is_refused() -> None:
    with pytest.raises(SchemaError, match="run/ended"):
        encode(Sent("run/ended", "world", 0, -1, 0, (), m.RunEnded("\ud800")))


def test_bytes_that_are_no_message_are_refused() -> None:
    with pytest.raises(SchemaError, match=r"percept/sonar: not a waywiser\.Sonar"):
        decode("percept/sonar", b"\xff\xff\xff")


def test_a_shape_that_does_not_fit_its_numbers_is_refused() -> None:
    pose = m.PoseBelief(np.zeros(3), np.zeros((2, 2)))
    data = encode(Sent("belief/pose", "sensor", 0, -1, 0, (), pose))
    # field 8 (covariance_shape), packed: tag 0x42, length 2, then 2 and 2; make the last a 3
    assert data.endswith(b"\x42\x02\x02\x02")
    with pytest.raises(SchemaError, match="reshape"):
        decode("belief/pose", data[:-1] + b"\x03")
