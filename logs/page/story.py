"""What a decision was, in words that need no knowledge of the messages."""

from __future__ import annotations

import math
from bisect import bisect_right
from dataclasses import dataclass
from typing import TypeAlias

from bus import messages as m
from bus.grid import EAST, JUNCTION_TYPES, NORTH, SOUTH, WEST, Grid, type_name
from bus.messages import LedgerEntry
from bus.wire import Sent
from logs.decisions import NEVER, NS_PER_S, cause_of, on_time

NAME = {NORTH: "north", EAST: "east", SOUTH: "south", WEST: "west"}

DecisionId: TypeAlias = tuple[str, int]
"""Kind and number of a decision."""


@dataclass(frozen=True)
class Told:
    """What was decided, in words, and when its outcome was seen."""

    words: str
    at_ns: int


class Story:
    """Remembers what was decided and what came of it, and tells it when the run is over."""

    def __init__(self) -> None:
        self._building: m.TrueBuilding | None = None
        self._said: dict[DecisionId, Sent] = {}
        self._lost: dict[int, m.RegistrationDecision] = {}  # by the number of the path decision
        self._reactions: list[Sent] = []
        self._left: dict[int, tuple[int, int]] = {}
        self._blocked: dict[int, tuple[int, int]] = {}
        self._place: dict[int, int] = {}
        self._visit = 0
        self._reading: dict[int, m.Reading] = {}
        self._after: dict[tuple[int, int], int] = {}

    def hear(self, sent: Sent) -> None:
        """Take one message into account; those of no use are passed over."""
        match sent.message:
            case m.PathDecision(decision=decision):
                self._said.setdefault(("path", decision), sent)
            case m.SensingDecision(decision=decision):
                self._said.setdefault(("sensing", decision), sent)
            case m.RegistrationDecision(decision=decision) as lost:
                self._lost[decision] = lost
            case m.ReactionDecision():
                self._reactions.append(sent)
            case m.Reading(action=action) as reading:
                self._reading[action] = reading
            case m.Motion(visit=visit, after=after, action=action):
                self._after[visit, after] = action
            case _:
                self._hear_body(sent)

    def _hear_body(self, sent: Sent) -> None:
        match sent.message:
            case m.TrueBuilding() as building:
                self._building = building
            case m.Departure(visit=visit, heading=heading):
                self._left[visit] = (heading, sent.said_ns)
            case m.Blocked(visit=visit, heading=heading):
                self._blocked[visit] = (heading, sent.said_ns)
                if visit - 1 in self._place:
                    self._place[visit] = self._place[visit - 1]
            case m.AtErrand(visit=visit, here=True) if visit - 1 in self._place:
                self._place[visit] = self._place[visit - 1]
            case m.Arrival(visit=visit):
                self._visit = visit
            case m.TruePose(place=place):
                self._place[self._visit] = place

    def decided(self, entry: LedgerEntry) -> Sent | None:
        """The message that settled a ledger entry, if there is one."""
        if entry.decided_ns == NEVER:
            return None
        if entry.kind != "reaction":
            return self._said.get((entry.kind, entry.decision))
        upto = bisect_right(self._reactions, entry.decided_ns, key=lambda sent: sent.said_ns)
        last = self._reactions[upto - 1] if upto else None
        return last if last is not None and last.said_ns >= entry.asked_ns else None

    def tell(self, entry: LedgerEntry) -> Told:
        """What the decision of a ledger entry was."""
        settled_ns = entry.until_ns if entry.decided_ns == NEVER else entry.decided_ns
        sent = self.decided(entry)
        match sent.message if sent else None:
            case m.PathDecision() as path:
                return self._path(path, settled_ns)
            case m.SensingDecision() as sensing:
                return Told(self._sensing(sensing), settled_ns)
            case m.ReactionDecision() as reaction:
                return Told(_reaction(reaction), settled_ns)
            case _:
                return Told("never decided", settled_ns)

    def _path(self, said: m.PathDecision, settled_ns: int) -> Told:
        if said.visit + 1 in self._blocked:
            heading, found_ns = self._blocked[said.visit + 1]
            return Told(f"tried the way {NAME[heading]} and found a wall", found_ns)
        heading, left_ns = self._left.get(said.visit + 1, (0, settled_ns))
        junction_type = self._junction_type(said, heading)
        if junction_type is None:
            return Told("a way for every junction type; none was taken", settled_ns)
        known_s = float(said.known_s[junction_type])
        unknown_s = float(said.unknown_s[junction_type])
        where = f"{NAME[heading]} at a {type_name(junction_type)} junction"
        if said.decision in self._lost:
            return Told(self._unsure(self._lost[said.decision], junction_type, where), left_ns)
        if said.explores[junction_type]:
            return Told(f"took the unknown way {where}: {_against(unknown_s, known_s)}", left_ns)
        return Told(f"took the known way {where}: {_against(known_s, unknown_s)}", left_ns)

    def _unsure(self, said: m.RegistrationDecision, junction_type: int, where: str) -> str:
        """What a robot did that might have been in several places, and what else it would cost."""
        now_s, look_s = float(said.now_s[junction_type]), float(said.look_s[junction_type])
        at = self._named(int(said.acts_at[junction_type]))
        if said.detour[junction_type]:
            at = f"{self._named(int(said.looks_at[junction_type]))}, if this is {at}"
            return f"went {where} to look at {at}: {_against(look_s, now_s)}"
        return f"went {where}, as if this were {at}: {_against(now_s, look_s)}"

    def _named(self, place: int) -> str:
        """An intersection as x,y."""
        if self._building is None or place < 0:
            return "unknown"
        y, x = divmod(place, len(self._building.columns_m))
        return f"{x},{y}"

    def _junction_type(self, said: m.PathDecision, heading: int) -> int | None:
        """The type that was met: the true one, or else the first that leads the way taken."""
        if heading == 0:
            return None
        place = self._place.get(said.visit)
        if self._building is not None and place is not None:
            grid = Grid(len(self._building.columns_m), len(self._building.rows_m))
            true_type = int(grid.junction_types(self._building.corridors[None, :])[0, place])
            if said.direction[true_type] == heading:
                return true_type
        fitting = [t for t in range(JUNCTION_TYPES) if said.direction[t] == heading]
        return fitting[0] if fitting else None

    def _sensing(self, said: m.SensingDecision) -> str:
        reading = self._reading.get(said.action)
        if said.action and reading is None:
            return "what to test next, for every outcome; none came"
        outcome = reading.evidence if said.action and reading is not None else 0
        if not 0 <= outcome < len(said.next_detector):
            return f"nothing for outcome {outcome}"
        if said.next_detector[outcome] < 0:
            concluded = type_name(int(said.concluded[outcome]))
            return f"enough is known: a {concluded} junction"
        tested = self._reading.get(self._after.get((said.visit, said.action), -1))
        what = f"detector {said.next_detector[outcome]}"
        if tested is not None:
            what = f"feature {tested.feature} in wedge {tested.wedge}"
        return f"tested {what}, worth {said.worth_s[outcome]:,.0f} s"


def _against(chosen_s: float, other_s: float) -> str:
    other = f"{other_s:,.0f} s" if math.isfinite(other_s) else "no other"
    chosen = f"{chosen_s:,.0f} s" if math.isfinite(chosen_s) else "no estimate"
    return f"{chosen} against {other}"


def _reaction(said: m.ReactionDecision) -> str:
    return f"{said.act}: somebody approaches with probability {said.approaching:.2f}"


def outcome(entry: LedgerEntry) -> str:
    """Whether a decision came in time, in words."""
    if entry.decided_ns == NEVER:
        words = f"never came: {cause_of(entry)}"
    elif on_time(entry):
        return f"{entry.slack_ns / NS_PER_S:,.1f} s to spare"
    else:
        words = f"late by {-entry.slack_ns / NS_PER_S:,.1f} s: {cause_of(entry)}"
    return f"{words}; {entry.instead}" if entry.instead else words
