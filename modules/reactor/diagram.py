"""The influence diagram of an encounter: its nodes, probabilities and preferences.

Known when deciding: how a thing was heard to move (``HEARD``), its line and how soon or where it
is; where across the corridor the robot is, the room on either side, and what it is doing. Not
known: *what* it is and what it *intends*. Decision: the *act*. Utility: collision, blocked way,
delay, changing one's mind. :mod:`modules.reactor.tables` compiles it,
:mod:`modules.reactor.declared` declares it in pyAgrum.

All numbers here are assumptions; the unit of utility is a second of the robot's time.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from modules.reactor.cone import Floats
from modules.reactor.meeting import ACTS, CONTINUE, LEFT, RIGHT, Body, Walking

HEARD = ("false echo", "stands", "comes slowly", "comes fast")
FALSE_ECHO, STANDS, COMES_SLOWLY, COMES_FAST = range(4)

WHAT = ("echo", "left object", "door leaf", "person", "cart")
ECHO, LEFT_OBJECT, DOOR_LEAF, PERSON, CART = range(5)

INTENT = ("keeps on", "makes room")
KEEPS_ON, MAKES_ROOM = range(2)
"""A person who makes room sidesteps, a door that does closes again; a cart cannot."""

SLOW_M_S = 1.05
"""Below this somebody comes slowly: carts are pushed at less than a walking pace."""

WAYS = ("echo", "stays", "goes away", "comes")
"""What the time that an act loses depends on: columns of ``delay_s``."""


@dataclass(frozen=True)
class Settings:
    """What the reactor assumes and prefers.

    ``what`` is P(what | heard), rows as in HEARD; ``makes_room`` P(intent | what): half
    of the people look up.
    ``collision`` is the loss by a collision, a quarter of an hour; ``touch`` the share of it
    that comes of touching at half speed what stands: the bumper stops a robot at 4 cm/s.
    ``delay_s`` is by (act, way), acts as in ACTS, ways as in WAYS: waiting for what stays gets
    nowhere, and what is left of the day (300 s) is worth a risk of a few tenths; passing it
    takes 2.1 m at half speed. ``blocking`` (acts,) is how standing in the middle of somebody's
    way annoys him. Doing something else than now costs ``change_s``, and crossing over from one
    side to the other ``cross_s``, for it takes the person by surprise; a robot that is passing
    something on one side and tries the other loses ``turn_back_s``.

    Where the ring finds the way of an act open, what was thought to stand in it is overlooked
    with ``overlooks``.

    What approaches with less than ``possible`` is not thought about, nor what stands beyond
    ``near_m`` or is a false echo with more than ``dismissed``. An act can wait for the next
    ping, which may show more, until P(approaching) is above ``sure`` and P(collision) below
    ``accepts``; but no longer than until something is here within ``soon_s`` (what pulling
    aside takes and half a second) with a probability of ``hurry``. ``clear_s`` is how long
    nothing may approach before the robot goes on, unless it wins ``escapes_s`` by going back to
    the middle; ``answers_after`` how many pings must be of a
    thing before it is spoken of for itself.
    """

    what: tuple[tuple[float, ...], ...] = (
        (1.0, 0.0, 0.0, 0.0, 0.0),
        (0.0, 0.9, 0.1, 0.0, 0.0),
        (0.0, 0.0, 0.0, 0.8, 0.2),
        (0.0, 0.0, 0.0, 0.98, 0.02),
    )
    makes_room: tuple[float, ...] = (0.0, 0.0, 0.8, 0.5, 0.0)
    collision: float = 1000.0
    touch: float = 0.08
    delay_s: tuple[tuple[float, float, float, float], ...] = (
        (0.0, 0.0, 0.0, 0.0),
        (2.0, 2.0, 2.0, 3.0),
        (5.0, 300.0, 12.0, 6.0),
        (9.0, 300.0, 16.0, 10.0),
        (9.0, 300.0, 16.0, 10.0),
        (9.0, 25.0, 25.0, 12.0),
        (9.0, 25.0, 25.0, 12.0),
        (15.0, 300.0, 20.0, 18.0),
    )
    blocking: tuple[float, ...] = (2.0, 2.0, 5.0, 0.0, 0.0, 0.0, 0.0, 2.0)
    change_s: float = 8.0
    cross_s: float = 12.0
    turn_back_s: float = 100.0
    overlooks: float = 0.01
    near_m: float = 1.5
    dismissed: float = 0.9
    answers_after: int = 4
    clear_s: float = 3.0
    escapes_s: float = 100.0
    possible: float = 0.01
    sure: float = 0.95
    accepts: float = 0.001
    soon_s: float = 2.75
    hurry: float = 0.1
    body: Body = field(default_factory=Body)
    walking: Walking = field(default_factory=Walking)


def what_table(settings: Settings) -> Floats:
    """P(what | heard): (heard, what)."""
    table: Floats = np.array(settings.what)
    return table


def intent_table(settings: Settings) -> Floats:
    """P(intent | what): (what, intent)."""
    makes_room = np.array(settings.makes_room)
    return np.stack([1.0 - makes_room, makes_room], axis=1)


def severity_table(settings: Settings) -> Floats:
    """How bad a collision is, as a share of ``collision``: (acts, what)."""
    severity = np.ones((len(ACTS), len(WHAT)))
    for what in (LEFT_OBJECT, DOOR_LEAF):
        severity[np.arange(len(ACTS)) != CONTINUE, what] = settings.touch
    return severity


def time_table(settings: Settings) -> Floats:
    """Delay and blocking, whatever is touched: (acts, what, intent)."""
    delay = np.array(settings.delay_s)
    echo, stays, goes_away, comes = range(len(WAYS))
    table = np.empty((len(ACTS), len(WHAT), len(INTENT)))
    table[:, ECHO] = delay[:, [echo]]
    table[:, LEFT_OBJECT] = delay[:, [stays]]
    table[:, DOOR_LEAF] = delay[:, [stays, goes_away]]
    table[:, PERSON] = table[:, CART] = delay[:, [comes]] + np.array(settings.blocking)[:, None]
    return table


def change_table(settings: Settings) -> Floats:
    """What it costs to do another act (column) than now (row): (acts, acts).

    To drive on at full speed after driving slowly is no change of mind.
    """
    change: Floats = settings.change_s * (1.0 - np.eye(len(ACTS)))
    change[ACTS.index("slow"), CONTINUE] = 0.0
    change[np.ix_(LEFT, RIGHT)] = change[np.ix_(RIGHT, LEFT)] = settings.cross_s
    one, other = ACTS.index("pass left"), ACTS.index("pass right")
    change[one, other] = change[other, one] = settings.turn_back_s
    return change
