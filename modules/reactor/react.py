"""What to do about what is ahead: the act of highest expected utility."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from modules.reactor.cone import Floats
from modules.reactor.diagram import Settings
from modules.reactor.meeting import ACTS, LEFT, RIGHT
from modules.reactor.react_kernels import expected, in_classes
from modules.reactor.room import rooms_of
from modules.reactor.sides import UNSEEN, Sides
from modules.reactor.tables import SIDES_M, Diagram
from modules.reactor.track import Tracker
from modules.reactor.track_kernels import APPROACHING, FALSE, FIRST_S, PINGS, STANDS_AT_M


@dataclass(frozen=True, slots=True)
class Encounter:
    """What is believed of one thing, as the influence diagram needs it.

    ``heard`` (heard, ttc, column) sums to 1; ``side`` is the index in SIDES_M of where the robot
    is; ``soon`` the probability that the thing is here within ``soon_s``.
    """

    heard: Floats
    side: int
    soon: float


@dataclass(frozen=True, slots=True)
class Outlook:
    """What comes of each act in the order of ACTS, as far as one thing is concerned.

    ``risk`` is collision as a share of the worst and ``loss`` the expected loss besides, in
    seconds of the robot's time; ``approaching`` the probability that the thing comes towards the
    robot; ``cells`` the table entries touched; ``soon`` as in :class:`Encounter`.
    """

    risk: Floats
    loss: Floats
    approaching: float
    cells: int
    soon: float


@dataclass(frozen=True, slots=True)
class Reaction:
    """The best act and why: expected utility of each act in the order of ACTS (seconds of time).

    ``approaching`` is the probability that something walks towards the robot. ``due`` says
    whether to act on it now; if not, another ping comes in time. ``newest_s`` is when the
    newest thing was first heard that certainly approaches (-inf for none), ``cells`` the table
    entries touched.
    """

    act: str
    expected_utility: Floats
    approaching: float
    cells: int
    due: bool
    newest_s: float = -math.inf


def encounter(belief: Floats, false: float, lateral_m: float, settings: Settings) -> Encounter:
    """The belief about a thing in the classes of the influence diagram."""
    body = settings.body
    reach_m = body.radius_m + settings.walking.radius_m
    heard, soon = in_classes(belief, false, reach_m, body.speed_m_s, settings.soon_s)
    side = round((lateral_m - SIDES_M[0]) / (SIDES_M[1] - SIDES_M[0]))
    return Encounter(heard, min(max(side, 0), len(SIDES_M) - 1), soon)


def outlook(met: Encounter, diagram: Diagram, sides: Sides = UNSEEN) -> Outlook:
    """What comes of each act in an encounter, given the room beside the robot and what is open."""
    risk = diagram.risk[met.side]
    stands_there = np.where(sides.open > 0.0, diagram.settings.overlooks, 1.0)
    known = expected(met.heard, risk, rooms_of(sides.room), stands_there, diagram.loss)
    return Outlook(*known, soon=met.soon)


def utilities(outlooks: Sequence[Outlook], doing: int, diagram: Diagram) -> Floats:
    """Expected utility of each act with all things together, (acts,).

    The things threaten independently; the act is delayed or blocks somebody's way only once.
    ``doing`` is the index of the act that is being done, from which any other is a change.
    """
    if len(outlooks) == 1:
        risk, loss = outlooks[0].risk, outlooks[0].loss
    else:
        risk = 1.0 - np.prod([1.0 - one.risk for one in outlooks], axis=0)
        loss = np.max([one.loss for one in outlooks], axis=0)
    collision = diagram.settings.collision
    utility: Floats = -collision * risk - loss - diagram.change[doing]
    return utility


def react(tracker: Tracker, doing: str, diagram: Diagram, sides: Sides = UNSEEN) -> Reaction | None:
    """What to do now, the act of highest expected utility; None if nothing is worth a thought.

    A single echo tells neither speed nor truth, so it asks for attention
    (:attr:`Tracker.wants_attention`) and not for an act. A robot that has stopped or pulled
    aside goes on when nothing has called for attention for ``settings.clear_s`` seconds, and
    not before; unless to stay aside is so dangerous that ``settings.escapes_s`` are to be won.
    One that passes something stays aside for as long as that is beside it.
    """
    settings = diagram.settings
    passes = doing.startswith("pass") and sides.abreast
    clear = tracker.quiet_s >= settings.clear_s and not passes
    met = [(k, note) for k, note in enumerate(tracker.notes.tolist()) if _matters(note, settings)]
    if met:
        outlooks = [
            outlook(
                encounter(tracker.beliefs[k], note[FALSE], tracker.lateral_m, settings),
                diagram,
                sides,
            )
            for k, note in met
        ]
        utility = utilities(outlooks, ACTS.index(doing), diagram)
        best = int(utility.argmax())
        goes_on = _goes_on(doing, ACTS[best])
        escapes = utility[best] - utility[ACTS.index(doing)] > settings.escapes_s
        return Reaction(
            act=ACTS[best],
            expected_utility=utility,
            approaching=tracker.approaching,
            cells=sum(one.cells for one in outlooks),
            due=clear or escapes if goes_on else _is_due(outlooks, best, settings),
            newest_s=max(_first_s(note, settings) for _, note in met),
        )
    if doing == "continue" or not clear:
        return None
    return Reaction("continue", -diagram.loss[:, 0], tracker.approaching, len(ACTS), due=True)


def _goes_on(doing: str, act: str) -> bool:
    """Whether an act goes on after another one, or leads back to the middle from beside it."""
    if act == "slow":
        return ACTS.index(doing) in LEFT + RIGHT
    return act == "continue" and doing != "continue"


def _first_s(note: Sequence[float], settings: Settings) -> float:
    """When a thing was first heard if it certainly approaches, else -inf."""
    sure = note[APPROACHING] > settings.sure and note[PINGS] >= settings.answers_after
    return note[FIRST_S] if sure else -math.inf


def _matters(note: Sequence[float], settings: Settings) -> bool:
    """Whether a thing is known well enough, and may be in the way.

    What most likely is a false echo is not stopped for: beside the robot, where no transducer
    looks, nothing would ever speak for or against it.
    """
    near = note[STANDS_AT_M] < settings.near_m and note[FALSE] < settings.dismissed
    return note[PINGS] > 1 and (near or note[APPROACHING] > settings.possible)


def _is_due(outlooks: Sequence[Outlook], act: int, settings: Settings) -> bool:
    """Whether to act now: enough is known, or waiting for another ping may be too late."""
    risk = max(float(one.risk[act]) for one in outlooks)
    known = max(one.approaching for one in outlooks) > settings.sure
    soon = max(one.soon for one in outlooks) > settings.hurry
    return soon or (known and risk < settings.accepts)
