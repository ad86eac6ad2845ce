"""Virtual time: the SimPy event queue is the only queue.

The clock asks the coordinator who may run, has the grants carried out (here or over the bus,
it does not care) and schedules what follows. Grants come after all the world's own events of
an instant.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

import simpy

from bus.coordinator import Coordinator, Done, Grant, Handled, Said
from bus.journal import Journal
from bus.messages import Message, Output, ProcessState, Refused, Span
from bus.protocol import CommitEntry
from bus.topics import BUS, CLOCK
from bus.turns import Voice
from bus.wire import MessageId, RefusedError
from simworld.instants import GRANTS, call_at

CarryOut: TypeAlias = Callable[[list[Grant]], list[Done]]
Commit: TypeAlias = Callable[[list[CommitEntry]], None]
Measured: TypeAlias = Callable[[str, Handled], None]


class VirtualClock:
    """Drives a coordinator from a SimPy environment whose time is whole nanoseconds.

    ``carry_out`` runs grants and returns what came of them, in the order of the grants;
    ``commit`` gets the log's entries in the one order that they have; ``measured`` gets every
    handler's work with what it took by the wall clock, which no log that must repeat may hold.
    """

    def __init__(
        self,
        env: simpy.Environment,
        coordinator: Coordinator,
        carry_out: CarryOut,
        commit: Commit,
        measured: Measured = lambda _process, _handled: None,
    ) -> None:
        self._env = env
        self._coordinator = coordinator
        self._carry_out = carry_out
        self._commit = commit
        self._measured = measured
        self._journal: Journal[CommitEntry] = Journal()
        self._voice = Voice(CLOCK)
        self._bus_voice = Voice(BUS)
        self._armed_ns: int | None = None
        self._decided_by: dict[MessageId, Handled] = {}
        self.handlers_run = 0
        self.refusals = 0

    @property
    def now_ns(self) -> int:
        """Simulated time."""
        return int(self._env.now)

    def said(self, said: Said) -> None:
        """The world said something at this moment."""
        self._note(said, (said.source, said.sequence))
        self._coordinator.said(said)
        self._arm()

    def decided_by(self, decision: MessageId) -> Handled | None:
        """The handler that said a decision; it is forgotten by asking."""
        return self._decided_by.pop(decision, None)

    def why_late(self, process: str) -> str:
        """Why a process has not decided at this moment, its deadline."""
        if not self._coordinator.alive(process):
            return "process down"
        return "overrun" if self._coordinator.computing(process, self.now_ns) else "late input"

    def started(self) -> None:
        """All processes take part from now on."""
        self._say_states("running")

    def ended(self) -> None:
        """The run is over for all that still take part."""
        self._say_states("ended")

    def _say_states(self, state: str) -> None:
        for process in self._coordinator.living():
            self._log(self._voice, ProcessState(process, state), self.now_ns, ())

    def died(self, process: str) -> None:
        """A process is gone: what it was about to say is never said."""
        if self._coordinator.alive(process):
            self._log(self._voice, ProcessState(process, "down"), self.now_ns, ())
        self._coordinator.died(process, self.now_ns)
        self._journal.drop(process, self.now_ns)

    def refused(self, refusal: RefusedError) -> None:
        """A message was not let in: it stands in the log from this moment on."""
        self.refusals += 1
        said = Refused(
            refusal.topic, refusal.source, refusal.sequence, refusal.reason, self.refusals
        )
        self._log(self._bus_voice, said, self.now_ns, ())

    def finish(self) -> None:
        """Write down all that was said."""
        self._commit(self._journal.before(None))

    def _note(self, said: Said, entry: CommitEntry) -> None:
        self._journal.note(said, entry)

    def _arm(self) -> None:
        next_ns = self._coordinator.next_ns()
        if next_ns is None or (self._armed_ns is not None and self._armed_ns <= next_ns):
            return
        self._armed_ns = next_ns
        call_at(self._env, next_ns, GRANTS, self._dispatch, next_ns)

    def _dispatch(self, event: simpy.Event) -> None:
        if event.value != self._armed_ns:
            return  # an earlier time was armed after this one and has done its work
        self._armed_ns = None
        now_ns = self.now_ns
        self._commit(self._journal.before(now_ns))
        for done in self._carry_out(self._coordinator.grants(now_ns)):
            if self._coordinator.alive(done.process):
                self._coordinator.done(done)
                self._remember(done)
        self._arm()

    def _remember(self, done: Done) -> None:
        for handled, all_said in done.by_handler():
            self.handlers_run += 1
            self._span(done.process, handled)
            self._measured(done.process, handled)
            for said in all_said:
                self._note(said, (said.source, said.sequence))
                if said.topic.startswith("decision/"):
                    self._decided_by[said.source, said.sequence] = handled

    def _span(self, process: str, handled: Handled) -> None:
        span = Span(
            process,
            handled.topic,
            handled.source,
            handled.sequence,
            handled.start_ns,
            handled.end_ns,
            handled.cells,
        )
        heard = ((handled.source, handled.sequence),)
        self._log(self._voice, span, handled.end_ns, heard)
        if handled.printed:
            self._log(self._voice, Output(process, handled.printed), handled.end_ns, heard)

    def _log(
        self, voice: Voice, message: Message, said_ns: int, parents: tuple[MessageId, ...]
    ) -> None:
        """Write down what nobody but the recorder hears."""
        sent = voice.sent(message, said_ns, parents)
        self._note(Said(sent.topic, sent.source, sent.sequence, sent.said_ns), sent)
