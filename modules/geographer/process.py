"""The geographer's messages: likelihoods and corridors driven in, the belief about the map out.

When the robot leaves an LDP and the classifier has finished with it, the belief is updated
once: given that the corridor ahead will have been driven, it gives the prior of the junction at
the far end and the set of maps for the next decision.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping

import numpy as np

from bus.facts import Facts
from bus.grid import OPPOSITE
from bus.messages import (
    Arrival,
    Blocked,
    Departure,
    JunctionLikelihood,
    JunctionPrior,
    MapBelief,
    PoseBelief,
)
from bus.turns import Handler, Turn
from bus.wire import MessageId
from modules.geographer.connected_maps import ConnectedMaps
from modules.geographer.record import neighbour, nothing
from modules.geographer.roads import unknown_roads
from modules.geographer.sampling import rehearse, weighted_maps
from modules.geographer.settings import Settings


class Geographer:
    """Keeps the record of what was observed and where the robot is on the grid."""

    def __init__(self, facts: Facts, settings: Settings, seed: int) -> None:
        self._settings = settings
        self._grid = facts.grid
        self._maps = ConnectedMaps(facts.columns, facts.rows)
        self._record = nothing(self._grid)
        self._roads = unknown_roads(self._grid)
        self._rng = np.random.default_rng([seed, 2])
        self._place = facts.start
        self._ahead = facts.start
        self._heading = facts.heading
        self._visit = 0
        self._classifying = False
        self._leaving: Departure | None = None
        self._made_from: dict[str, MessageId] = {}  # the last message that went in, by topic
        self.handlers: Mapping[str, Handler] = {
            "percept/departure": self._departed,
            "percept/arrival": self._arrived,
            "percept/blocked": self._blocked,
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
            self._record = self._record.with_junction(self._place, said.likelihood)
            self._made_from["likelihood/junction"] = turn.heard
            self._classifying = False
            self._look_ahead(turn)

    def _arrived(self, said: Arrival, turn: Turn) -> None:
        turn.work("note", 1)
        self._made_from["percept/arrival"] = turn.heard
        if said.visit > 0:  # the first drive begins in the middle of a corridor
            corridor = self._grid.corridor(*self._grid.place(self._place), said.heading)
            self._roads = self._roads.driven(corridor, said.drive_s)
        self._place = self._ahead
        self._classifying = True

    def _blocked(self, said: Blocked, turn: Turn) -> None:
        corridor = self._grid.corridor(*self._grid.place(self._place), said.heading)
        if corridor >= 0:
            self._record = self._record.with_corridor(corridor, exists=False)
        self._visit = said.visit
        self._say_belief(turn)

    def _look_ahead(self, turn: Turn) -> None:
        """Update once the robot is on its way and the LDP it left is classified."""
        said = self._leaving
        if said is None or self._classifying:
            return
        self._leaving = None
        self._visit, self._heading = said.visit, said.heading
        if said.visit > 0:
            self._ahead = neighbour(self._grid, self._place, said.heading)
        behind = self._grid.corridor(*self._grid.place(self._ahead), OPPOSITE[said.heading])
        self._record = self._record.with_corridor(behind, exists=True)
        self._say_belief(turn)

    def _say_belief(self, turn: Turn) -> None:
        odds = self._settings.corridor_odds
        record = self._record
        belief = self._maps.posterior(record.junctions, odds, record.corridors)
        maps = weighted_maps(belief, self._ahead, self._settings.maps_per_type, self._rng)
        turn.work("belief", self._maps.update_cells + maps.cells)
        x, y = self._grid.place(self._ahead)
        made_from = self._made_from.values()
        ahead = belief.junctions[y, x].copy()
        turn.say(JunctionPrior(self._visit, x, y, self._heading, ahead), *made_from)
        turn.say(
            MapBelief(
                self._visit,
                x,
                y,
                self._heading,
                belief.junctions,
                belief.corridors,
                self._roads.corridor_s(),
                belief.log_evidence,
                belief.entropy,
                maps.maps,
                maps.weights,
                maps.log_probability,
            ),
            *made_from,
        )


def build(facts: Facts, settings: Settings, seed: int) -> Geographer:
    """The geographer of one run. Raises GridTooWideError for a grid beyond it."""
    rehearse(ConnectedMaps(facts.columns, facts.rows, _show_progress))
    return Geographer(facts, settings, seed)


def _show_progress(done: int, total: int) -> None:
    """A line that counts while tables are built, if somebody looks on."""
    if sys.stderr.isatty():
        end = "\n" if done == total else ""
        print(f"\rbuilding tables of maps: {done}/{total}", end=end, file=sys.stderr, flush=True)
