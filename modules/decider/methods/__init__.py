"""Ways to a place that no known path leads to, and the choice between them (paper, section 4)."""

from modules.decider.methods.contingent import decide_by_method
from modules.decider.methods.estimate import (
    Estimate,
    Estimates,
    EstimatesError,
    choose_method,
    shipped_estimates,
)
from modules.decider.methods.features import FEATURES, Outlook, features
from modules.decider.methods.in_use import Choice, MethodInUse, best_method
from modules.decider.methods.journey import Journey, MethodError, drive
from modules.decider.methods.ways import METHODS, Method, Way, best_way, corridor_weights

__all__ = [
    "FEATURES",
    "METHODS",
    "Choice",
    "Estimate",
    "Estimates",
    "EstimatesError",
    "Journey",
    "Method",
    "MethodError",
    "MethodInUse",
    "Outlook",
    "Way",
    "best_method",
    "best_way",
    "choose_method",
    "corridor_weights",
    "decide_by_method",
    "drive",
    "features",
    "shipped_estimates",
]
