"""What a page needs of a log, gathered in one pass over its messages."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bus import messages as m
from bus.wire import Sent
from logs.belief import FinalBelief, final_belief, fits
from logs.decisions import NS_PER_S
from logs.page.people import People
from logs.page.spans import Spans
from logs.page.story import Story
from logs.page.trail import Trail

Centimetres: TypeAlias = NDArray[np.uint16]


@dataclass(frozen=True)
class Ping:
    """One firing of the ring: ranges in centimetres, 0 where no echo came back."""

    at_ns: int
    ranges_cm: Centimetres


@dataclass(frozen=True)
class Believed:
    """One belief/map: the probability of every corridor, and how it compares with the truth."""

    at_ns: int
    corridors: NDArray[np.float64]
    compared: FinalBelief


class Whereabouts:
    """Where a robot that was lost may have been: places ahead with their probabilities, by time."""

    def __init__(self) -> None:
        self.each: list[tuple[int, list[tuple[int, float]]]] = []
        self._visit = -1

    def hear(self, sent: Sent) -> None:
        """Take in what the geographer says; of a robot that was never lost there is nothing."""
        match sent.message:
            case m.Registrations() as said:
                self._visit = said.visit
                likely = zip(said.places.tolist(), said.weights.tolist(), strict=True)
                self.each.append((sent.said_ns, sorted(likely, key=lambda row: -row[1])))
            case m.MapBelief() as said if self.each and said.visit != self._visit:
                columns = said.junctions.shape[1]
                self.each.append((sent.said_ns, [(said.y * columns + said.x, 1.0)]))


class Record:
    """All of a run that its page shows."""

    def __init__(self) -> None:
        self.building: m.TrueBuilding | None = None
        self.trail = Trail()
        self.people = People()
        self.spans = Spans()
        self.story = Story()
        self.pings: list[Ping] = []
        self.beliefs: list[Believed] = []
        self.goals: list[tuple[int, int]] = []
        self.whereabouts = Whereabouts()
        self.errands: list[m.TrueErrand] = []

    def hear(self, sent: Sent) -> None:
        """Take one message into account."""
        match sent.message:
            case m.Span() as span:
                self.spans.hear(span)
                return
            case m.TrueBuilding() as building:
                self.building = building
            case m.Sonar() as sonar:
                self.pings.append(Ping(sonar.fired_ns, _centimetres(sonar.ranges_m)))
            case m.MapBelief() as belief:
                self._believe(belief, sent.said_ns)
            case m.AskedPath() as asked:
                self._aim(asked, sent.said_ns)
            case m.TrueErrand() as errand:
                self.errands.append(errand)
        self.whereabouts.hear(sent)
        self.trail.hear(sent)
        self.people.hear(sent)
        self.story.hear(sent)

    def _aim(self, asked: m.AskedPath, at_ns: int) -> None:
        goal = int(asked.waypoints[0]) if len(asked.waypoints) else -1
        if not self.goals or self.goals[-1][1] != goal:
            self.goals.append((at_ns, goal))

    def _believe(self, belief: m.MapBelief, at_ns: int) -> None:
        if self.building is None or not fits(belief, self.building):
            return
        compared = final_belief(belief, self.building, at_ns / NS_PER_S)
        self.beliefs.append(Believed(at_ns, belief.corridors, compared))


def _centimetres(ranges_m: NDArray[np.float64]) -> Centimetres:
    known = np.nan_to_num(ranges_m, nan=0.0, posinf=0.0, neginf=0.0)
    return np.clip(np.rint(known * 100.0), 0, 65535).astype(np.uint16)
