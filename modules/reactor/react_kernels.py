"""Expected utilities of one encounter: numba kernels."""

from __future__ import annotations

import numpy as np
from numba import njit

from modules.reactor.cone import Floats
from modules.reactor.meeting import ACTS
from modules.reactor.tables import FALSE_ECHO, STANDS, TTC_CLASSES, TTC_EDGES_S, WALKS, WHAT
from modules.reactor.thing import DISTANCE, LINES_M, SPEEDS_M_S, WEIGHT


@njit(cache=True)
def in_classes(
    belief: Floats, false: float, reach_m: float, speed_m_s: float, soon_s: float
) -> tuple[Floats, float]:
    """The belief about a thing by what it is, class of time to collision, and line; P(soon).

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
                seconds = (belief[DISTANCE, row, line] - reach_m) / closing
                what[kind, _ttc_class(seconds), line] += weight
                soon += weight if seconds < soon_s else 0.0
    return what, soon


@njit(cache=True)
def _ttc_class(seconds: float) -> int:
    """The class of a time to collision."""
    k = 0
    while k < TTC_CLASSES - 1 and seconds >= TTC_EDGES_S[k + 1]:
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
