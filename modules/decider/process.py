"""The decider's messages: the question and the belief about the map in, the path out.

A fixed-time procedure (paper, section 5): when question and belief are both there, it reckons
how many hypotheses fit into the time left, and solves exactly that problem. With plans of least
expected cost it also says what a wrong type of the junction ahead would cost.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import msgspec
import numpy as np

from bus.facts import Facts
from bus.messages import (
    AskedErrand,
    AskedPath,
    JunctionStakes,
    MapBelief,
    PathDecision,
    RegistrationDecision,
    Registrations,
)
from bus.turns import Handler, Turn
from bus.wire import MessageId
from modules.decider.decision import decide
from modules.decider.effort import LADDER, largest_that_fits
from modules.decider.methods import MethodInUse
from modules.decider.outlook import WORLDS, decide_by_outlook, errands_of, most_worlds
from modules.decider.rehearsal import rehearse, rehearse_lost
from modules.decider.settings import Settings
from modules.decider.situation import Decision, Situation
from modules.decider.stakes import Stakes, most_maps, regret_s, stakes_of, unsettled_at
from modules.decider.told import situation_of, whereabouts_of
from modules.decider.whereabouts import Whereabouts, decide_whereabouts
from modules.decider.whereabouts import most_maps as most_maps_each

POSSIBLE = 1e-9
"""Junction types less probable than this are not counted in the size of the problem."""

STAKES_SHARE = 8
"""One part in so many of the time left may go into saying what a wrong type would cost."""


class Decider:
    """Waits for the question and the belief of the same visit, then decides."""

    def __init__(self, facts: Facts, settings: Settings, seed: int) -> None:
        self._grid = facts.grid
        self._settings = settings
        self._method = (
            None
            if settings.method == "expected value"
            else MethodInUse(settings.method, np.random.default_rng(seed))
        )
        self._asked: AskedPath | None = None
        self._belief: MapBelief | None = None
        self._been: frozenset[int] = frozenset()
        self._made_from: dict[str, MessageId] = {}  # the question and the belief
        self._registrations: Registrations | None = None
        self._due: AskedErrand | None = None
        self.handlers: Mapping[str, Handler] = {
            "asked/errand": self._ask_errand,
            "asked/path": self._ask,
            "belief/registrations": self._may_be,
            "belief/map": self._believe,
        }

    def _ask(self, said: AskedPath, turn: Turn) -> None:
        turn.work("note", 1)
        self._asked = said
        self._made_from["asked"] = turn.heard
        self._decide(turn)

    def _believe(self, said: MapBelief, turn: Turn) -> None:
        turn.work("note", 1)
        self._belief = said
        self._made_from["belief"] = turn.heard
        self._decide(turn)

    def _ask_errand(self, said: AskedErrand, turn: Turn) -> None:
        turn.work("note", 1)
        self._due = said

    def _may_be(self, said: Registrations, turn: Turn) -> None:
        turn.work("note", 1)
        self._registrations = said
        self._made_from["registrations"] = turn.heard

    def _decide(self, turn: Turn) -> None:
        asked, belief = self._asked, self._belief
        if asked is None or belief is None or asked.visit != belief.visit:
            return
        self._asked = None
        lost = whereabouts_of(self._grid, self._settings, asked, self._registrations, self._due)
        if lost is not None and len(lost.situations) > 1:
            found = self._by_whereabouts(lost, asked, turn)
        else:
            known = situation_of(self._grid, self._settings, asked, belief)
            situation = known if lost is None else lost.situations[0]
            found = self._registered(situation, asked, belief, turn)
        turn.work("path", found.cells)
        turn.say(
            PathDecision(
                asked.decision,
                asked.visit,
                found.direction,
                found.known_s,
                found.unknown_s,
                found.explores.astype(np.uint8),
                found.hypotheses,
            ),
            *self._made_from.values(),
        )

    def _by_whereabouts(self, lost: Whereabouts, asked: AskedPath, turn: Turn) -> Decision:
        """Decide whether to look first where the robot is, and say why."""
        types = int((lost.weights @ lost.ahead > POSSIBLE).sum())
        cells = turn.costs.cells_within("path", turn.left_ns(asked.until_ns))
        maps = most_maps_each(len(lost.situations), types, cells)
        choice = decide_whereabouts(lost, maps, self._settings.unsure)
        found = choice.decision
        turn.say(
            RegistrationDecision(
                asked.decision,
                asked.visit,
                found.known_s,
                found.unknown_s,
                found.explores.astype(np.uint8),
                choice.acts_at,
                choice.looks_at,
            ),
            *self._made_from.values(),
        )
        return found

    def _registered(
        self, situation: Situation, asked: AskedPath, belief: MapBelief, turn: Turn
    ) -> Decision:
        """Decide where the robot knows its place, or which of several is the case."""
        if self._method is not None:
            return self._method.decide(situation)
        if self._settings.model == "paper" or not situation.goals:
            return decide(situation, self._size(asked, belief, turn))
        return self._by_outlook(situation, asked, belief, turn)

    def _by_outlook(
        self, situation: Situation, asked: AskedPath, belief: MapBelief, turn: Turn
    ) -> Decision:
        """Decide by least expected cost, and say what a wrong type at v would cost."""
        stakes = self._stakes(situation, asked, belief, turn)
        spent = stakes.cells if stakes is not None else 0
        outlook = decide_by_outlook(situation, self._worlds(situation, asked, belief, turn, spent))
        if stakes is not None:
            regret = regret_s(situation, stakes, outlook)
            turn.say(JunctionStakes(asked.visit, regret), *self._made_from.values())
        return replace(outlook.decision, cells=outlook.decision.cells + spent)

    def _stakes(
        self, situation: Situation, asked: AskedPath, belief: MapBelief, turn: Turn
    ) -> Stakes | None:
        """Where there is time to reckon them, and it does not come back to a place for its type."""
        if situation.place in self._been and unsettled_at(situation):
            return None
        self._been = self._been | {situation.place}
        cells = turn.costs.cells_within("path", turn.left_ns(asked.until_ns) // STAKES_SHARE)
        maps = most_maps(_types(belief), len(situation.tasks), cells)
        if maps is None:
            return None
        return stakes_of(situation, maps)

    def _size(self, asked: AskedPath, belief: MapBelief, turn: Turn) -> int:
        """Hypotheses per junction type: as many as fit into the time left, or as many as set."""
        if self._settings.hypotheses != "as many as fit":
            return self._settings.hypotheses
        types = _types(belief)
        cells = turn.costs.cells_within("path", turn.left_ns(asked.until_ns))
        legs = len(asked.waypoints)
        # Where nothing fits it will be late whatever it does: the smallest is late by least.
        return largest_that_fits(self._grid, len(asked.tasks), types, cells, legs) or LADDER[0]

    def _worlds(
        self, situation: Situation, asked: AskedPath, belief: MapBelief, turn: Turn, spent: int
    ) -> int:
        """The same for plans of least expected cost, some cells being spent already."""
        if self._settings.hypotheses != "as many as fit":
            return self._settings.hypotheses
        cells = turn.costs.cells_within("path", turn.left_ns(asked.until_ns)) - spent
        legs = len(errands_of(situation).goals)
        return most_worlds(self._grid, _types(belief), legs, cells) or WORLDS[0]


def _types(belief: MapBelief) -> int:
    """How many junction types are possible at the far end."""
    return int((belief.junctions[belief.y, belief.x] > POSSIBLE).sum())


def build(facts: Facts, settings: Settings, seed: int) -> Decider:
    """The decider of one run."""
    rehearse(facts.grid)
    if facts.recall is not msgspec.UNSET:
        rehearse_lost(facts.grid)
    return Decider(facts, settings, seed)
