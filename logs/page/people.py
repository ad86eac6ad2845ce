"""Whom the robot met, and where the echoes ahead placed them.

A person's true position is not in the log. Until the meeting is over, the shortest echo of the
three transducers that look ahead is taken for the person, as long as it comes nearer.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from bus.messages import AskedReaction, Sonar, TrueEncounter
from bus.wire import Sent

AWAY_M = 1.0
"""An echo that is so much farther than the one before is no longer the person's."""


@dataclass
class Meeting:
    """One encounter; ``over_ns`` is None until it is over.

    ``seen`` has (time in ns, range in metres, transducer) of each echo taken for the person.
    """

    encounter: int
    from_ns: int
    over_ns: int | None = None
    collided: bool = False
    closest_m: float = 0.0
    delay_s: float = 0.0
    seen: list[tuple[int, float, int]] = field(default_factory=list)


class People:
    """The meetings of a run."""

    def __init__(self) -> None:
        self.meetings: list[Meeting] = []

    def hear(self, sent: Sent) -> None:
        """Take one message into account; those of no use are passed over."""
        match sent.message:
            case AskedReaction(encounter=encounter):
                self.meetings.append(Meeting(encounter, sent.said_ns))
            case TrueEncounter() as over:
                self._over(over, sent.said_ns)
            case Sonar(action=0) as sonar if self.meetings and self.meetings[-1].over_ns is None:
                _look(self.meetings[-1], sonar)

    def _over(self, said: TrueEncounter, at_ns: int) -> None:
        if not self.meetings or self.meetings[-1].encounter != said.encounter:
            self.meetings.append(Meeting(said.encounter, at_ns))  # met without being asked about
        last = self.meetings[-1]
        last.over_ns, last.collided = at_ns, said.collided
        last.closest_m, last.delay_s = said.closest_m, said.delay_s


def _look(meeting: Meeting, sonar: Sonar) -> None:
    number = len(sonar.ranges_m)
    ahead = list(dict.fromkeys((0, 1 % number, number - 1))) if number else []
    heard = [(float(sonar.ranges_m[k]), k) for k in ahead if not np.isnan(sonar.ranges_m[k])]
    if not heard:
        return
    range_m, transducer = min(heard)
    if not meeting.seen or range_m <= meeting.seen[-1][1] + AWAY_M:
        meeting.seen.append((sonar.fired_ns, range_m, transducer))
