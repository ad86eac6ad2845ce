"""Which path to take: known or unknown territory."""

from modules.decider.costs import cost
from modules.decider.decision import decide
from modules.decider.effort import LADDER, cells_bound, largest_that_fits
from modules.decider.situation import Decision, Situation, SituationError

__all__ = [
    "LADDER",
    "Decision",
    "Situation",
    "SituationError",
    "cells_bound",
    "cost",
    "decide",
    "largest_that_fits",
]
