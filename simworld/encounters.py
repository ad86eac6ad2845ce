"""Who steps into the robot's way, and the decision that each of them asks for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from bus.coordinator import Handled
from bus.messages import AskedReaction, Message, TrueEncounter
from simworld.deadlines import Deadlines
from simworld.door import Door
from simworld.drive import CorridorDrive
from simworld.keeping import BUMPER_M
from simworld.meetings import Meeting
from simworld.people import Person
from simworld.settings import DoorSettings, PersonSettings


@dataclass(frozen=True)
class Coming:
    """Something that will be in the robot's way, and in which corridor if that matters."""

    settings: PersonSettings | DoorSettings
    corridor: int | None


class Encounters:
    """The encounters of a run, in the order in which they come.

    ``sight_m``: how far the ring hears. An encounter is asked about at the first ping at which
    it is within that.
    """

    def __init__(
        self,
        people: tuple[Coming, ...],
        sight_m: float,
        deadlines: Deadlines,
        say: Callable[[Message], None],
    ) -> None:
        self._coming = list(people)
        self._sight_m = sight_m
        self._deadlines = deadlines
        self._say = say
        self._met = 0
        self._together_s = -1.0  # when those who are there were to come
        self._asked: dict[int, tuple[int, int]] = {}  # by encounter: decision, since when (ns)
        self.collisions = 0

    def step_in(self, drive: CorridorDrive, corridor: int, now_ns: int) -> None:
        """Let the next into the corridor if it is time and there is room to pass each other.

        Those who come at one moment come together; others wait until nobody is there.
        """
        for coming in tuple(self._coming):
            enters = coming.settings.enters
            room_m = drive.length_m - drive.robot.s_m
            due = now_ns >= enters.at_s * 1e9 and coming.corridor in (None, corridor)
            free = not drive.meetings or enters.at_s == self._together_s
            if due and free and room_m >= enters.ahead_m and drive.two_can_pass(enters.ahead_m):
                self._coming.remove(coming)
                self._together_s = enters.at_s
                self._met += 1
                drive.enter(self._met, _entering(coming.settings, drive, now_ns))

    def seen(self, drive: CorridorDrive, visit: int, now_ns: int) -> None:
        """A ping: ask for a decision about whoever has come within hearing."""
        for meeting in drive.meetings:
            if meeting.number not in self._asked and meeting.ahead_m(drive.robot) <= self._sight_m:
                self._ask(drive, meeting, visit, now_ns)

    def _ask(self, drive: CorridorDrive, meeting: Meeting, visit: int, now_ns: int) -> None:
        until_ns = drive.react_by_ns(meeting)
        if until_ns is None:
            return
        until_ns = max(until_ns, now_ns)
        decision = self._deadlines.ask("reaction", visit, until_ns)
        self._asked[meeting.number] = decision, now_ns
        self._say(AskedReaction(decision, meeting.number, now_ns, until_ns))

    def decided(self, by: Handled | None, acts: int, fired_ns: int) -> None:
        """The reactor has said what to do about what it heard of a ping.

        What it says of a ping before the one that was asked about is about somebody else.
        """
        for decision, asked_ns in self._asked.values():
            if fired_ns >= asked_ns:
                self._deadlines.decided(decision, by, acts, None)

    def over(self, drive: CorridorDrive) -> None:
        """Take note of the encounters that have ended."""
        ended, drive.met = drive.met, []
        for met in ended:
            self.collisions += met.collided
            self._say(TrueEncounter(met.number, met.collided, met.closest_m, met.delay_s))
            decision, _ = self._asked.pop(met.number, (None, 0))
            if decision is not None:
                self._deadlines.dropped(decision)


def _entering(
    settings: PersonSettings | DoorSettings, drive: CorridorDrive, now_ns: int
) -> Person | Door:
    at_m = drive.robot.s_m + settings.enters.ahead_m
    if isinstance(settings, DoorSettings):
        left_m, right_m, _ = drive.room(at_m)
        return Door(
            begins_s=now_ns / 1e9,
            at_m=at_m,
            side=settings.side,
            wall_m=BUMPER_M + (left_m if settings.side == "left" else right_m),
            leaf_m=settings.leaf_m,
            stays_s=settings.stays_s,
        )
    return Person(
        enters_s=now_ns / 1e9,
        at_m=at_m,
        speed_m_s=settings.walks_m_s,
        offset_m=settings.offset_m,
        yields=settings.yields,
        radius_m=settings.radius_m,
        appears=settings.appears,
    )
