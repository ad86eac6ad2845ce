"""The geographer's messages: likelihoods and corridors driven in, the belief about the map out.

When the robot leaves an LDP and the classifier has finished with it, the belief is updated
once: given that the corridor ahead will have been driven, it gives the prior of the junction at
the far end and the set of maps for the next decision. A robot that does not know where it is has
a belief for each place where it may be.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping

import numpy as np

from bus.facts import Facts
from bus.grid import LETTER
from bus.messages import (
    Arrival,
    AtErrand,
    Blocked,
    Departure,
    JunctionLikelihood,
    JunctionPrior,
    PoseBelief,
)
from bus.turns import Handler, Turn
from bus.wire import MessageId
from modules.geographer.connected_maps import ConnectedMaps
from modules.geographer.map_belief import MapBelief as Exact
from modules.geographer.mixture import ahead, map_belief, registrations, told, weighed
from modules.geographer.registration import Registration, registrations_of, those_left
from modules.geographer.sampling import rehearse, weighted_maps
from modules.geographer.settings import Settings


class Geographer:
    """Keeps the record of what was observed, and where the robot is or may be on the grid."""

    def __init__(self, facts: Facts, settings: Settings, seed: int) -> None:
        self._settings = settings
        self._maps = ConnectedMaps(facts.columns, facts.rows)
        self._registrations = registrations_of(facts)
        self._rng = np.random.default_rng([seed, 2])
        self._heading = facts.heading
        self._visit = 0
        self._classifying = False
        self._leaving: Departure | None = None
        self._handed_over = False
        self._made_from: dict[str, MessageId] = {}  # the last message that went in, by topic
        self.handlers: Mapping[str, Handler] = {
            "percept/departure": self._departed,
            "percept/arrival": self._arrived,
            "percept/blocked": self._blocked,
            "percept/errand": self._at_errand,
            "belief/pose": self._posed,
            "likelihood/junction": self._classified,
        }

    def _posed(self, _said: PoseBelief, turn: Turn) -> None:
        turn.work("note", 1)

    def _departed(self, said: Departure, turn: Turn) -> None:
        turn.work("note", 1)
        self._leaving = said
        self._made_from["percept/departure"] = turn.heard
        self._look_ahead(turn)

    def _classified(self, said: JunctionLikelihood, turn: Turn) -> None:
        turn.work("note", len(said.likelihood))
        if said.finished:
            self._registrations = tuple(r.classified(said.likelihood) for r in self._registrations)
            self._made_from["likelihood/junction"] = turn.heard
            self._classifying = False
            self._look_ahead(turn)
            self._look_again(turn)

    def _arrived(self, said: Arrival, turn: Turn) -> None:
        turn.work("note", 1)
        self._made_from["percept/arrival"] = turn.heard
        if said.visit > 0:  # the first drive begins in the middle of a corridor
            self._registrations = tuple(
                r.drove(said.heading, said.drive_s) for r in self._registrations
            )
        self._registrations = tuple(r.arrived() for r in self._registrations)
        self._classifying = True

    def _blocked(self, said: Blocked, turn: Turn) -> None:
        self._registrations = tuple(r.blocked(said.heading) for r in self._registrations)
        self._visit = said.visit
        self._say_belief(turn)

    def _at_errand(self, said: AtErrand, turn: Turn) -> None:
        """Somebody waits at the errand's end and nowhere else."""
        turn.work("note", 1)
        self._made_from["percept/errand"] = turn.heard
        fit = [r for r in self._registrations if (r.place == said.waypoint) == said.here]
        who = "somebody" if said.here else "nobody"
        seen = f"{who} who expects the robot at intersection {said.waypoint}"
        self._registrations = those_left(fit, self._registrations, seen)
        if said.here:
            self._visit, self._handed_over = said.visit, True
            self._look_again(turn)

    def _look_ahead(self, turn: Turn) -> None:
        """Update once the robot is on its way and the LDP it left is classified."""
        said = self._leaving
        if said is None or self._classifying:
            return
        self._leaving = None
        self._visit, self._heading = said.visit, said.heading
        found = [r.departed(said.heading, first=said.visit == 0) for r in self._registrations]
        seen = f"a corridor {LETTER[said.heading]}"
        self._registrations = those_left(found, self._registrations, seen)
        self._say_belief(turn)

    def _look_again(self, turn: Turn) -> None:
        """Update where an errand was seen to, once the LDP is classified."""
        if self._handed_over and not self._classifying:
            self._handed_over = False
            self._say_belief(turn)

    def _believe(self, at: Registration) -> Exact:
        record = at.record
        return self._maps.posterior(
            record.junctions, self._settings.corridor_odds, record.corridors
        )

    def _say_belief(self, turn: Turn) -> None:
        every = weighed(self._registrations, self._believe)
        believed = told(every)
        untold = len(self._registrations) - len(believed)
        self._registrations = tuple(one.at for one in every)
        maps = [
            weighted_maps(one.belief, one.at.ahead, self._settings.maps_per_type, self._rng)
            for one in believed
        ]
        for cells in (*(some.cells for some in maps), *[0] * untold):
            turn.work("belief", self._maps.update_cells + cells)
        made_from = self._made_from.values()
        belief = map_belief(self._visit, self._heading, believed, maps)
        turn.say(
            JunctionPrior(self._visit, belief.x, belief.y, self._heading, ahead(believed)),
            *made_from,
        )
        if len(believed) > 1:  # before the map: who hears that decides
            turn.say(registrations(self._visit, self._heading, believed, maps), *made_from)
        turn.say(belief, *made_from)


def build(facts: Facts, settings: Settings, seed: int) -> Geographer:
    """The geographer of one run. Raises GridTooWideError for a grid beyond it."""
    rehearse(ConnectedMaps(facts.columns, facts.rows, _show_progress))
    return Geographer(facts, settings, seed)


def _show_progress(done: int, total: int) -> None:
    """A line that counts while tables are built, if somebody looks on."""
    if sys.stderr.isatty():
        end = "\n" if done == total else ""
        print(f"\rbuilding tables of maps: {done}/{total}", end=end, file=sys.stderr, flush=True)
