"""The building and the belief about it, as scenes."""

from __future__ import annotations

from collections.abc import Iterable

from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.CylinderPrimitive_pb2 import CylinderPrimitive
from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
from foxglove_schemas_protobuf.Point3_pb2 import Point3
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.SceneEntity_pb2 import SceneEntity
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from foxglove_schemas_protobuf.TextPrimitive_pb2 import TextPrimitive
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3

from bus.grid import type_name
from bus.messages import MapBelief, TrueBuilding
from logs.views.floor import Floor, Point
from logs.views.stamps import BUILDING, ROBOT, stamp

ROBOT_M, ROBOT_HEIGHT_M = 0.5, 0.6
"""Size of the cylinder that stands for the robot (assumption: the paper does not say)."""

WALL_M, TEXT_M = 0.1, 0.8
BELIEF_HEIGHT_M = 0.05
"""The belief lies just above the floor."""

BELIEF_SHARE = 0.5
"""Breadth of a corridor's line, as a share of the corridor."""

_WALLS = Color(r=0.3, g=0.3, b=0.35, a=1.0)
_BODY = Color(r=0.9, g=0.5, b=0.1, a=1.0)
_TEXT = Color(r=1.0, g=1.0, b=1.0, a=1.0)


def building_scene(building: TrueBuilding, unix_ns: int) -> SceneUpdate:
    """The walls of a building, and a body that goes with the robot's frame."""
    floor = Floor.of(building)
    walls = floor.walls_m(building.corridors.tolist())
    lines = LinePrimitive(
        type=LinePrimitive.LINE_LIST,
        pose=_pose(0.0, 0.0, 0.0),
        thickness=WALL_M,
        points=_points((end for wall in walls for end in wall), 0.0),
        color=_WALLS,
    )
    body = CylinderPrimitive(
        pose=_pose(0.0, 0.0, ROBOT_HEIGHT_M / 2),
        size=Vector3(x=ROBOT_M, y=ROBOT_M, z=ROBOT_HEIGHT_M),
        bottom_scale=1.0,
        top_scale=1.0,
        color=_BODY,
    )
    at = stamp(unix_ns)
    return SceneUpdate(
        entities=[
            SceneEntity(timestamp=at, frame_id=BUILDING, id="walls", lines=[lines]),
            SceneEntity(
                timestamp=at, frame_id=ROBOT, id="robot", frame_locked=True, cylinders=[body]
            ),
        ]
    )


def belief_scene(belief: MapBelief, floor: Floor, unix_ns: int) -> SceneUpdate:
    """A line a corridor from red (not there) to green, the most probable type at each junction."""
    grid = floor.grid
    ends = [floor.corridor_m(corridor) for corridor in range(grid.corridors)]
    colors = [_probability_color(p) for p in belief.corridors.tolist()]
    lines = LinePrimitive(
        type=LinePrimitive.LINE_LIST,
        pose=_pose(0.0, 0.0, 0.0),
        thickness=BELIEF_SHARE * floor.width_m,
        points=_points((end for both in ends for end in both), BELIEF_HEIGHT_M),
        colors=[color for color in colors for _ in range(2)],
    )
    entity = SceneEntity(
        timestamp=stamp(unix_ns),
        frame_id=BUILDING,
        id="belief",
        lines=[lines],
        texts=_texts(belief, floor),
    )
    return SceneUpdate(entities=[entity])


def _texts(belief: MapBelief, floor: Floor) -> list[TextPrimitive]:
    types = belief.junctions.reshape(floor.grid.intersections, -1)
    texts: list[TextPrimitive] = []
    for intersection, probabilities in enumerate(types):
        best = int(probabilities.argmax())
        text = f"{type_name(best)} {probabilities[best]:.0%}"
        x_m, y_m = floor.position_m(intersection)
        pose = _pose(x_m, y_m, TEXT_M)
        texts.append(
            TextPrimitive(pose=pose, billboard=True, font_size=TEXT_M, color=_TEXT, text=text)
        )
    return texts


def _probability_color(probability: float) -> Color:
    return Color(r=1.0 - probability, g=probability, b=0.1, a=0.3 + 0.6 * probability)


def _points(points: Iterable[Point], z_m: float) -> list[Point3]:
    return [Point3(x=x, y=y, z=z_m) for x, y in points]


def _pose(x_m: float, y_m: float, z_m: float) -> Pose:
    # viewers take a missing rotation as (0, 0, 0, 0), which turns nothing into something
    return Pose(position=Vector3(x=x_m, y=y_m, z=z_m), orientation=Quaternion(w=1.0))
