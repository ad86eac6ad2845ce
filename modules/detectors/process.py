"""The detectors' messages: the classifier's choice in, motions and readings out.

On arrival, and whenever a sensing action ends, the next detector is the one decided for the
outcome; the body gets its steps in the same turn, so that it does not stand still.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bus.facts import Facts
from bus.features import Wedges
from bus.messages import (
    DRIVE,
    PING,
    TURN,
    ActionEnded,
    Arrival,
    Motion,
    Reading,
    Scan,
    SensingDecision,
)
from bus.turns import Handler, Turn
from bus.wire import MessageId
from modules.detectors.actions import ping_offsets_rad, plan
from modules.detectors.interpret import interpret
from modules.detectors.settings import Settings

STEP_KIND = {"drive": DRIVE, "turn": TURN, "ping": PING}
STOP = -1


class Detectors:
    """Runs one feature detector after another."""

    def __init__(self, nominal_width_m: float, wedges: Wedges) -> None:
        self._width_m = nominal_width_m
        self._wedges = wedges
        self._visit = -1
        self._action = 0  # the last one begun
        self._first = 0  # actions up to this one belong to visits before
        self._detector = STOP
        self._scans: list[NDArray[np.float64]] = []
        self._scanned: list[MessageId] = []  # the messages of these scans
        self._outcome: int | None = None  # of the action that ended; None while it runs
        self._outcome_from: tuple[MessageId, ...] = ()  # the message that told the outcome
        self._decisions: dict[tuple[int, int], tuple[SensingDecision, MessageId]] = {}
        self.handlers: Mapping[str, Handler] = {
            "percept/arrival": self._arrived,
            "percept/action": self._ended,
            "belief/scan": self._heard,
            "decision/sensing": self._decided,
        }

    def _decided(self, said: SensingDecision, turn: Turn) -> None:
        turn.work("note", 1)
        self._decisions[said.visit, said.action] = said, turn.heard
        self._go_on(turn)

    def _arrived(self, said: Arrival, turn: Turn) -> None:
        turn.work("note", 1)
        self._visit = said.visit
        self._first = self._action
        self._outcome, self._outcome_from = 0, (turn.heard,)
        self._go_on(turn)

    def _heard(self, said: Scan, turn: Turn) -> None:
        if said.action != self._action:
            turn.work("note", 1)
            return
        turn.work("scan", len(said.mean_m))
        self._scans.append(said.mean_m)
        self._scanned.append(turn.heard)

    def _ended(self, said: ActionEnded, turn: Turn) -> None:
        offsets_rad = np.array(ping_offsets_rad())
        if len(self._scans) != len(offsets_rad):
            # The sensor is down or a ping was lost: nothing that could be said were evidence,
            # so the robot stands, and the ledger tells since when and for what.
            turn.work("note", 1)
            return
        ranges_m = np.array(self._scans)
        turn.work("interpret", ranges_m.size)
        feature, wedge = self._wedges.parts(self._detector)
        found = interpret(feature, wedge, ranges_m, offsets_rad, self._width_m, self._wedges)
        turn.say(
            Reading(
                self._visit,
                said.action,
                feature,
                wedge,
                found.probability,
                found.evidence,
                self._wedges.count,
            ),
            *self._scanned,
        )
        self._outcome, self._outcome_from = found.evidence, (turn.heard,)
        self._go_on(turn)

    def _go_on(self, turn: Turn) -> None:
        """Begin the next detector if the last one has ended and the decision is there."""
        if self._outcome is None:
            return
        after = self._action if self._action > self._first else 0
        if (self._visit, after) not in self._decisions:
            return
        decision, decided_by = self._decisions.pop((self._visit, after))
        detector = int(decision.next_detector[self._outcome])
        self._outcome = None
        if detector == STOP:
            return
        self._detector = detector
        self._action += 1
        self._scans, self._scanned = [], []
        steps = plan(*self._wedges.parts(detector), self._width_m, self._wedges)
        rows = np.array([(STEP_KIND[step.kind], step.amount) for step in steps], np.float64)
        motion = Motion(self._visit, after, self._action, detector, rows)
        turn.say(motion, decided_by, *self._outcome_from)


def build(facts: Facts, _settings: Settings, _seed: int) -> Detectors:
    """The detectors of one run."""
    return Detectors(facts.corridor_width_m, Wedges(facts.wedges))
