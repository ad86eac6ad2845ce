"""Expected utilities of one encounter: numba kernels."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

from modules.reactor.cone import Floats
from modules.reactor.diagram import (
    COMES_FAST,
    COMES_SLOWLY,
    FALSE_ECHO,
    HEARD,
    SLOW_M_S,
    STANDS,
)
from modules.reactor.meeting import ACTS
from modules.reactor.tables import STANDS_EDGES_M, TTC_CLASSES, TTC_EDGES_S
from modules.reactor.thing import COLUMNS, DISTANCE, SPEEDS_M_S, WEIGHT

Ints: TypeAlias = NDArray[np.int64]


@njit(cache=True)
def in_classes(
    belief: Floats, false: float, reach_m: float, speed_m_s: float, soon_s: float
) -> tuple[Floats, float]:
    """The belief about a thing by how it moves, class of time or place, and column; P(soon).

    ``reach_m`` is the distance at which it touches, ``speed_m_s`` how fast the robot drives;
    soon is within ``soon_s``.
    """
    soon = 0.0
    heard = np.zeros((len(HEARD), TTC_CLASSES, COLUMNS))
    heard[FALSE_ECHO, -1] = false / COLUMNS
    for row in range(len(SPEEDS_M_S)):
        kind = COMES_SLOWLY if SPEEDS_M_S[row] < SLOW_M_S else COMES_FAST
        kind = STANDS if row == 0 else kind
        closing = SPEEDS_M_S[row] + speed_m_s
        for column in range(COLUMNS):
            weight = belief[WEIGHT, row, column]
            if weight > 0.0:
                ahead = belief[DISTANCE, row, column]
                seconds = (ahead - reach_m) / closing
                at = _class(ahead, STANDS_EDGES_M) if row == 0 else _class(seconds, TTC_EDGES_S)
                heard[kind, at, column] += weight
                soon += weight if seconds < soon_s else 0.0
    return heard, soon


@njit(cache=True)
def _class(value: float, edges: Floats) -> int:
    """The class of a time to collision (s) or of how far ahead something stands (m)."""
    k = 0
    while k < TTC_CLASSES - 1 and value >= edges[k + 1]:
        k += 1
    return k


@njit(cache=True)
def expected(
    heard: Floats, risk_table: Floats, rooms: Ints, stands_there: Floats, loss: Floats
) -> tuple[Floats, Floats, float, int]:
    """Collision and loss of each act, P(somebody comes), entries touched.

    ``risk_table`` (rooms, acts, heard, ttc, column) is that of the robot's side, ``rooms`` (acts,)
    the class of the room that each act has, ``stands_there`` (acts,) how much of the risk by what
    stands remains when it was looked whether the way is open, ``loss`` (acts, heard).
    """
    risk, entries = np.zeros(len(ACTS)), 0
    kinds = np.zeros(len(HEARD))
    for kind in range(len(HEARD)):
        for ttc in range(TTC_CLASSES):
            for column in range(COLUMNS):
                p = heard[kind, ttc, column]
                if p == 0.0:
                    continue
                entries += len(ACTS)
                kinds[kind] += p
                for act in range(len(ACTS)):
                    hit = p * risk_table[rooms[act], act, kind, ttc, column]
                    risk[act] += hit * stands_there[act] if kind == STANDS else hit
    return risk, loss @ kinds, kinds[COMES_SLOWLY] + kinds[COMES_FAST], entries
