"""Who may run, and when: the virtual clock's rules, without any I/O.

The coordinator is told what was said and what was done; it answers with grants. Simulated
time is whole nanoseconds. A message said at t is heard at t + hop, never before. A process is
single-threaded: what arrives while it is busy waits. Messages heard at the same time are
handled in the order (time, priority of the source, source, sequence), so the order is total.

Invariants:
- a process has at most one grant open;
- a grant names every message that the process has heard and not yet handled, in order;
- ``done`` releases nothing before the end of the handler that said it;
- with a positive hop nothing said at an instant is heard in that instant, so the grants of an
  instant do not depend on the order in which they are carried out.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from bus.wire import MessageId


class CoordinationError(RuntimeError):
    """The rules of virtual time were broken: by whom, when, and how."""


@dataclass(frozen=True, slots=True)
class Grant:
    """Leave to handle these messages at this time."""

    process: str
    time_ns: int
    messages: tuple[MessageId, ...]


@dataclass(frozen=True, slots=True)
class Said:
    """That a message was said: enough to know who hears it when."""

    topic: str
    source: str
    sequence: int
    said_ns: int


@dataclass(frozen=True, slots=True)
class Handled:
    """One handler's work on one message."""

    topic: str
    source: str
    sequence: int
    start_ns: int
    end_ns: int
    cells: int
    said: int = 0
    """How many messages it said, all at its end."""
    printed: str = ""
    took_ns: int = field(default=0, compare=False)
    """By the wall clock: never the same twice, so it decides nothing and equals anything."""


@dataclass(frozen=True, slots=True)
class Done:
    """What came of a grant; ``said`` in the order of the handlers that said it."""

    process: str
    time_ns: int
    handled: tuple[Handled, ...]
    said: tuple[Said, ...]

    def by_handler(self) -> Iterator[tuple[Handled, tuple[Said, ...]]]:
        """Each handler with what it said."""
        at = 0
        for handled in self.handled:
            yield handled, self.said[at : at + handled.said]
            at += handled.said


@dataclass(slots=True)
class _Process:
    priority: int
    shares: bool
    """Whether it queues for the processors."""
    inbox: list[tuple[int, int, str, int]] = field(default_factory=list)
    free_ns: int = 0
    granted: Grant | None = None
    alive: bool = True

    def next_ns(self) -> int | None:
        """When it may run next, if anything waits for it."""
        if not self.inbox or self.granted is not None:
            return None
        return max(self.inbox[0][0], self.free_ns)


class Coordinator:
    """Decides who may run.

    ``priority`` by process: the lower the number, the earlier in ties and in the queue for
    processors. ``subscribers``: who hears a topic. ``processors``: how many of the processes
    may compute at once (None: one each); a waiting process takes a processor when one is free.
    ``apart``: processes that need none of these, the world say.
    """

    def __init__(
        self,
        priority: Mapping[str, int],
        subscribers: Mapping[str, tuple[str, ...]],
        hop_ns: int,
        processors: int | None = None,
        apart: tuple[str, ...] = (),
    ) -> None:
        if hop_ns < 1:
            raise CoordinationError(f"hop_ns is {hop_ns}, expected at least 1")
        shares = processors is not None
        self._processes = {
            name: _Process(p, shares and name not in apart) for name, p in priority.items()
        }
        self._subscribers = subscribers
        self._hop_ns = hop_ns
        self._processors = processors
        self._busy: list[int] = []  # when each processor in use becomes free
        self._rank = dict(priority)
        self._now_ns = 0

    def said(self, said: Said) -> None:
        """Take note of a message; its listeners hear it a hop later."""
        if said.said_ns < self._now_ns:
            raise CoordinationError(
                f"{said.source} said message {said.sequence} on {said.topic} at {said.said_ns} ns, "
                f"before now ({self._now_ns} ns)"
            )
        heard_ns = said.said_ns + self._hop_ns
        rank = self._rank.get(said.source, 0)
        for name in self._subscribers.get(said.topic, ()):
            process = self._processes.get(name)
            if process is not None and process.alive:
                heapq.heappush(process.inbox, (heard_ns, rank, said.source, said.sequence))

    def next_ns(self) -> int | None:
        """The earliest time at which a grant is possible, or None while nothing waits."""
        full = self._processors is not None and len(self._busy) >= self._processors
        free_ns = min(self._busy) if full else 0
        times = [
            max(next_ns, free_ns) if process.shares else next_ns
            for process in self._processes.values()
            if (next_ns := process.next_ns()) is not None
        ]
        return max(min(times), self._now_ns) if times else None

    def grants(self, now_ns: int) -> list[Grant]:
        """All that may run at ``now_ns``, the first in priority first."""
        if now_ns < self._now_ns:
            raise CoordinationError(f"time went back from {self._now_ns} to {now_ns} ns")
        self._now_ns = now_ns
        self._busy = [t for t in self._busy if t > now_ns]
        ready = sorted(
            (process.priority, name)
            for name, process in self._processes.items()
            if (next_ns := process.next_ns()) is not None and next_ns <= now_ns
        )
        free = self._free()
        granted: list[Grant] = []
        for _, name in ready:
            if self._processes[name].shares:
                if free == 0:
                    continue
                free -= 1
            granted.append(self._grant(name, now_ns))
        return granted

    def _free(self) -> int:
        """How many processors nobody uses or was granted."""
        if self._processors is None:
            return 0
        granted = sum(p.shares and p.granted is not None for p in self._processes.values())
        return max(0, self._processors - len(self._busy) - granted)

    def _grant(self, name: str, now_ns: int) -> Grant:
        process = self._processes[name]
        messages: list[MessageId] = []
        while process.inbox and process.inbox[0][0] <= now_ns:
            _, _, source, sequence = heapq.heappop(process.inbox)
            messages.append((source, sequence))
        process.granted = Grant(name, now_ns, tuple(messages))
        return process.granted

    def done(self, done: Done) -> None:
        """Take what came of a grant: the process is busy until its last handler ends."""
        process = self._processes.get(done.process)
        if process is None or process.granted is None:
            raise CoordinationError(f"{done.process} is done with something it was not granted")
        self._check(process.granted, done)
        process.granted = None
        process.free_ns = done.handled[-1].end_ns if done.handled else done.time_ns
        if process.shares and process.free_ns > done.time_ns:
            self._busy.append(process.free_ns)
        for said in done.said:
            self.said(said)

    def _check(self, grant: Grant, done: Done) -> None:
        if done.time_ns != grant.time_ns:
            raise CoordinationError(
                f"{done.process} answers the grant of {done.time_ns} ns, "
                f"expected that of {grant.time_ns} ns"
            )
        named = tuple((h.source, h.sequence) for h in done.handled)
        if named != grant.messages:
            raise CoordinationError(
                f"{done.process} at {grant.time_ns} ns was granted {list(grant.messages)}, "
                f"handled {list(named)}"
            )
        at_ns = grant.time_ns
        for handled in done.handled:
            if handled.start_ns != at_ns or handled.end_ns < at_ns:
                raise CoordinationError(
                    f"{done.process}: a handler from {handled.start_ns} to {handled.end_ns} ns, "
                    f"expected it to begin at {at_ns} ns"
                )
            at_ns = handled.end_ns
        self._check_said(done)

    def _check_said(self, done: Done) -> None:
        count = sum(handled.said for handled in done.handled)
        if count != len(done.said):
            raise CoordinationError(
                f"{done.process} at {done.time_ns} ns says {len(done.said)} message(s), "
                f"its handlers {count}"
            )
        for handled, all_said in done.by_handler():
            for said in all_said:
                if said.source != done.process or said.said_ns != handled.end_ns:
                    raise CoordinationError(
                        f"{done.process}: message {said.sequence} of {said.source} said at "
                        f"{said.said_ns} ns by a handler that ends at {handled.end_ns} ns, "
                        f"expected its own, said then"
                    )

    def died(self, process: str, now_ns: int | None = None) -> None:
        """Forget a process: it hears and says nothing any more.

        What its last handler would have said after ``now_ns`` (None: after the last grants) is
        never heard.
        """
        heard_ns = (self._now_ns if now_ns is None else now_ns) + self._hop_ns
        state = self._processes[process]
        state.alive, state.granted = False, None
        state.inbox.clear()
        for other in self._processes.values():
            other.inbox = [m for m in other.inbox if m[2] != process or m[0] <= heard_ns]
            heapq.heapify(other.inbox)

    def alive(self, process: str) -> bool:
        """Whether a process still takes part."""
        return self._processes[process].alive

    def living(self) -> list[str]:
        """The processes that take part, by priority."""
        alive = [(p.priority, name) for name, p in self._processes.items() if p.alive]
        return [name for _, name in sorted(alive)]

    def computing(self, process: str, now_ns: int) -> bool:
        """Whether a process is in a handler, or waits for a processor with something to do."""
        state = self._processes[process]
        return state.free_ns > now_ns or bool(state.inbox and state.inbox[0][0] < now_ns)

    def waiting_for(self) -> list[str]:
        """The processes with an open grant."""
        return [name for name, p in self._processes.items() if p.granted is not None]
