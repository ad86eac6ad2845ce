"""What the robot believes of each corridor, as coloured points on the floor.

The scene of ``view/belief`` says more, but not every viewer draws scenes: Rerun knows no
``foxglove.SceneUpdate`` and no ``foxglove.Grid``. A cloud whose points have colours is drawn in
place by Foxglove, Lichtblick and Rerun alike, and has the probability as a number, too.
"""

from __future__ import annotations

import numpy as np
from foxglove_schemas_protobuf.PackedElementField_pb2 import PackedElementField
from foxglove_schemas_protobuf.PointCloud_pb2 import PointCloud
from foxglove_schemas_protobuf.Pose_pb2 import Pose
from foxglove_schemas_protobuf.Quaternion_pb2 import Quaternion
from foxglove_schemas_protobuf.Vector3_pb2 import Vector3
from numpy.typing import NDArray

from bus.messages import MapBelief
from logs.views.floor import Floor
from logs.views.stamps import BUILDING, stamp

ALONG, ACROSS = 16, 2
"""So many points has each corridor, however long it is: a log must not grow with the floor."""

_SHARE = 0.5
"""The points take so much of the breadth of a corridor."""

_NUMBERS, _COLOURS = ("x", "y", "z", "probability"), ("red", "green", "blue", "alpha")
_POINT = np.dtype([(name, "<f4") for name in _NUMBERS] + [(name, "u1") for name in _COLOURS])

_CLOUD = PointCloud(
    frame_id=BUILDING,
    pose=Pose(position=Vector3(), orientation=Quaternion(w=1.0)),
    point_stride=_POINT.itemsize,
    fields=[
        *(
            PackedElementField(name=name, offset=4 * place, type=PackedElementField.FLOAT32)
            for place, name in enumerate(_NUMBERS)
        ),
        *(
            PackedElementField(
                name=name, offset=4 * len(_NUMBERS) + place, type=PackedElementField.UINT8
            )
            for place, name in enumerate(_COLOURS)
        ),
    ],
)
"""What all of these clouds have."""


def points_m(floor: Floor) -> NDArray[np.float64]:
    """Where the points of each corridor lie: (corridors, ALONG * ACROSS, 2), in metres."""
    ends = np.array([floor.corridor_m(corridor) for corridor in range(floor.grid.corridors)])
    first, last = ends[:, 0], ends[:, 1]
    far = (np.arange(ALONG) + 0.5) / ALONG
    along = first[:, None] + far[:, None] * (last - first)[:, None]
    upright = np.isclose(first[:, 0], last[:, 0])
    sideways = np.where(upright[:, None], (1.0, 0.0), (0.0, 1.0))
    aside_m = _SHARE * floor.width_m * ((np.arange(ACROSS) + 0.5) / ACROSS - 0.5)
    spread = along[:, :, None] + aside_m[:, None] * sideways[:, None, None]
    places_m: NDArray[np.float64] = spread.reshape(len(ends), ALONG * ACROSS, 2)
    return places_m


def chances(belief: MapBelief, places_m: NDArray[np.float64], unix_ns: int) -> PointCloud:
    """The cloud of a belief on its floor: from red (not there) to green, the surer the denser."""
    corridors, points, _ = places_m.shape
    cloud = np.zeros((corridors, points), _POINT)
    cloud["x"], cloud["y"] = places_m[..., 0], places_m[..., 1]
    chance = belief.corridors[:, None]
    cloud["probability"] = chance
    for name, share in (
        ("red", 1.0 - chance),
        ("green", chance),
        ("blue", 0.1),
        ("alpha", 0.3 + 0.6 * chance),
    ):
        cloud[name] = np.rint(255.0 * np.asarray(share))
    found = PointCloud(timestamp=stamp(unix_ns), data=cloud.tobytes())
    found.MergeFrom(_CLOUD)
    return found
