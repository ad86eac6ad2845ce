"""The part of Perfetto's trace format that a run needs, built at run time.

Names, numbers and types are those of https://perfetto.dev/docs/reference/trace-packet-proto (file
protos/perfetto/trace/perfetto_trace.proto), where the enumerations are declared as such; here
they are int32, which is the same on the wire.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorProto
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass

SLICE_BEGIN, SLICE_END, INSTANT = 1, 2, 3
"""``TrackEvent.type``."""

EXPLICIT = 3
"""``TrackDescriptor.child_ordering``: by ``sibling_order_rank``."""

_PACKAGE = "perfetto.protos"
_FIXED64 = FieldDescriptorProto.TYPE_FIXED64
_INT32, _INT64 = FieldDescriptorProto.TYPE_INT32, FieldDescriptorProto.TYPE_INT64
_MESSAGE, _STRING = FieldDescriptorProto.TYPE_MESSAGE, FieldDescriptorProto.TYPE_STRING
_UINT32, _UINT64 = FieldDescriptorProto.TYPE_UINT32, FieldDescriptorProto.TYPE_UINT64

# message: field: (number, type, is it repeated); what a message field holds is in _HOLDS
_MESSAGES: dict[str, dict[str, tuple[int, FieldDescriptorProto.Type.ValueType, bool]]] = {
    "Trace": {"packet": (1, _MESSAGE, True)},
    "TracePacket": {
        "timestamp": (8, _UINT64, False),
        "trusted_packet_sequence_id": (10, _UINT32, False),
        "track_event": (11, _MESSAGE, False),
        "track_descriptor": (60, _MESSAGE, False),
    },
    "TrackDescriptor": {
        "uuid": (1, _UINT64, False),
        "name": (2, _STRING, False),
        "parent_uuid": (5, _UINT64, False),
        "child_ordering": (11, _INT32, False),
        "sibling_order_rank": (12, _INT32, False),
    },
    "TrackEvent": {
        "debug_annotations": (4, _MESSAGE, True),
        "type": (9, _INT32, False),
        "track_uuid": (11, _UINT64, False),
        "categories": (22, _STRING, True),
        "name": (23, _STRING, False),
        "flow_ids": (47, _FIXED64, True),
        "terminating_flow_ids": (48, _FIXED64, True),
    },
    "DebugAnnotation": {
        "int_value": (4, _INT64, False),
        "string_value": (6, _STRING, False),
        "name": (10, _STRING, False),
    },
}
_HOLDS = {
    "packet": "TracePacket",
    "track_event": "TrackEvent",
    "track_descriptor": "TrackDescriptor",
    "debug_annotations": "DebugAnnotation",
}


@cache
def trace_type() -> Any:
    """The class of ``perfetto.protos.Trace``."""
    # proto2, as the original: repeated numbers are not packed
    file = FileDescriptorProto(name="perfetto_trace.proto", package=_PACKAGE, syntax="proto2")
    for name, fields in _MESSAGES.items():
        declared = file.message_type.add(name=name)
        for field, (number, kind, repeated) in fields.items():
            label = (
                FieldDescriptorProto.LABEL_REPEATED
                if repeated
                else FieldDescriptorProto.LABEL_OPTIONAL
            )
            holds = f".{_PACKAGE}.{_HOLDS[field]}" if kind == _MESSAGE else None
            declared.field.add(name=field, number=number, type=kind, label=label, type_name=holds)
    pool = DescriptorPool()
    pool.Add(file)
    return GetMessageClass(pool.FindMessageTypeByName(f"{_PACKAGE}.Trace"))
