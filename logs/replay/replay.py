"""Replaying a module: every turn of the log carried out again, and compared bit for bit.

A turn is replayed at the time the log has for it with the message the log has for it, whatever
the module did before: what it says differently is not heard by anybody. Hence one difference
does not make the next, unless the module's own state does.
"""

from __future__ import annotations

from bdb import BdbQuit
from collections import Counter
from dataclasses import dataclass, field
from typing import Protocol

from bus.coordinator import Grant, Handled
from bus.turns import Worker
from bus.wire import Sent
from logs.analysis import PROCESS_LOST
from logs.diff.acts import flips
from logs.diff.found import FirstDifference
from logs.replay.compare import compare_turn
from logs.replay.turns import GapInLogError, LoggedModule, LoggedTurn


class Watcher(Protocol):
    """What a debugger wants to be told."""

    def differs(self, first: FirstDifference) -> None:
        """A handler did the first thing that is not as in the log."""

    def failed(self, error: Exception) -> None:
        """A handler raised an exception."""


@dataclass(frozen=True)
class FlippedDecision:
    """A decision that chooses differently from the log."""

    topic: str
    sequence: int
    said_ns: int
    flips: tuple[str, ...]


@dataclass(frozen=True)
class Replayed:
    """How a replay went.

    ``handlers`` were run again, ``said`` messages compared, ``until_ns`` is when the last one
    ended. ``unlike`` handlers did something else, by kind in ``kinds``; ``first`` is the first
    difference. ``last_turn`` says how the turn went that a module did not survive, empty where
    there is none. ``incomplete`` is why nothing can be said of the rest of the run.
    """

    module: str
    handlers: int
    said: int
    until_ns: int
    first: FirstDifference | None
    unlike: int
    kinds: dict[str, int]
    flipped: tuple[FlippedDecision, ...]
    last_turn: str
    incomplete: tuple[str, ...]


@dataclass
class Replay:
    """Carries it out. ``stop_ns``: turns that begin then or later are not carried out."""

    log: LoggedModule
    worker: Worker
    watcher: Watcher | None = None
    stop_ns: int | None = None
    _handlers: int = 0
    _said: int = 0
    _until_ns: int = 0
    _first: FirstDifference | None = None
    _kinds: Counter[str] = field(default_factory=Counter)
    _flipped: list[FlippedDecision] = field(default_factory=list)
    _failed: bool = False
    _stopped: bool = False
    _gap: str = ""

    def run(self, hop_ns: int) -> Replayed:
        """Replay all that is there. Raises LogReadError."""
        try:
            for turn in self.log.turns():
                if self._failed or self._beyond(turn.span.record.start_ns):
                    self._stopped = not self._failed
                    break
                self._replay(turn)
        except GapInLogError as error:
            self._gap = str(error)
        last_turn = "" if self._cut else self._last_turn(hop_ns)
        return Replayed(
            self.log.module,
            self._handlers,
            self._said,
            self._until_ns,
            self._first,
            sum(self._kinds.values()),
            dict(self._kinds),
            tuple(self._flipped),
            last_turn,
            tuple(self._incomplete()),
        )

    def _beyond(self, start_ns: int) -> bool:
        return self.stop_ns is not None and start_ns >= self.stop_ns

    @property
    def _cut(self) -> bool:
        """Whether the log was not followed to the end of the module."""
        cut_short = self._failed or self._stopped or bool(self._gap)
        return cut_short or self.log.reader.truncated or self.log.state == "ended"

    def _replay(self, turn: LoggedTurn) -> None:
        record, heard = turn.span.record, turn.heard.sent()
        ran = self._run(heard, record.start_ns)
        if isinstance(ran, str):
            what = f"{self.log.module} raised {ran} handling {heard.topic} {_named(heard)}"
            self._note(_failure(turn, what))
            return
        handled, said, printed = ran
        self._handlers += 1
        self._until_ns = handled.end_ns
        self._said += 0 if turn.dropped else len(turn.said)
        first = compare_turn(turn, self.log.module, handled, said, printed)
        if first is None:
            return
        if self._first is None and self.watcher is not None:
            self.watcher.differs(first)
        self._note(first)
        self._note_flips(turn, said)

    def _note(self, difference: FirstDifference) -> None:
        self._first = self._first or difference
        self._kinds[difference.kind] += 1

    def _note_flips(self, turn: LoggedTurn, said: list[Sent]) -> None:
        for logged, now in zip(turn.said, said, strict=False):
            if logged.topic != now.topic or not logged.topic.startswith("decision/"):
                continue
            chosen = flips(logged.sent().message, now.message)
            if chosen:
                self._flipped.append(
                    FlippedDecision(logged.topic, logged.id[1], logged.said_ns, chosen)
                )

    def _run(self, heard: Sent, start_ns: int) -> tuple[Handled, list[Sent], str] | str:
        """Carry out one handler; what it did, or the exception it raised in words."""
        try:
            done, said = self.worker.run(Grant(self.log.module, start_ns, (heard.id,)), (heard,))
        except BdbQuit:  # whoever debugs it has enough
            raise
        except Exception as error:  # whatever a module may raise
            self._failed = True
            if self.watcher is not None:
                self.watcher.failed(error)
            return f"{type(error).__name__}: {error}{_where(error)}"
        (handled,) = done.handled
        return handled, said, handled.printed

    def _last_turn(self, hop_ns: int) -> str:
        """Carry out the turn that the log has no end of: the module may have gone down in it."""
        start_ns, events = self.log.last_turn(hop_ns)
        for event in events:
            heard = event.sent()
            if self._beyond(start_ns):
                return ""
            ran = self._run(heard, start_ns)
            if isinstance(ran, str):
                return f"handling {heard.topic} {_named(heard)} it raises {ran}"
            start_ns = ran[0].end_ns
        return f"{len(events)} messages are handled without an exception" if events else ""

    def _incomplete(self) -> list[str]:
        log = self.log
        reasons = [self._gap] if self._gap else []
        if self._failed or self._stopped or self._gap:
            return reasons
        if log.reader.truncated:
            reasons.append(f"the log is truncated: {log.reader.problem}")
        elif not log.ended:
            reasons.append("the log does not say why the run ended")
        elif log.ended.startswith(PROCESS_LOST):
            reasons.append(f"the run ended because of a {log.ended}")
        if log.unended and log.state != "down":
            reasons.append(f"{log.unended} messages were said by a handler whose end is missing")
        reasons += [
            f"{number} of the messages of {source} are not in the log"
            for source, number in log.reader.missing.items()
        ]
        return reasons


def _named(heard: Sent) -> str:
    return f"(message {heard.sequence} of {heard.source})"


def _where(error: Exception) -> str:
    """The line of code that raised an exception."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    if trace is None:
        return ""
    return f" ({trace.tb_frame.f_code.co_filename}:{trace.tb_lineno})"


def _failure(turn: LoggedTurn, what: str) -> FirstDifference:
    span = turn.span
    return FirstDifference(
        span.said_ns, span.process, span.topic, span.record.sequence, "failure", what
    )
