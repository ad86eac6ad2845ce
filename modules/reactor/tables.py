"""The influence diagram of an encounter, compiled to one table.

Chance nodes: *what* the thing is, whether it *yields*, its *line*, its *time to collision*
class; known: how far across the corridor the robot is; decision: the *act*; utility: collision,
delay, blocking. What cannot be observed and does not depend on an act (yields) is summed out
beforehand, so that an encounter costs one weighted sum for each act.

P(collision | ...) is computed from the geometry (:mod:`modules.reactor.meeting`). The
preferences and P(yields) are assumptions; the unit of utility is a second of the robot's time.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from itertools import product

import numpy as np

from modules.reactor.cone import Floats
from modules.reactor.meeting import (
    ACTS,
    Body,
    Walking,
    touches_standing,
    touches_walker,
)
from modules.reactor.thing import LINE_EDGES_M

WHAT = ("false echo", "stands", "walks")
SIDES_M: Floats = np.linspace(-0.7, 0.7, 29)
"""Where across the corridor the robot may be, every 5 cm; a table for each."""

TTC_EDGES_S: Floats = np.array(
    [0.0, 0.5, 1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 3.0, 4.0, 6.0, 10.0, 20.0]
)
"""Edges of the classes of time to collision; beyond the last counts as the last.

Narrow about 1.8 s, which is what pulling aside takes: there the best act changes.
"""

TTC_S: Floats = (TTC_EDGES_S[1:] + TTC_EDGES_S[:-1]) / 2
TTC_CLASSES = len(TTC_EDGES_S) - 1
POINTS = 4
"""Points inside each class, line and spread of speeds at which the geometry is looked at."""

PACES_M_S: Floats = np.array([0.8, 1.3, 1.8])


@dataclass(frozen=True)
class Settings:
    """What the reactor assumes and prefers.

    ``collision``, ``delay_s`` and ``blocking`` are losses in seconds of the robot's time;
    ``delay_s`` and ``blocking`` by (act, what), acts as in ACTS, whats as in WHAT. A collision
    is worth a quarter of an hour; standing in the middle of somebody's way annoys him. Whether
    a person yields is an assumption too: most look up.
    An act is put off to the next ping while collision is further off than ``soon_s`` (what
    pulling aside takes and a second to think) and P(approaching) is less than ``sure``.
    ``again_s`` is how soon a thing that stands is thought about again: two ordinary pings.
    """

    yields: float = 0.7
    collision: float = 1000.0
    delay_s: tuple[tuple[float, float, float], ...] = (
        (0.0, 0.0, 0.0),
        (2.0, 2.0, 3.0),
        (5.0, 5.0, 6.0),
        (9.0, 12.0, 10.0),
        (9.0, 12.0, 10.0),
        (15.0, 15.0, 18.0),
    )
    blocking: tuple[tuple[float, float, float], ...] = (
        (0.0, 0.0, 2.0),
        (0.0, 0.0, 2.0),
        (0.0, 0.0, 5.0),
        (0.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
        (0.0, 0.0, 2.0),
    )
    again_s: float = 4.0
    clear_s: float = 3.0
    sure: float = 0.99
    soon_s: float = 3.0
    body: Body = field(default_factory=Body)
    walking: Walking = field(default_factory=Walking)


def points_in(edges: Floats) -> Floats:
    """Evenly spread points inside each class: (classes, POINTS)."""
    share = (np.arange(POINTS) + 0.5) / POINTS
    return edges[:-1, None] + np.diff(edges)[:, None] * share


def collision_table(settings: Settings) -> Floats:
    """P(collision | side, act, what, yields, ttc, line), from the geometry of the corridor.

    Shape (29, 6, 3, 2, 13, 9). Within a class everything is equally likely.
    """
    return _collisions(settings.body, settings.walking, settings.again_s)


@lru_cache(maxsize=8)
def _collisions(body: Body, walking: Walking, again_s: float) -> Floats:
    """The collision table, which does not depend on preferences."""
    lines = points_in(LINE_EDGES_M)[None, :, None, :, None]
    seconds = points_in(TTC_EDGES_S)[:, None, :, None, None]
    reach = body.radius_m + walking.radius_m
    shape = (len(SIDES_M), len(ACTS), len(WHAT), 2, TTC_CLASSES, len(LINE_EDGES_M) - 1)
    table = np.zeros(shape)
    standing = reach + seconds[..., 0] * body.speed_m_s
    walker = reach + seconds * (PACES_M_S + body.speed_m_s)
    for (i, side), (a, act) in product(enumerate(SIDES_M), enumerate(ACTS)):
        stands = touches_standing(act, side, standing, lines[..., 0], again_s, body, walking)
        table[i, a, 1, :] = stands.mean(axis=(2, 3))
        for yields in (0, 1):
            hit = touches_walker(act, bool(yields), side, walker, lines, PACES_M_S, body, walking)
            table[i, a, 2, yields] = hit.mean(axis=(2, 3, 4))
    table.setflags(write=False)
    return table


def loss_table(settings: Settings) -> Floats:
    """Loss that does not depend on a collision: delay and blocking, (acts, what)."""
    loss: Floats = np.array(settings.delay_s) + np.array(settings.blocking)
    return loss


@lru_cache(maxsize=8)
def utility_table(settings: Settings) -> Floats:
    """Expected utility by (side, act, what, ttc, line), with yields summed out."""
    odds = np.array([1.0 - settings.yields, settings.yields])
    collision = np.einsum("sawytl,y->sawtl", collision_table(settings), odds)
    table: Floats = -settings.collision * collision - loss_table(settings)[None, :, :, None, None]
    table.setflags(write=False)
    return table
