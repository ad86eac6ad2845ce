"""What to do about an encounter, act by act: with fewer acts weighed, or until stopped.

What an act costs besides a collision is a short sum; whether it ends in one is a long sum over
all that is believed. So the acts are weighed in the order of what they are worth at best, without
a collision, and as soon as the best so far beats what all others are worth at best, it is
the best of all (branch and bound; Land and Doig, Econometrica 28, 1960). Going on with what is
being done is the answer to begin with and weighed first, so that no later answer is worse.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bus.costs import WhyStopped
from modules.reactor.cone import Floats
from modules.reactor.diagram import STANDS
from modules.reactor.meeting import ACTS
from modules.reactor.react import Encounter
from modules.reactor.room import rooms_of
from modules.reactor.sides import UNSEEN, Sides
from modules.reactor.tables import Diagram


@dataclass(frozen=True, slots=True)
class Refined:
    """The best act of those weighed, and why no more were.

    ``expected_utility`` is in the order of ACTS, in seconds of time, and nan where an act was not
    weighed; ``weighed`` says how many were.
    """

    act: str
    expected_utility: Floats
    weighed: int
    cells: int
    stopped: WhyStopped


def cells_before(met: Sequence[Encounter], acts: int = len(ACTS)) -> int:
    """The cells of weighing so many acts, known before it starts.

    One for each act and way a thing is heard, to find the order; then one for each act weighed
    and entry of the beliefs that is not zero.
    """
    return _cells_of_order(met) + acts * _cells_of_act(met)


def acts_within(met: Sequence[Encounter], cells: int) -> int:
    """How many acts can be weighed with so many cells, 0 if none (a fixed-time procedure)."""
    fitting = [n for n in range(1, len(ACTS) + 1) if cells_before(met, n) <= cells]
    return max(fitting, default=0)


def refine(
    met: Sequence[Encounter], doing: str, diagram: Diagram, cells: int, sides: Sides = UNSEEN
) -> Refined:
    """The best act that can be found with so many cells; ``met`` holds at least one thing.

    It takes no step that would touch more than are left. ``settled`` and ``nothing left`` both
    mean that no act is better (equal ones beyond rounding go to the first of ACTS).
    """
    utility = np.full(len(ACTS), np.nan)
    used = _cells_of_order(met)
    if used > cells:
        return Refined(doing, utility, 0, 0, "out of cells")
    at_best = _without_collision(met, doing, diagram)
    weighed = 0
    stopped: WhyStopped = "nothing left"
    for act in _order(at_best, ACTS.index(doing)):
        if weighed and at_best[act] < np.nanmax(utility):
            stopped = "settled"
            break
        if used + _cells_of_act(met) > cells:
            stopped = "out of cells"
            break
        used += _cells_of_act(met)
        weighed += 1
        utility[act] = at_best[act] - diagram.settings.collision * _risk(met, act, diagram, sides)
    best = ACTS[int(np.nanargmax(utility))] if weighed else doing
    return Refined(best, utility, weighed, used, stopped)


def _order(at_best: Floats, doing: int) -> list[int]:
    """What is being done, then the others, those first that are worth most at best."""
    others = [act for act in np.argsort(-at_best, kind="stable").tolist() if act != doing]
    return [doing, *others]


def _without_collision(met: Sequence[Encounter], doing: str, diagram: Diagram) -> Floats:
    """What each act is worth at best: nothing is touched."""
    loss = np.max([diagram.loss @ one.heard.sum(axis=(1, 2)) for one in met], axis=0)
    worth: Floats = -loss - diagram.change[ACTS.index(doing)]
    return worth


def _risk(met: Sequence[Encounter], act: int, diagram: Diagram, sides: Sides) -> float:
    """The share of a collision that an act comes to with all things together."""
    row = int(rooms_of(sides.room)[act])
    share = np.ones(diagram.risk.shape[-3])
    share[STANDS] = diagram.settings.overlooks if sides.open[act] > 0.0 else 1.0
    spared = 1.0
    for one in met:
        hits = (one.heard * diagram.risk[one.side, row, act]).sum(axis=(1, 2))
        spared *= 1.0 - float(hits @ share)
    return 1.0 - spared


def _cells_of_order(met: Sequence[Encounter]) -> int:
    return len(met) * len(ACTS) * len(met[0].heard)


def _cells_of_act(met: Sequence[Encounter]) -> int:
    return sum(int(np.count_nonzero(one.heard)) for one in met)
