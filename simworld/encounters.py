"""Who steps into the robot's way, and the decision that each of them asks for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from bus.coordinator import Handled
from bus.messages import AskedReaction, Message, TrueEncounter
from simworld.deadlines import Deadlines
from simworld.drive import CorridorDrive
from simworld.people import Person
from simworld.settings import PersonSettings


@dataclass(frozen=True)
class Coming:
    """Somebody who will step into the corridor, and into which one if that matters."""

    settings: PersonSettings
    corridor: int | None


class Encounters:
    """The people of a run, in the order in which they come.

    ``sight_m``: how far the ring hears. An encounter is asked about at the first ping at which
    the person is within it.
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
        self._asked: int | None = None
        self._asked_ns = 0
        self.collisions = 0

    def step_in(self, drive: CorridorDrive, corridor: int, now_ns: int) -> None:
        """Let the next person into the corridor if it is time and there is room."""
        if drive.person is not None:
            return
        for k, coming in enumerate(self._coming):
            enters = coming.settings.enters
            room_m = drive.length_m - drive.robot.s_m
            due = now_ns >= enters.at_s * 1e9 and room_m >= enters.ahead_m
            if due and coming.corridor in (None, corridor):
                del self._coming[k]
                self._met += 1
                drive.enter(_person(coming.settings, drive, now_ns))
                return

    def seen(self, drive: CorridorDrive, visit: int, now_ns: int) -> None:
        """A ping: ask for a decision if somebody has come within hearing."""
        if self._asked is not None or drive.walker is None:
            return
        if drive.walker.s_m - drive.robot.s_m > self._sight_m:
            return
        until_ns = drive.react_by_ns()
        if until_ns is None:
            return
        self._asked_ns = now_ns
        self._asked = self._deadlines.ask("reaction", visit, max(until_ns, now_ns))
        self._say(AskedReaction(self._asked, self._met, now_ns, max(until_ns, now_ns)))

    def decided(self, by: Handled | None, acts: int, fired_ns: int) -> None:
        """The reactor has said what to do about what it heard of a ping.

        What it says of a ping before the one that was asked about is about somebody else.
        """
        if self._asked is not None and fired_ns >= self._asked_ns:
            self._deadlines.decided(self._asked, by, acts, None)

    def over(self, drive: CorridorDrive) -> None:
        """Take note of an encounter that has ended, if one has."""
        if drive.met is None:
            return
        met, drive.met = drive.met, None
        self.collisions += met.collided
        self._say(TrueEncounter(self._met, met.collided, met.closest_m, met.delay_s))
        if self._asked is not None:
            self._deadlines.dropped(self._asked)
            self._asked = None


def _person(settings: PersonSettings, drive: CorridorDrive, now_ns: int) -> Person:
    return Person(
        enters_s=now_ns / 1e9,
        at_m=drive.robot.s_m + settings.enters.ahead_m,
        speed_m_s=settings.walks_m_s,
        offset_m=settings.offset_m,
        yields=settings.yields,
        appears=settings.appears,
    )
