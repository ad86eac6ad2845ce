"""Times and frames as the foxglove schemas want them."""

from __future__ import annotations

from google.protobuf.timestamp_pb2 import Timestamp

BUILDING, ROBOT = "building", "robot"
"""Names of the two frames."""

_NS_PER_S = 10**9


def stamp(unix_ns: int) -> Timestamp:
    """A protobuf time from Unix nanoseconds."""
    seconds, nanos = divmod(unix_ns, _NS_PER_S)
    return Timestamp(seconds=seconds, nanos=nanos)
