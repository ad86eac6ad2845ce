"""Where the robot is, and what its sonar ring heard."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.PackedElementField_pb2 import PackedElementField
from foxglove_schemas_protobuf.PointCloud_pb2 import PointCloud
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
from numpy.typing import NDArray

from bus.messages import Sonar, TruePose
from logs.views.stamps import BUILDING, ROBOT, stamp

_COORDINATES = [
    PackedElementField(name=name, offset=4 * place, type=PackedElementField.FLOAT32)
    for place, name in enumerate("xyz")
]

_CLOUD = PointCloud(
    frame_id=ROBOT,
    pose=Pose(position=Vector3(), orientation=Quaternion(w=1.0)),
    point_stride=4 * len(_COORDINATES),
    fields=_COORDINATES,
)
"""What all clouds of echoes have."""


def robot_frame(pose: TruePose, unix_ns: int) -> FrameTransform:
    """Where the robot's frame is in the building's."""
    half_rad = pose.heading_rad / 2
    return FrameTransform(
        timestamp=stamp(unix_ns),
        parent_frame_id=BUILDING,
        child_frame_id=ROBOT,
        translation=Vector3(x=pose.x_m, y=pose.y_m),
        rotation=Quaternion(z=math.sin(half_rad), w=math.cos(half_rad)),
    )


@cache
def _axes(transducers: int) -> NDArray[np.float64]:
    """Unit vectors (transducers, 3) in the robot's frame, the first straight ahead."""
    bearings_rad = np.arange(transducers) * (2 * math.pi / max(transducers, 1))
    return np.column_stack([np.cos(bearings_rad), np.sin(bearings_rad), np.zeros(transducers)])


def echoes(sonar: Sonar, fired_unix_ns: int) -> PointCloud:
    """Where the echoes of one firing came from: a point each, none where none came back."""
    ranges_m = sonar.ranges_m
    heard = np.isfinite(ranges_m)
    points = _axes(len(ranges_m))[heard] * ranges_m[heard, None]
    cloud = PointCloud(timestamp=stamp(fired_unix_ns), data=points.astype("<f4").tobytes())
    cloud.MergeFrom(_CLOUD)
    return cloud
