"""The paper's own belief about the map: a few hypotheses, and none of the above (section 3)."""

from modules.geographer.paper.belief import HypothesisBelief, direct_belief, direct_cells
from modules.geographer.paper.drawing import draw_hypotheses
from modules.geographer.paper.errors import (
    ContradictedHypothesesError,
    FeatureError,
    HypothesesError,
    NetworksMissingError,
)
from modules.geographer.paper.features import Feature, corridor_features, junction_features
from modules.geographer.paper.hypotheses import HypothesisSet
from modules.geographer.paper.network import PaperNetwork, declare
from modules.geographer.paper.regeneration import Revision, first_set, revise

__all__ = [
    "ContradictedHypothesesError",
    "Feature",
    "FeatureError",
    "HypothesesError",
    "HypothesisBelief",
    "HypothesisSet",
    "NetworksMissingError",
    "PaperNetwork",
    "Revision",
    "corridor_features",
    "declare",
    "direct_belief",
    "direct_cells",
    "draw_hypotheses",
    "first_set",
    "junction_features",
    "revise",
]
