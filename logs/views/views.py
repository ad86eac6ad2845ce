"""Which views there are, and which a message gives."""

from __future__ import annotations

from typing import Any

import numpy as np
from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
from foxglove_schemas_protobuf.Log_pb2 import Log
from foxglove_schemas_protobuf.PointCloud_pb2 import PointCloud
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.message import Message as Record

from bus import messages as m
from bus.wire import Sent
from logs.views.chances import chances, points_m
from logs.views.floor import Floor
from logs.views.robot import echoes, robot_frame
from logs.views.scene import belief_scene, building_scene
from logs.views.words import log_line

PREFIX = "view/"

VIEWS: dict[str, type[Record]] = {
    "view/building": SceneUpdate,
    "view/robot": FrameTransform,
    "view/echoes": PointCloud,
    "view/belief": SceneUpdate,
    "view/chances": PointCloud,
    "view/log": Log,
}
"""The record type of each view's topic."""

ECHOES_EVERY_NS = 10**9
"""Of the ring's firings those are shown that are said at least so much apart."""

_ECHOES = "percept/sonar"

IN_WORDS = frozenset(
    {
        "decision/sensing",
        "decision/path",
        "decision/reaction",
        "decision/registration",
        "belief/registrations",
        "percept/errand",
        "deadline/missed",
        "ledger",
        "truth/errand",
        "truth/encounter",
        "health/refused",
        "run/ended",
    }
)
_SHOWN = IN_WORDS | {"truth/building", "truth/pose", "belief/map"}


class Views:
    """Makes the views of one run's messages, in the order in which they were said.

    The belief is drawn on the floor of the building that was heard of last; before that there
    is nothing to draw it on. ``epoch_ns`` is the Unix time of the run's time 0.
    """

    def __init__(self, epoch_ns: int) -> None:
        self._epoch_ns = epoch_ns
        self._floor: Floor | None = None
        self._places_m = np.empty((0, 0, 2))
        self._echoes_from_ns = 0

    def shows(self, topic: str, said_ns: int) -> bool:
        """Whether a message on a topic may give a view: if not, :meth:`of` gives none."""
        if topic == _ECHOES:
            return said_ns >= self._echoes_from_ns
        return topic in _SHOWN

    def of(self, sent: Sent) -> list[tuple[str, bytes]]:
        """(topic, protobuf bytes) of each view that a message gives."""
        if not self.shows(sent.topic, sent.said_ns):
            return []
        unix_ns = self._epoch_ns + sent.said_ns
        if sent.topic in IN_WORDS:
            return _packed("view/log", log_line(sent, unix_ns))
        match sent.message:
            case m.Sonar() as sonar:
                self._echoes_from_ns = sent.said_ns + ECHOES_EVERY_NS
                return _packed("view/echoes", echoes(sonar, self._epoch_ns + sonar.fired_ns))
            case m.TruePose() as pose:
                return _packed("view/robot", robot_frame(pose, unix_ns))
            case m.TrueBuilding() as building:
                self._floor = Floor.of(building)
                self._places_m = points_m(self._floor)
                return _packed("view/building", building_scene(building, unix_ns))
            case m.MapBelief() as belief if self._floor and self._floor.carries(belief):
                return [
                    *_packed("view/belief", belief_scene(belief, self._floor, unix_ns)),
                    *_packed("view/chances", chances(belief, self._places_m, unix_ns)),
                ]
        return []


def _packed(topic: str, record: Record | None) -> list[tuple[str, bytes]]:
    return [] if record is None else [(topic, record.SerializeToString(deterministic=True))]


def view_schema(topic: str) -> tuple[str, bytes]:
    """The full protobuf name of a view's record and its descriptors, those they need first."""
    descriptor = VIEWS[topic].DESCRIPTOR
    described = FileDescriptorSet()
    files: dict[str, Any] = {}
    _collect(descriptor.file, files)
    for file in files.values():
        file.CopyToProto(described.file.add())
    return descriptor.full_name, described.SerializeToString(deterministic=True)


def _collect(file: Any, found: dict[str, Any]) -> None:
    """Note a file's descriptor by its name, after those that it imports."""
    for needed in file.dependencies:
        if needed.name not in found:
            _collect(needed, found)
    found[file.name] = file
