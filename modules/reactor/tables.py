"""The influence diagram of an encounter, compiled: one weighted sum for each act.

What cannot be observed and does not depend on an act (what the thing is, what it intends) is
summed out beforehand. P(collision | ...) is computed from the geometry
(:mod:`modules.reactor.meeting`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numba import njit

from modules.reactor.cone import Floats
from modules.reactor.diagram import (
    CART,
    DOOR_LEAF,
    INTENT,
    LEFT_OBJECT,
    PERSON,
    WHAT,
    Settings,
    change_table,
    intent_table,
    severity_table,
    time_table,
    what_table,
)
from modules.reactor.meeting import (
    ACTS,
    BEHIND_M,
    LEFT,
    RIGHT,
    Body,
    Motion,
    Walking,
    touches_standing,
    touches_walker,
)
from modules.reactor.thing import COLUMNS, LINE_EDGES_M, PAIR_HALF_M, PAIR_M, PAIRS_M, SINGLE

SIDES_M: Floats = np.linspace(-0.65, 0.65, 27)
"""Where across the corridor the robot may be, every 5 cm; a table for each."""

ROOMS_M: Floats = np.array([0.05, 0.2, 0.35, 0.5, 0.65])
"""How far aside there may be room for the robot; a table for each. An act goes so far."""

TTC_EDGES_S: Floats = np.array(
    [0.0, 0.5, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 3.0, 4.0, 6.0, 10.0, 20.0]
)
"""Edges of the classes of time to collision; beyond the last counts as the last.

Narrow about 1.7 s, which is what getting out of the way takes: there the best act changes.
"""

TTC_CLASSES = len(TTC_EDGES_S) - 1

STANDS_EDGES_M: Floats = np.array(
    [-BEHIND_M, -0.45, -0.3, -0.15, 0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 1.0, 1.25, 1.5, 2.0]
)
"""As many classes of how far ahead a thing is that stands: there only the place counts, and
that it stays in the way until it is behind. Beyond an end counts as that end."""

SECONDS, LINES = 4, 2
"""Points inside each class of time and inside each line at which the geometry is looked at."""

PACES_M_S: Floats = np.array([0.8, 1.3, 1.8])
"""Speeds at which it is looked at."""

CART_RADIUS_M = 0.35

SPARE_M = 0.1
"""How much further ahead a thing that stands may be than is reckoned: it is not heard while
the robot is abreast of it."""


def collision_table(settings: Settings) -> Floats:
    """P(collision | side, room, act, what, intent, ttc, column), from the geometry of the corridor.

    Shape (27, 5, 8, 5, 2, 13, 30). Within a class everything is equally likely. The room is that
    on the side to which the act goes; other acts are alike whatever the room. A *column* is a line
    or a pair, as in :mod:`modules.reactor.thing`; a pair is touched if one of the two is.
    """
    return _collisions(settings.body, settings.walking)


def risk_table(settings: Settings) -> Floats:
    """Collision as a share of the worst, what and intent summed out.

    Shape (27, 5, 8, 4, 13, 30): side, room, act, heard, ttc, column.
    """
    weight = np.einsum(
        "hw,wi,aw->ahwi",
        what_table(settings),
        intent_table(settings),
        severity_table(settings),
    )
    risk: Floats = np.einsum(
        "ahwi,srawitl->srahtl", weight, collision_table(settings), optimize=True
    )
    return np.ascontiguousarray(risk)


def loss_table(settings: Settings) -> Floats:
    """Loss that does not depend on a collision: delay and blocking, (acts, heard)."""
    loss: Floats = np.einsum(
        "hw,wi,awi->ah", what_table(settings), intent_table(settings), time_table(settings)
    )
    return loss


@dataclass(frozen=True, eq=False)
class Diagram:
    """The influence diagram, compiled.

    ``risk`` as of :func:`risk_table`, ``loss`` of :func:`loss_table`; ``change`` (act, act) what
    it costs to do the second after the first.
    """

    settings: Settings
    risk: Floats
    loss: Floats
    change: Floats


@lru_cache(maxsize=8)
def compiled(settings: Settings) -> Diagram:
    """The diagram with these preferences."""
    return Diagram(settings, risk_table(settings), loss_table(settings), change_table(settings))


@lru_cache(maxsize=2)
def _collisions(body: Body, walking: Walking) -> Floats:
    """The collision table, which does not depend on preferences."""
    shape = (len(WHAT), len(INTENT), TTC_CLASSES, COLUMNS)
    table = np.zeros((len(SIDES_M), len(ROOMS_M), len(ACTS), *shape))
    mirror = [ACTS.index(_mirrored(act)) for act in ACTS]
    for side, lateral_m in enumerate(SIDES_M[: len(SIDES_M) // 2 + 1]):
        for a, act in enumerate(ACTS):
            aside = a in LEFT or a in RIGHT
            for room in range(len(ROOMS_M) if aside else 1):
                motion = body.motion(act, float(lateral_m), float(ROOMS_M[room]))
                _fill(table[side, room, a], motion, body, walking)
            if not aside:
                table[side, 1:, a] = table[side, 0, a]
    for side in range(len(SIDES_M) // 2):
        table[-1 - side] = table[side][:, mirror][..., _mirrored_columns()]
    return table


def _fill(table: Floats, motion: Motion, body: Body, walking: Walking) -> None:
    """The collisions of one motion: (what, intent, ttc, column)."""
    across, seconds = _points_across(), _points_in(TTC_EDGES_S, SECONDS)
    places = _points_in(STANDS_EDGES_M, SECONDS)
    _fill_standing(table[LEFT_OBJECT], motion, across, places, body, walking)
    table[DOOR_LEAF] = table[LEFT_OBJECT]
    _fill_walking(table[PERSON], motion, across, seconds, PACES_M_S, body, walking)
    broad = walking._replace(radius_m=CART_RADIUS_M)
    _fill_walking(table[CART], motion, across, seconds, PACES_M_S[:1], body, broad)


def _mirrored(act: str) -> str:
    """The same act on the other side."""
    swap = {"left": "right", "right": "left"}
    return " ".join(swap.get(word, word) for word in act.split(" "))


def _mirrored_columns() -> list[int]:
    """The same columns on the other side."""
    pairs = PAIRS_M.tolist()
    return [*reversed(range(SINGLE)), *(SINGLE + pairs.index(pair[::-1]) for pair in pairs)]


def _points_in(edges: Floats, count: int) -> Floats:
    """Evenly spread points inside each class: (classes, count)."""
    share = (np.arange(count) + 0.5) / count
    points: Floats = edges[:-1, None] + np.diff(edges)[:, None] * share
    return points


def _points_across() -> Floats:
    """Who is where at the points of each column: (columns, points, 2, 2).

    For one or two things how far left of the centre line, and how much further ahead; NaN where
    there is no second.
    """
    points = np.zeros((COLUMNS, LINES, 2, 2))
    points[:SINGLE, :, 0, 0] = _points_in(LINE_EDGES_M, LINES)
    points[:SINGLE, :, 1, 0] = np.nan
    off = PAIR_M + np.linspace(-PAIR_HALF_M, PAIR_HALF_M, LINES)
    points[SINGLE:, :, :, 0] = np.stack([off, -off], axis=1)
    points[SINGLE:, :, :, 1] = PAIRS_M[:, None, :]
    return points


@njit(cache=True)
def _fill_standing(
    table: Floats, motion: Motion, across: Floats, places_m: Floats, body: Body, walking: Walking
) -> None:
    """The collision table of a thing that stands, one side and act: (yields, place, column)."""
    for place in range(len(places_m)):
        for column in range(len(across)):
            touched = 0
            for ahead in places_m[place]:
                for both in across[column]:
                    touched += _touches_those_standing(motion, ahead, both, body, walking)
            table[:, place, column] = touched / (places_m.shape[1] * across.shape[1])


@njit(cache=True)
def _touches_those_standing(
    motion: Motion, ahead_m: float, both: Floats, body: Body, walking: Walking
) -> bool:
    """Whether one of two things is touched; ``both`` as of :func:`_points_across`."""
    for left_m, more_m in both:
        for spare_m in (0.0, SPARE_M):
            at_m = ahead_m + more_m + spare_m
            if not np.isnan(left_m) and touches_standing(motion, at_m, left_m, body, walking):
                return True
    return False


@njit(cache=True)
def _fill_walking(
    table: Floats,
    motion: Motion,
    across: Floats,
    seconds: Floats,
    paces_m_s: Floats,
    body: Body,
    walking: Walking,
) -> None:
    """The collision table of a person, one side and act: (yields, ttc, column)."""
    reach = body.radius_m + walking.radius_m
    for ttc in range(len(seconds)):
        for column in range(len(across)):
            walks = np.zeros(2)
            for second in seconds[ttc]:
                for both in across[column]:
                    for pace in paces_m_s:
                        at = reach + second * (pace + body.speed_m_s)
                        for yields in range(2):
                            walks[yields] += _touches_those_walking(
                                motion, yields == 1, at, both, pace, body, walking
                            )
            points = seconds.shape[1] * across.shape[1]
            table[:, ttc, column] = walks / (points * len(paces_m_s))


@njit(cache=True)
def _touches_those_walking(
    motion: Motion,
    yields: bool,
    ahead_m: float,
    both: Floats,
    pace_m_s: float,
    body: Body,
    walking: Walking,
) -> bool:
    """Whether one of two people is touched; ``both`` as of :func:`_points_across`."""
    for left_m, more_m in both:
        at_m = ahead_m + more_m
        if not np.isnan(left_m) and touches_walker(
            motion, yields, at_m, left_m, pace_m_s, body, walking
        ):
            return True
    return False
