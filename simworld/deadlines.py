"""Deadlines as events, and the ledger of what became of each decision.

A decision is asked for with a deadline. If it has not been heard by then, a miss fires at
exactly that moment, after all else that happens in it: what is heard at its very deadline is in
time. Whenever it ends, it leaves one :class:`~bus.messages.LedgerEntry`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import cast

import simpy

from bus.coordinator import Handled
from bus.messages import DeadlineMissed, LedgerEntry, Message
from simworld.instants import DEADLINES, call_at

DECIDES = {"sensing": "classifier", "path": "decider", "reaction": "reactor"}
"""Which process makes each kind of decision."""


@dataclass
class _Open:
    decision: int
    kind: str
    visit: int
    asked_ns: int
    until_ns: int
    cause: str = ""
    """Why it was missed, once it was."""


class Deadlines:
    """Keeps the open decisions of one run.

    ``say`` publishes; ``why_late`` tells, at the moment of a miss, why a process has not
    decided: ``process down``, ``overrun`` (it is computing) or ``late input`` (it is not).
    ``missed`` is called after each miss with that process and the cause.
    """

    def __init__(
        self,
        env: simpy.Environment,
        say: Callable[[Message], None],
        why_late: Callable[[str], str],
        missed: Callable[[str, str], None],
    ) -> None:
        self._env = env
        self._say = say
        self._why_late = why_late
        self._missed = missed
        self._open: dict[int, _Open] = {}
        self._asked = 0
        self.on_time: dict[str, int] = dict.fromkeys(DECIDES, 0)
        self.late: dict[str, int] = dict.fromkeys(DECIDES, 0)

    def ask(self, kind: str, visit: int, until_ns: int) -> int:
        """Open a decision due at ``until_ns``; returns its number."""
        self._asked += 1
        now_ns = int(self._env.now)
        entry = _Open(self._asked, kind, visit, now_ns, until_ns)
        self._open[entry.decision] = entry
        call_at(self._env, until_ns, DEADLINES, self._fire, entry)
        return entry.decision

    def _fire(self, alarm: simpy.Event) -> None:
        entry = cast(_Open, alarm.value)
        if entry.decision not in self._open:
            return
        self.late[entry.kind] += 1
        entry.cause = self._why_late(DECIDES[entry.kind])
        self._say(DeadlineMissed(entry.decision, entry.kind, entry.until_ns))
        self._missed(DECIDES[entry.kind], entry.cause)

    def open(self, decision: int) -> bool:
        """Whether a decision is still waited for."""
        return decision in self._open

    def decided(
        self, decision: int, by: Handled | None, size: int, waiting_since_ns: int | None
    ) -> None:
        """A decision was heard now. ``waiting_since_ns``: since when the robot stands for it."""
        entry = self._open.pop(decision, None)
        if entry is None:
            return
        now_ns = int(self._env.now)
        if entry.cause:
            if by is not None and by.start_ns < entry.until_ns:
                entry.cause = "overrun"  # its answer was on its way already
        else:
            self.on_time[entry.kind] += 1
        idle_ns = 0
        if waiting_since_ns is not None:
            idle_ns = max(0, now_ns - max(entry.until_ns, waiting_since_ns))
        self._close(entry, now_ns, by.cells if by is not None else 0, size, idle_ns)

    def dropped(self, decision: int) -> None:
        """A decision is needed no more; it leaves an entry if its deadline has passed."""
        entry = self._open.pop(decision, None)
        if entry is not None and entry.cause:
            self._close(entry, -1, 0, 0, 0)

    def close_all(self, stands_since_ns: int | None) -> None:
        """The run ends: every decision that was missed, or never can come, gets its entry."""
        now_ns = int(self._env.now)
        for entry in list(self._open.values()):
            idle_ns = 0
            if stands_since_ns is not None:
                idle_ns = max(0, now_ns - max(entry.until_ns, stands_since_ns))
            del self._open[entry.decision]
            if not entry.cause and self._why_late(DECIDES[entry.kind]) == "process down":
                entry.cause = "process down"
            if entry.cause:
                self._close(entry, -1, 0, 0, idle_ns)

    def _close(self, entry: _Open, decided_ns: int, cells: int, size: int, idle_ns: int) -> None:
        heard_ns = decided_ns if decided_ns >= 0 else int(self._env.now)
        self._say(
            LedgerEntry(
                entry.decision,
                entry.kind,
                entry.visit,
                entry.asked_ns,
                entry.until_ns,
                decided_ns,
                entry.until_ns - heard_ns,
                cells,
                size,
                idle_ns,
                "stood and waited" if idle_ns else "",
                entry.cause,
            )
        )
