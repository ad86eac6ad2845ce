"""Where the robot is, and what its sonar ring heard."""

from __future__ import annotations

import math

from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.LaserScan_pb2 import LaserScan
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3

from bus.messages import Sonar, TruePose
from logs.views.stamps import BUILDING, ROBOT, stamp


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


def echoes(sonar: Sonar, fired_unix_ns: int) -> LaserScan:
    """The echoes of one firing, counter-clockwise from straight ahead; NaN where none came back."""
    ranges_m = sonar.ranges_m.tolist()
    last = max(len(ranges_m) - 1, 0) / max(len(ranges_m), 1)
    return LaserScan(
        timestamp=stamp(fired_unix_ns),
        frame_id=ROBOT,
        pose=Pose(position=Vector3(), orientation=Quaternion(w=1.0)),
        start_angle=0.0,
        end_angle=2 * math.pi * last,
        ranges=ranges_m,
    )
