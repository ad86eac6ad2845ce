"""The decider's messages: the question and the belief about the map in, the path out.

A fixed-time procedure (paper, section 5): when question and belief are both there, it reckons
how many hypotheses fit into the time left, and solves exactly that problem. With plans of least
expected cost it also says what a wrong type of the junction ahead would cost.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from bus.facts import Facts
from bus.grid import OPPOSITE
from bus.messages import AskedPath, JunctionStakes, MapBelief, PathDecision
from bus.turns import Handler, Turn
from bus.wire import MessageId
from modules.decider.decision import decide
from modules.decider.effort import LADDER, largest_that_fits
from modules.decider.methods import MethodInUse
from modules.decider.outlook import WORLDS, decide_by_outlook, errands_of, most_worlds
from modules.decider.rehearsal import rehearse
from modules.decider.settings import Settings
from modules.decider.situation import Decision, Situation
from modules.decider.stakes import Stakes, most_maps, regret_s, stakes_of, unsettled_at

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
        self.handlers: Mapping[str, Handler] = {
            "asked/path": self._ask,
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

    def _decide(self, turn: Turn) -> None:
        asked, belief = self._asked, self._belief
        if asked is None or belief is None or asked.visit != belief.visit:
            return
        self._asked = None
        situation = self._situation(asked, belief)
        if self._method is not None:
            found = self._method.decide(situation)
        elif self._settings.model == "paper" or not situation.goals:
            found = decide(situation, self._size(asked, belief, turn))
        else:
            found = self._by_outlook(situation, asked, belief, turn)
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

    def _situation(self, asked: AskedPath, belief: MapBelief) -> Situation:
        expected = asked.expected if self._settings.explores else np.zeros_like(asked.expected)
        return Situation(
            grid=self._grid,
            place=self._grid.intersection(belief.x, belief.y),
            came_from=OPPOSITE[belief.heading],
            waypoints=tuple(asked.waypoints.tolist()),
            tasks=asked.tasks,
            expected=expected,
            maps=belief.maps,
            weights=belief.weights,
            log_probability=belief.log_probability,
            corridor_probability=belief.corridors,
            corridor_s=belief.drive_s,
            sensing_s=self._settings.sensing_s,
        )

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
    return Decider(facts, settings, seed)
