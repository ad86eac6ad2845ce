"""The influence diagram of an encounter declared in pyAgrum, and solved by it.

The running robot uses the compiled tables (:mod:`modules.reactor.tables`); this says in a
library's words what they are compiled from. Needs the extra ``networks``.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from modules.reactor.cone import Floats
from modules.reactor.diagram import (
    HEARD,
    INTENT,
    WHAT,
    Settings,
    change_table,
    intent_table,
    severity_table,
    time_table,
    what_table,
)
from modules.reactor.meeting import ACTS, LEFT, RIGHT
from modules.reactor.tables import ROOMS_M, collision_table


@dataclass(frozen=True)
class Solved:
    """What pyAgrum says: the best act and its expected utility."""

    act: str
    expected_utility: float


def declare(heard: Floats, side: int, room: tuple[int, int], doing: str, settings: Settings) -> Any:
    """The diagram of one encounter as a ``pyagrum.InfluenceDiagram``.

    ``heard`` (heard, ttc, column) is the belief about what is heard, of which only what is not
    impossible becomes a state of the node *seen*; ``side`` where the robot is, an index of
    SIDES_M; ``room`` the classes of room on the left and right, indices of ROOMS_M; ``doing``
    what it does now. Raises ImportError without pyAgrum.
    """
    import pyagrum  # heavy, and an extra

    gum: Any = pyagrum
    diagram = gum.InfluenceDiagram()
    seen = np.argwhere(heard > 0.0)
    _add_nodes(gum, diagram, len(seen))
    diagram.cpt("seen")[:] = heard[tuple(seen.T)]
    diagram.cpt("what")[:] = what_table(settings)[seen[:, 0]]
    diagram.cpt("intent")[:] = intent_table(settings)
    for side_of, known in (("room left", room[0]), ("room right", room[1])):
        diagram.cpt(side_of)[:] = np.eye(len(ROOMS_M))[known]
    _fill_aside(diagram)
    _fill_collision(diagram, seen, collision_table(settings)[side])
    _fill_utilities(diagram, doing, settings)
    return diagram


def solve(diagram: Any) -> Solved:
    """The act of highest expected utility, by Shafer and Shenoy's message passing."""
    import pyagrum

    gum: Any = pyagrum
    solver = gum.ShaferShenoyLIMIDInference(diagram)
    solver.makeInference()
    best = solver.optimalDecision("act").argmax()[0][0]["act"]
    return Solved(ACTS[best], float(solver.MEU()["mean"]))


def _add_nodes(gum: Any, diagram: Any, seen: int) -> None:
    rooms = [f"{room_m:g} m" for room_m in ROOMS_M]
    diagram.addChanceNode(gum.RangeVariable("seen", f"one of {HEARD}, when, line", 0, seen - 1))
    for name, states in (
        ("what", WHAT),
        ("intent", INTENT),
        ("room left", rooms),
        ("room right", rooms),
        ("aside", rooms),
        ("collision", ("no", "yes")),
    ):
        diagram.addChanceNode(gum.LabelizedVariable(name, "", list(states)))
    diagram.addDecisionNode(gum.LabelizedVariable("act", "", list(ACTS)))
    for name in ("harm", "time", "change"):
        diagram.addUtilityNode(gum.RangeVariable(name, "", 0, 0))
    for head, tails in (
        ("what", ("seen",)),
        ("intent", ("what",)),
        ("aside", ("act", "room left", "room right")),
        ("collision", ("seen", "what", "intent", "act", "aside")),
        ("harm", ("act", "what", "collision")),
        ("time", ("act", "what", "intent")),
        ("change", ("act",)),
    ):
        for tail in tails:
            diagram.addArc(tail, head)


def _fill_aside(diagram: Any) -> None:
    """How far aside an act goes: the room on its side; any for one that goes nowhere."""
    rooms = range(len(ROOMS_M))
    for (a, act), left, right in product(enumerate(ACTS), rooms, rooms):
        room = left if a in LEFT else right if a in RIGHT else 0
        given = {"act": act, "room left": left, "room right": right}
        diagram.cpt("aside")[given] = np.eye(len(ROOMS_M))[room]


def _fill_collision(diagram: Any, seen: Any, collision: Floats) -> None:
    """``collision`` (rooms, acts, what, intent, ttc, column) of the robot's side."""
    for k, (_, ttc, column) in enumerate(seen):
        for w, i, a, r in product(
            range(len(WHAT)), range(len(INTENT)), range(len(ACTS)), range(len(ROOMS_M))
        ):
            p = float(collision[r, a, w, i, ttc, column])
            given = {"seen": k, "what": w, "intent": i, "act": a, "aside": r}
            diagram.cpt("collision")[given] = [1.0 - p, p]


def _fill_utilities(diagram: Any, doing: str, settings: Settings) -> None:
    severity, time = severity_table(settings), time_table(settings)
    change = change_table(settings)[ACTS.index(doing)]
    for a, act in enumerate(ACTS):
        diagram.utility("change")[{"act": act}] = -change[a]
        for w, what in enumerate(WHAT):
            harm = [0.0, -settings.collision * severity[a, w]]
            for hit in range(2):
                diagram.utility("harm")[{"act": act, "what": what, "collision": hit}] = harm[hit]
            for i, intent in enumerate(INTENT):
                given = {"act": act, "what": what, "intent": intent}
                diagram.utility("time")[given] = -time[a, w, i]
