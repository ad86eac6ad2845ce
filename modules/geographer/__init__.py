"""The belief about the map."""

from modules.geographer.connected_maps import ConnectedMaps, MapBelief
from modules.geographer.errors import (
    ContradictoryEvidenceError,
    EvidenceError,
    GridTooWideError,
)

__all__ = [
    "ConnectedMaps",
    "ContradictoryEvidenceError",
    "EvidenceError",
    "GridTooWideError",
    "MapBelief",
]
