"""Made-up messages of every topic, valid by construction, for property tests."""

from __future__ import annotations

import struct
from typing import Any, get_type_hints

import msgspec
import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as stn

from bus.fields import Spec, array_specs
from bus.messages import Message
from bus.topics import TOPICS
from bus.wire import Sent

NUMBERS = st.integers(-(2**63), 2**63 - 1)
NAMES = st.text(max_size=8)
SCALARS: dict[Any, st.SearchStrategy[Any]] = {
    int: NUMBERS,
    float: st.floats(),
    str: st.text(max_size=20),
    bool: st.booleans(),
}
PARENTS = st.lists(st.tuples(NAMES, NUMBERS), max_size=3).map(tuple)


@st.composite
def arrays(draw: st.DrawFn, spec: Spec) -> Any:
    """An array that a spec allows."""
    least = 1 if spec.meaning in ("likelihood", "distribution") else 0
    shape = draw(
        st.lists(st.integers(least, 3), min_size=spec.dimensions, max_size=spec.dimensions)
    )
    if spec.length is not None:
        shape[-1] = spec.length
    if spec.rows is not None:
        shape[0] = spec.rows
    if spec.meaning in ("likelihood", "distribution"):
        value = draw(stn.arrays(spec.dtype, tuple(shape), elements=st.floats(0.0, 1.0)))
        value[..., 0] += 0.5
        return value / value.sum(axis=-1, keepdims=True) if spec.meaning[0] == "d" else value
    lowest = 0.0 if spec.meaning == "costs" else None
    finite = st.floats(lowest, allow_nan=False, allow_infinity=False)
    elements = finite if spec.meaning != "any" else None
    return draw(stn.arrays(spec.dtype, tuple(shape), elements=elements))


def messages(message_type: type[Message]) -> st.SearchStrategy[Message]:
    """Messages of a type."""
    specs, hints = array_specs(message_type), get_type_hints(message_type)
    values = [
        arrays(specs[name]) if name in specs else SCALARS[hints[name]]
        for name in message_type.__struct_fields__
    ]
    return st.tuples(*values).map(lambda found: message_type(*found))


@st.composite
def sent(draw: st.DrawFn, topic: str) -> Sent:
    """Messages on a topic, in an envelope of its publisher."""
    row = TOPICS[topic]
    message = draw(messages(row.type))
    sequence, previous, said_ns = draw(st.tuples(NUMBERS, NUMBERS, NUMBERS))
    return Sent(topic, row.publisher, sequence, previous, said_ns, draw(PARENTS), message)


def exact(value: Any) -> Any:
    """Something that is equal only where every bit is."""
    if isinstance(value, np.ndarray):
        return (value.dtype.str, value.shape, value.tobytes())
    return struct.pack("<d", value) if isinstance(value, float) else value


def bits(message: Message) -> list[Any]:
    """A message's fields, for comparison bit by bit."""
    return [exact(value) for value in msgspec.structs.astuple(message)]
