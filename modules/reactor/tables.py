"""The influence diagram of an encounter, compiled to one table.

Chance nodes: *what* the thing is, whether it *yields*, its *line*, its *time to collision*
class (of a thing that stands: how far ahead it is); known: how far across the corridor the
robot is, and what it is doing; decision: the *act*; utility: collision, delay, blocking,
changing one's mind. What cannot be observed and does not depend on an act (yields) is summed
out beforehand, so that an encounter costs one weighted sum for each act.

P(collision | ...) is computed from the geometry (:mod:`modules.reactor.meeting`). The
preferences and P(yields) are assumptions; the unit of utility is a second of the robot's time.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numba import njit

from modules.reactor.cone import Floats
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
from modules.reactor.thing import LINE_EDGES_M

WHAT = ("false echo", "stands", "walks")
FALSE_ECHO, STANDS, WALKS = range(3)

SIDES_M: Floats = np.linspace(-0.65, 0.65, 27)
"""Where across the corridor the robot may be, every 5 cm; a table for each."""

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

SPARE_M = 0.1
"""How much further ahead a thing that stands may be than is reckoned: it is not heard while
the robot is abreast of it."""


@dataclass(frozen=True)
class Settings:
    """What the reactor assumes and prefers.

    ``collision``, ``delay_s`` and ``blocking`` are losses in seconds of the robot's time;
    ``delay_s`` and ``blocking`` by (act, what), acts as in ACTS, whats as in WHAT. A collision
    is worth a quarter of an hour; waiting for what stands gets nowhere, and what is left of the
    day (``delay_s`` of 300) is worth a risk of a few tenths; passing it takes 2.1 m at half
    speed; standing in the middle of somebody's way annoys him; doing
    something else than now costs ``change_s``, and crossing over from one side to the other
    ``cross_s``, for it takes the person by surprise; a robot that is passing something on one
    side and tries the other loses ``turn_back_s``. Whether a person yields is an assumption
    too: most look up.

    What approaches with less than ``possible`` is not thought about, nor what stands beyond
    ``near_m`` or is a false echo with more than ``dismissed``. An act can wait for the next
    ping, which may show more, until P(approaching) is above ``sure`` and P(collision) below
    ``accepts``; but no longer than until something is here within ``soon_s`` (what pulling
    aside takes and half a second) with a probability of ``hurry``. ``clear_s`` is how long
    nothing may approach before the robot goes on; ``answers_after`` how many pings must be of a
    thing before it is spoken of for itself.
    """

    yields: float = 0.7
    collision: float = 1000.0
    delay_s: tuple[tuple[float, float, float], ...] = (
        (0.0, 0.0, 0.0),
        (2.0, 2.0, 3.0),
        (5.0, 300.0, 6.0),
        (9.0, 300.0, 10.0),
        (9.0, 300.0, 10.0),
        (9.0, 25.0, 12.0),
        (9.0, 25.0, 12.0),
        (15.0, 300.0, 18.0),
    )
    blocking: tuple[tuple[float, float, float], ...] = (
        (0.0, 0.0, 2.0),
        (0.0, 0.0, 2.0),
        (0.0, 0.0, 5.0),
        (0.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
        (0.0, 0.0, 0.0),
        (0.0, 0.0, 2.0),
    )
    change_s: float = 8.0
    cross_s: float = 12.0
    turn_back_s: float = 100.0
    near_m: float = 1.5
    dismissed: float = 0.9
    answers_after: int = 4
    clear_s: float = 3.0
    possible: float = 0.01
    sure: float = 0.95
    accepts: float = 0.001
    soon_s: float = 2.75
    hurry: float = 0.1
    body: Body = field(default_factory=Body)
    walking: Walking = field(default_factory=Walking)


def collision_table(settings: Settings) -> Floats:
    """P(collision | side, act, what, yields, ttc, line), from the geometry of the corridor.

    Shape (27, 8, 3, 2, 13, 17). Within a class everything is equally likely.
    """
    return _collisions(settings.body, settings.walking)


def loss_table(settings: Settings) -> Floats:
    """Loss that does not depend on a collision: delay and blocking, (acts, what)."""
    loss: Floats = np.array(settings.delay_s) + np.array(settings.blocking)
    return loss


@dataclass(frozen=True, eq=False)
class Diagram:
    """The influence diagram, compiled.

    ``risk`` (side, act, what, ttc, line) is P(collision) with yields summed out; ``loss``
    (act, what) what an act costs besides; ``change`` (act, act) what it costs to do the second
    after the first.
    """

    settings: Settings
    risk: Floats
    loss: Floats
    change: Floats


def compiled(settings: Settings) -> Diagram:
    """The diagram with these preferences."""
    odds = np.array([1.0 - settings.yields, settings.yields])
    risk: Floats = np.ascontiguousarray(np.moveaxis(collision_table(settings), 3, -1) @ odds)
    return Diagram(settings, risk, loss_table(settings), change_table(settings))


def change_table(settings: Settings) -> Floats:
    """What it costs to do another act (column) than now (row): (acts, acts)."""
    change: Floats = settings.change_s * (1.0 - np.eye(len(ACTS)))
    change[np.ix_(LEFT, RIGHT)] = change[np.ix_(RIGHT, LEFT)] = settings.cross_s
    one, other = ACTS.index("pass left"), ACTS.index("pass right")
    change[one, other] = change[other, one] = settings.turn_back_s
    return change


@lru_cache(maxsize=8)
def _collisions(body: Body, walking: Walking) -> Floats:
    """The collision table, which does not depend on preferences."""
    lines, seconds = _points_in(LINE_EDGES_M, LINES), _points_in(TTC_EDGES_S, SECONDS)
    places = _points_in(STANDS_EDGES_M, SECONDS)
    table = np.zeros((len(SIDES_M), len(ACTS), len(WHAT), 2, *seconds.shape[:1], *lines.shape[:1]))
    mirror = [ACTS.index(_mirrored(act)) for act in ACTS]
    for side, lateral_m in enumerate(SIDES_M[: len(SIDES_M) // 2 + 1]):
        for a, act in enumerate(ACTS):
            motion = body.motion(act, float(lateral_m))
            _fill_standing(table[side, a, STANDS], motion, lines, places, body, walking)
            _fill_walking(table[side, a, WALKS], motion, lines, seconds, PACES_M_S, body, walking)
    for side in range(len(SIDES_M) // 2):
        table[-1 - side] = table[side, mirror][..., ::-1]
    return table


def _mirrored(act: str) -> str:
    """The same act on the other side."""
    swap = {"left": "right", "right": "left"}
    return " ".join(swap.get(word, word) for word in act.split(" "))


def _points_in(edges: Floats, count: int) -> Floats:
    """Evenly spread points inside each class: (classes, count)."""
    share = (np.arange(count) + 0.5) / count
    points: Floats = edges[:-1, None] + np.diff(edges)[:, None] * share
    return points


@njit(cache=True)
def _fill_standing(
    table: Floats, motion: Motion, lines_m: Floats, places_m: Floats, body: Body, walking: Walking
) -> None:
    """The collision table of a thing that stands, one side and act: (yields, place, line)."""
    for place in range(len(places_m)):
        for line in range(len(lines_m)):
            touched = 0
            for ahead in places_m[place]:
                for y in lines_m[line]:
                    near = touches_standing(motion, ahead, y, body, walking)
                    far = touches_standing(motion, ahead + SPARE_M, y, body, walking)
                    touched += near or far
            table[:, place, line] = touched / (places_m.shape[1] * lines_m.shape[1])


@njit(cache=True)
def _fill_walking(
    table: Floats,
    motion: Motion,
    lines_m: Floats,
    seconds: Floats,
    paces_m_s: Floats,
    body: Body,
    walking: Walking,
) -> None:
    """The collision table of a person, one side and act: (yields, ttc, line)."""
    reach = body.radius_m + walking.radius_m
    for ttc in range(len(seconds)):
        for line in range(len(lines_m)):
            walks = np.zeros(2)
            for second in seconds[ttc]:
                for y in lines_m[line]:
                    for pace in paces_m_s:
                        at = reach + second * (pace + body.speed_m_s)
                        walks[0] += touches_walker(motion, False, at, y, pace, body, walking)
                        walks[1] += touches_walker(motion, True, at, y, pace, body, walking)
            points = seconds.shape[1] * lines_m.shape[1]
            table[:, ttc, line] = walks / (points * len(paces_m_s))
