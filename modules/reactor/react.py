"""What to do about what is ahead: the act of highest expected utility."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from modules.reactor.cone import Floats
from modules.reactor.meeting import ACTS
from modules.reactor.tables import (
    SIDES_M,
    TTC_CLASSES,
    TTC_EDGES_S,
    TTC_S,
    WHAT,
    Settings,
    utility_table,
)
from modules.reactor.thing import LINES_M, SPEEDS_M_S, Thing
from modules.reactor.track import Tracker


@dataclass(frozen=True)
class Encounter:
    """What is believed of one thing, as the influence diagram needs it.

    ``what`` (what, ttc, line) sums to 1; ``side`` is the index in SIDES_M of where the robot is.
    """

    what: Floats
    side: int


@dataclass(frozen=True)
class Reaction:
    """An act and why: expected utility of each act in the order of ACTS (seconds of time).

    ``approaching`` is the probability that the thing walks towards the robot, ``collision_s``
    the expected time to collision if it is real (the middles of the classes; inf for nothing).
    """

    act: str
    expected_utility: Floats
    approaching: float
    collision_s: float
    cells: int

    @property
    def side(self) -> str:
        """``"left"``, ``"right"`` or ``""``: to which side the robot pulls."""
        return self.act.removeprefix("pull aside ") if self.act.startswith("pull") else ""


def encounter(thing: Thing, lateral_m: float, settings: Settings) -> Encounter:
    """The belief about a thing in the classes of the influence diagram."""
    body, walking = settings.body, settings.walking
    reach = body.radius_m + walking.radius_m
    closing = SPEEDS_M_S[:, None] + body.speed_m_s
    seconds = np.maximum((thing.distance_m - reach) / closing, 0.0)
    ttc = np.clip(np.searchsorted(TTC_EDGES_S, seconds, side="right") - 1, 0, TTC_CLASSES - 1)
    what = np.zeros((len(WHAT), TTC_CLASSES, len(LINES_M)))
    what[0, -1] = thing.false / len(LINES_M)
    kind = np.where(SPEEDS_M_S > 0, 2, 1)[:, None]
    line = np.arange(len(LINES_M))[None, :]
    np.add.at(what, (np.broadcast_to(kind, ttc.shape), ttc, line + 0 * ttc), thing.weight)
    side = int(np.abs(SIDES_M - lateral_m).argmin())
    return Encounter(what, side)


def decide(met: Encounter, settings: Settings) -> Reaction:
    """The act of highest expected utility; on a tie the first of ACTS."""
    likely = np.nonzero(met.what)
    table = utility_table(settings)[met.side]
    real = met.what[1:].sum(axis=(0, 2))
    utility: Floats = table[:, *likely] @ met.what[likely]
    return Reaction(
        act=ACTS[int(utility.argmax())],
        expected_utility=utility,
        approaching=float(met.what[2].sum()),
        collision_s=float(real @ TTC_S / real.sum()) if real.sum() > 0 else np.inf,
        cells=len(ACTS) * len(likely[0]),
    )


def react(tracker: Tracker, settings: Settings) -> Reaction | None:
    """What to do now; None for "go on with what you are doing".

    A single echo tells neither speed nor truth, so it asks for attention
    (:attr:`Tracker.wants_attention`) and not for an act. Of several things the one decides that
    has most to say against going on. When nothing has called for attention for
    ``settings.clear_s`` seconds the act is to continue.
    """
    known = [t for t in tracker.things if t.pings > 1]
    reactions = [decide(encounter(t, tracker.lateral_m, settings), settings) for t in known]
    acting = [r for r in reactions if r.act != "continue" and not _can_wait(r, settings)]
    cells = sum(r.cells for r in reactions)
    if acting:
        worst = max(acting, key=lambda r: float(r.expected_utility.max() - r.expected_utility[0]))
        return replace(worst, cells=cells)
    if tracker.quiet_s < settings.clear_s:
        return None
    return Reaction("continue", np.zeros(len(ACTS)), tracker.approaching, np.inf, cells)


def _can_wait(reaction: Reaction, settings: Settings) -> bool:
    """Whether another ping comes before the act is due, and may show that it was for nothing."""
    return reaction.approaching < settings.sure and reaction.collision_s > settings.soon_s
