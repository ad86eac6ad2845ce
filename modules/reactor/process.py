"""The reactor's messages: ranges in, attention and reactions out.

Nobody tells it that something comes: it must notice by itself.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping

from bus.facts import Facts
from bus.messages import Attention, Departure, Ranges, ReactionDecision
from bus.turns import Handler, Turn
from bus.wire import MessageId
from modules.reactor.cone import Floats, cones_ahead
from modules.reactor.diagram import Settings as Reacting
from modules.reactor.meeting import ACTS, LEFT, RIGHT, Body
from modules.reactor.openness import sectors_of
from modules.reactor.react import Reaction, react
from modules.reactor.room import WIDE, Room
from modules.reactor.settings import Settings
from modules.reactor.sides import PINGS, beside
from modules.reactor.sight import hides
from modules.reactor.tables import compiled
from modules.reactor.track import Scan, Tracker, updated

WATCHES_S = 2.0
"""How long the ring fires faster after who comes might have been hidden, two pings running."""

NARROWER_M = 0.1
"""Room that is less by this than when it was told to go aside is worth another word."""


class Reactor:
    """Keeps what it believes to be ahead, and what it last told the body to do.

    It says an act when it differs from the one that is being done, and once for every thing
    that certainly approaches, even where going on is best.
    """

    def __init__(self, facts: Facts, settings: Settings) -> None:
        self._attention_s = settings.attention_s
        self._diagram = compiled(Reacting(body=Body(speed_m_s=facts.speed_m_s)))
        self._cones = cones_ahead(facts.ring)
        self._sectors = sectors_of(facts.ring)
        self._tracker = Tracker(cones=self._cones)
        self._act = "continue"
        self._said_s = -math.inf
        self._hidden = False
        self._hidden_s = -math.inf
        self._attentive = False
        self._lateral_m = 0.0
        self._pings: deque[Floats] = deque(maxlen=PINGS)
        self._aside_m = WIDE.left_m
        self._scan_before: tuple[MessageId, ...] = ()  # the last that went into the track
        self.handlers: Mapping[str, Handler] = {
            "percept/departure": self._departed,
            "belief/ranges": self._heard,
        }

    def _departed(self, _said: Departure, turn: Turn) -> None:
        turn.work("note", 1)
        self._tracker = Tracker(cones=self._cones)
        self._scan_before = ()
        self._pings.clear()
        self._act, self._lateral_m = "continue", 0.0
        self._said_s = self._hidden_s = -math.inf
        self._attend(turn, False)

    def _heard(self, said: Ranges, turn: Turn) -> None:
        time_s = said.fired_ns / 1e9
        self._lateral_m = self._moved_aside_m(time_s)
        scan = Scan(time_s, said.mean_m, said.sigma_m, said.speed_m_s, self._lateral_m)
        self._tracker = updated(self._tracker, scan)
        turn.work("track", self._tracker.cells)
        self._pings.append(self._sectors.free_m(said.mean_m))
        body = self._diagram.settings.body
        sides = beside(tuple(self._pings), self._sectors, self._lateral_m, body)
        reaction = react(self._tracker, self._act, self._diagram, sides)
        self._attend(turn, self._is_on_its_guard(reaction, scan))
        if reaction is not None:
            turn.work("reaction", reaction.cells)
            if reaction.due and self._is_worth_saying(reaction, sides.room):
                self._say(reaction, sides.room.for_act(reaction.act), said.fired_ns, turn)
        self._scan_before = (turn.heard,)

    def _is_on_its_guard(self, reaction: Reaction | None, scan: Scan) -> bool:
        """Whether the ring should fire faster: another act is near, or who comes may be hidden."""
        waits = reaction is not None and reaction.act != self._act
        hidden = hides(scan.echoes(self._cones))
        if hidden and self._hidden:
            self._hidden_s = scan.time_s
        self._hidden = hidden
        watches = scan.time_s - self._hidden_s < WATCHES_S
        return waits or watches or self._tracker.wants_attention or self._act != "continue"

    def _is_worth_saying(self, reaction: Reaction, room: Room) -> bool:
        """Whether it would do something else, or nearer the middle for want of room.

        Or something certainly approaches that was not there when it last spoke.
        """
        narrower = (
            ACTS.index(reaction.act) in LEFT + RIGHT
            and room.for_act(reaction.act) < self._aside_m - NARROWER_M
        )
        return reaction.act != self._act or narrower or reaction.newest_s > self._said_s

    def _moved_aside_m(self, time_s: float) -> float:
        """How far left of the centre line the last act has brought the robot by now."""
        before_s = self._tracker.time_s
        if before_s is None:
            return 0.0
        body = self._diagram.settings.body
        return body.across_m(self._act, self._lateral_m, time_s - before_s, self._aside_m)

    def _attend(self, turn: Turn, attentive: bool) -> None:
        if attentive != self._attentive:
            self._attentive = attentive
            turn.say(Attention(self._attention_s if attentive else 0.0))

    def _say(self, reaction: Reaction, aside_m: float, fired_ns: int, turn: Turn) -> None:
        self._act, self._aside_m = reaction.act, aside_m
        self._said_s = fired_ns / 1e9
        turn.say(
            ReactionDecision(
                reaction.act,
                reaction.expected_utility,
                reaction.approaching,
                fired_ns,
                aside_m,
            ),
            *self._scan_before,
        )


def build(facts: Facts, settings: Settings, _seed: int) -> Reactor:
    """The reactor of one run. Raises RingError for a ring that does not see ahead."""
    return Reactor(facts, settings)
