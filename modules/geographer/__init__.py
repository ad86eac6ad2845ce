"""The belief about the map."""

from modules.geographer.connected_maps import ConnectedMaps
from modules.geographer.errors import (
    ContradictoryEvidenceError,
    EvidenceError,
    GridTooWideError,
    ProblemTooLargeError,
)
from modules.geographer.map_belief import Estimate, MapBelief
from modules.geographer.pairs import PairLikelihood

__all__ = [
    "ConnectedMaps",
    "ContradictoryEvidenceError",
    "Estimate",
    "EvidenceError",
    "GridTooWideError",
    "MapBelief",
    "PairLikelihood",
    "ProblemTooLargeError",
]
