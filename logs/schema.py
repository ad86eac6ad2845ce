"""Protobuf schemas of every topic, built at run time from the message types.

Protobuf is the one encoding that Foxglove, Lichtblick, PlotJuggler and Rerun all decode. Each
message type becomes one self-contained ``FileDescriptorSet``: the envelope (fields 1 to 5:
``source``, ``sequence``, ``previous``, ``said_ns``, ``parents``), then the fields of the type.
int is int64, float double, str string, bool bool; arrays of float64 and int64 are repeated,
arrays of uint8 are bytes. An array of two or more dimensions is flattened row by row and has a
companion field ``<name>_shape``. A field that is called as one of the envelope's (``source`` of
a span, say) is recorded as ``about_<name>``: it tells what the message is about.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeAlias, get_type_hints

import numpy as np
from google.protobuf.descriptor_pb2 import DescriptorProto, FieldDescriptorProto, FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message import DecodeError
from google.protobuf.message_factory import GetMessageClass
from msgspec.structs import astuple

from bus.fields import Spec, array_specs
from bus.messages import Message
from bus.topics import TOPICS
from bus.wire import Sent

PACKAGE = "waywiser"
ENVELOPE = ("source", "sequence", "previous", "said_ns", "parents")

_INT64 = FieldDescriptorProto.TYPE_INT64
_DOUBLE = FieldDescriptorProto.TYPE_DOUBLE
_BYTES = FieldDescriptorProto.TYPE_BYTES
_STRING = FieldDescriptorProto.TYPE_STRING
_SCALARS = {int: _INT64, float: _DOUBLE, str: _STRING, bool: FieldDescriptorProto.TYPE_BOOL}
_ARRAYS = {"float64": _DOUBLE, "int64": _INT64}

Record: TypeAlias = Any
"""An instance of a protobuf class made at run time."""


class SchemaError(ValueError):
    """A message that does not fit the schema of its topic: which one, and why."""


@dataclass(frozen=True)
class _Field:
    """One field of a message type: its name there and in the record, and what it holds.

    ``dtype`` is empty for a scalar, ``kind`` then its Python type.
    """

    name: str
    recorded: str
    kind: type
    dtype: str = ""
    dimensions: int = 0


@dataclass(frozen=True)
class _Plan:
    """All that encoding and decoding one topic needs, looked up once."""

    type: type[Message]
    record: Callable[..., Record]
    parse: Callable[[bytes], Record]
    fields: tuple[_Field, ...]
    recorded: tuple[str, ...]
    arrays: tuple[_Field, ...]


def _fields(message_type: type[Message]) -> tuple[_Field, ...]:
    specs = array_specs(message_type)
    found: list[_Field] = []
    for name, kind in get_type_hints(message_type).items():
        if name not in message_type.__struct_fields__:
            continue
        recorded = f"about_{name}" if name in ENVELOPE else name
        spec = specs.get(name)
        array = (spec.dtype, spec.dimensions) if spec else ()
        found.append(_Field(name, recorded, kind, *array))
    return tuple(found)


def _declare(declared: DescriptorProto, fields: tuple[_Field, ...]) -> None:
    """Number the fields of a record from 1: the envelope, then those of the message type."""
    parent = declared.nested_type.add(name="Parent")
    _add(parent, "source", _STRING)
    _add(parent, "sequence", _INT64)
    _add(declared, "source", _STRING)
    for name in ("sequence", "previous", "said_ns"):
        _add(declared, name, _INT64)
    _add(declared, "parents", FieldDescriptorProto.TYPE_MESSAGE, repeated=True)
    declared.field[-1].type_name = f".{PACKAGE}.{declared.name}.Parent"
    for field in fields:
        if not field.dtype:
            _add(declared, field.recorded, _SCALARS[field.kind])
        elif field.dtype == "uint8":
            _add(declared, field.recorded, _BYTES)
        else:
            _add(declared, field.recorded, _ARRAYS[field.dtype], repeated=True)
        if field.dimensions > 1:
            _add(declared, f"{field.recorded}_shape", _INT64, repeated=True)


def _add(declared: DescriptorProto, name: str, kind: int, repeated: bool = False) -> None:
    label = FieldDescriptorProto.LABEL_REPEATED if repeated else FieldDescriptorProto.LABEL_OPTIONAL
    number = len(declared.field) + 1
    declared.field.add(name=name, number=number, type=kind, label=label)


def schema_name(topic: str) -> str:
    """The full protobuf name of a topic's message type, ``waywiser.Odometry`` say."""
    return f"{PACKAGE}.{TOPICS[topic].type.__name__}"


@cache
def schema(topic: str) -> FileDescriptorSet:
    """The descriptors of a topic's message type. Raises KeyError for an unknown topic."""
    message_type = TOPICS[topic].type
    name = message_type.__name__
    descriptors = FileDescriptorSet()
    file = descriptors.file.add(name=f"{PACKAGE}/{name}.proto", package=PACKAGE, syntax="proto3")
    _declare(file.message_type.add(name=name), _fields(message_type))
    return descriptors


@cache
def _plan(topic: str) -> _Plan:
    pool = DescriptorPool()
    for file in schema(topic).file:
        pool.Add(file)
    described = pool.FindMessageTypeByName(schema_name(topic))
    record: Any = GetMessageClass(described)
    message_type = TOPICS[topic].type
    fields = _fields(message_type)
    recorded = tuple(field.recorded for field in fields)
    arrays = tuple(field for field in fields if field.dtype)
    return _Plan(message_type, record, record.FromString, fields, recorded, arrays)


def field_numbers(topic: str) -> dict[str, int]:
    """The protobuf number of every field of a topic's record, by the name it is recorded by."""
    (declared,) = schema(topic).file[0].message_type
    return {field.name: field.number for field in declared.field}


@dataclass(frozen=True)
class PlannedField:
    """A field of a message type: its Python type, its array's spec, its numbers in the record."""

    kind: type
    spec: Spec | None
    number: int
    shape_number: int


def planned_fields(topic: str) -> tuple[PlannedField, ...]:
    """The fields of a topic's message type, in their order; ``shape_number`` is 0 for no shape."""
    numbers, specs = field_numbers(topic), array_specs(TOPICS[topic].type)
    return tuple(
        PlannedField(
            of.kind,
            specs.get(of.name),
            numbers[of.recorded],
            numbers.get(f"{of.recorded}_shape", 0),
        )
        for of in _fields(TOPICS[topic].type)
    )


def encode(sent: Sent) -> bytes:
    """The protobuf bytes of a message. Raises SchemaError if a field holds the wrong thing."""
    plan = _plan(sent.topic)
    message = sent.message
    if type(message) is not plan.type:
        raise SchemaError(
            f"{sent.topic}: found a {type(message).__name__}, expected a {plan.type.__name__}"
        )
    try:
        values = dict(zip(plan.recorded, astuple(message), strict=True))
        for field in plan.arrays:
            value = values[field.recorded]
            values[field.recorded] = _flat(value, field)
            if field.dimensions > 1:
                values[f"{field.recorded}_shape"] = value.shape
        record = plan.record(
            source=sent.source,
            sequence=sent.sequence,
            previous=sent.previous,
            said_ns=sent.said_ns,
            **values,
        )
        add_parent = record.parents.add
        for source, sequence in sent.parents:
            add_parent(source=source, sequence=sequence)
        data: bytes = record.SerializeToString()
    except (TypeError, ValueError, AttributeError) as error:
        which = f"{sent.topic}: message {sent.sequence} of {sent.source}"
        raise SchemaError(f"{which}: {error}") from error
    return data


def _flat(value: Any, field: _Field) -> Any:
    if value.dtype != field.dtype or value.ndim != field.dimensions:
        raise SchemaError(
            f"field {field.name!r}: found {value.dtype} with shape {value.shape}, "
            f"expected {field.dtype} with {field.dimensions} dimension(s)"
        )
    return value.tobytes() if field.dtype == "uint8" else value.ravel().tolist()


def decode(topic: str, data: bytes) -> Sent:
    """Read a message back, its arrays read-only. Raises SchemaError if the bytes are not one."""
    return sent_of(topic, parse(topic, data))


def parse(topic: str, data: bytes) -> Record:
    """The protobuf record of a message: its fields as they were recorded, none of them read yet.

    Raises SchemaError if the bytes are not one.
    """
    try:
        return _plan(topic).parse(data)
    except DecodeError as error:
        raise SchemaError(f"{topic}: not a {schema_name(topic)}: {error}") from error


def sent_of(topic: str, record: Record) -> Sent:
    """The message that a record holds. Raises SchemaError where a shape does not fit."""
    plan = _plan(topic)
    try:
        fields = [_read(record, field) for field in plan.fields]
    except ValueError as error:
        raise SchemaError(f"{topic}: not a {schema_name(topic)}: {error}") from error
    return Sent(
        topic,
        record.source,
        record.sequence,
        record.previous,
        record.said_ns,
        tuple((p.source, p.sequence) for p in record.parents),
        plan.type(*fields),
    )


def _read(record: Record, field: _Field) -> Any:
    value = getattr(record, field.recorded)
    if not field.dtype:
        return value
    if field.dtype == "uint8":
        array = np.frombuffer(value, dtype=np.uint8)
    else:
        array = np.array(value, dtype=field.dtype)
    if field.dimensions > 1:
        array = array.reshape(tuple(getattr(record, f"{field.recorded}_shape")))
    array.flags.writeable = False
    return array
