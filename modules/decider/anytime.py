"""Which path, refined until stopped: an anytime procedure (Dean and Boddy, AAAI 1988).

The answer to begin with costs nothing: for each junction type the first step of the shortest path
that is consistent with what is known. Then the decision is solved with one hypothesis for each
type, and each time with twice as many. All before the last together cost about as much as it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bus.costs import WhyStopped
from modules.decider.decision import decide
from modules.decider.effort import cells_bound
from modules.decider.situation import Decision, Situation

AGREEING = 3
"""It is settled when so many doublings in a row changed no direction (a rule of thumb: maps not
looked at yet may still do so)."""


@dataclass(frozen=True)
class Refined:
    """The decision as far as it went, and why it went no further.

    ``hypotheses_per_type`` is 0 for the answer to begin with; ``cells`` sums up all that were
    touched. ``nothing left`` means that every map was used.
    """

    decision: Decision
    hypotheses_per_type: int
    cells: int
    stopped: WhyStopped


def refine(situation: Situation, cells: int, agreeing: int = AGREEING) -> Refined:
    """The best decision that can be found with so many cells.

    It takes no step that might touch more than are left, so the result's ``cells`` are at most
    these. Raises ValueError for ``agreeing`` below 1.
    """
    if agreeing < 1:
        raise ValueError(f"agreeing is {agreeing}, expected at least 1")
    types, most = _sizes(situation)
    decision, size, used, agreed = _by_hope(situation), 0, 0, 0
    while size < most:
        wanted = max(1, 2 * size)
        if used + _bound(situation, wanted, types) > cells:
            return Refined(decision, size, used, "out of cells")
        found = decide(situation, wanted)
        agreed = agreed + 1 if size and _same(found, decision) else 0
        decision, size, used = found, wanted, used + found.cells
        if agreed == agreeing and size < most:
            return Refined(decision, size, used, "settled")
    return Refined(decision, size, used, "nothing left")


def _by_hope(situation: Situation) -> Decision:
    """The decision of a robot without any hypothesis."""
    return decide(
        replace(
            situation,
            maps=situation.maps[:0],
            weights=situation.weights[:0],
            log_probability=situation.log_probability[:0],
        )
    )


def _sizes(situation: Situation) -> tuple[int, int]:
    """How many junction types the maps have at v, and the most maps of one type."""
    at_v = situation.grid.junction_types(situation.maps)[:, situation.place]
    counts = np.unique(at_v, return_counts=True)[1]
    return len(counts), int(counts.max(initial=0))


def _bound(situation: Situation, size: int, types: int) -> int:
    legs = len(situation.waypoints)
    return cells_bound(situation.grid, size, len(situation.tasks), types, legs)


def _same(one: Decision, other: Decision) -> bool:
    return bool((one.direction == other.direction).all())
