"""Expected utilities of one encounter: numba kernels."""

from __future__ import annotations

import numpy as np
from numba import njit

from modules.reactor.cone import Floats
from modules.reactor.meeting import ACTS
from modules.reactor.tables import (
    FALSE_ECHO,
    STANDS,
    STANDS_EDGES_M,
    TTC_CLASSES,
    TTC_EDGES_S,
    WALKS,
    WHAT,
)
from modules.reactor.thing import DISTANCE, LINES_M, SPEEDS_M_S, WEIGHT


@njit(cache=True)
def in_classes(
    belief: Floats, false: float, reach_m: float, speed_m_s: float, soon_s: float
) -> tuple[Floats, float]:
    """The belief about a thing by what it is, class of time or place, and line; P(soon).

    ``reach_m`` is the distance at which it touches, ``speed_m_s`` how fast the robot drives;
    soon is within ``soon_s``.
    """
    soon = 0.0
    what = np.zeros((len(WHAT), TTC_CLASSES, len(LINES_M)))
    what[FALSE_ECHO, -1] = false / len(LINES_M)
    for row in range(len(SPEEDS_M_S)):
        kind = STANDS if row == 0 else WALKS
        closing = SPEEDS_M_S[row] + speed_m_s
        for line in range(len(LINES_M)):
            weight = belief[WEIGHT, row, line]
            if weight > 0.0:
                ahead = belief[DISTANCE, row, line]
                seconds = (ahead - reach_m) / closing
                at = _class(ahead, STANDS_EDGES_M) if row == 0 else _class(seconds, TTC_EDGES_S)
                what[kind, at, line] += weight
                soon += weight if seconds < soon_s else 0.0
    return what, soon


@njit(cache=True)
def _class(value: float, edges: Floats) -> int:
    """The class of a time to collision (s) or of how far ahead something stands (m)."""
    k = 0
    while k < TTC_CLASSES - 1 and value >= edges[k + 1]:
        k += 1
    return k


@njit(cache=True)
def expected(what: Floats, risk_table: Floats, loss: Floats) -> tuple[Floats, Floats, float, int]:
    """P(collision) and loss of each act, P(walks), entries touched.

    ``risk_table`` (acts, what, ttc, line) is that of the robot's side, ``loss`` (acts, what).
    """
    risk, entries = np.zeros(len(ACTS)), 0
    for kind in range(len(WHAT)):
        for ttc in range(TTC_CLASSES):
            for line in range(len(LINES_M)):
                p = what[kind, ttc, line]
                if p == 0.0:
                    continue
                entries += len(ACTS)
                for act in range(len(ACTS)):
                    risk[act] += p * risk_table[act, kind, ttc, line]
    kinds = np.array([what[0].sum(), what[1].sum(), what[2].sum()])
    return risk, loss @ kinds, kinds[WALKS], entries
