"""The Canadian Traveller's Problem: ways that may be blocked, found out by arriving.

Papadimitriou and Yannakakis, *Shortest paths without a map* (1991). An intersection of the grid
whose corridors are learnt by arriving is the same problem with worlds that are connected maps, and
errands one after the other make it one of several goals, where the first ways teach the later.
"""

from modules.decider.traveller.errand_kernels import Errands
from modules.decider.traveller.instance import Instance, InstanceError, graph, read_instance
from modules.decider.traveller.lookahead import (
    Moves,
    PlanError,
    least_cells,
    look_ahead,
    look_ahead_over,
)
from modules.decider.traveller.way_kernels import BLOCKED, FREE, UNKNOWN
from modules.decider.traveller.worlds import independent_worlds

__all__ = [
    "BLOCKED",
    "FREE",
    "UNKNOWN",
    "Errands",
    "Instance",
    "InstanceError",
    "Moves",
    "PlanError",
    "graph",
    "independent_worlds",
    "least_cells",
    "look_ahead",
    "look_ahead_over",
    "read_instance",
]
