"""One process's turns: the same code runs a module under every clock.

A module is a table of handlers by topic. A handler gets the message and its :class:`Turn`,
on which it reports the work it did, in cells, and says what it has to say; all of it is
released when the handler ends, at start + cost.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from contextlib import redirect_stdout
from dataclasses import dataclass, field
from io import StringIO
from typing import Any, Protocol, TypeAlias

import msgspec
import numpy as np

from bus.coordinator import Done, Grant, Handled, Said
from bus.costs import CostModel
from bus.fields import FieldError, check_arrays
from bus.messages import Message
from bus.topics import TOPIC_OF
from bus.wire import MessageId, Sent


class Voice:
    """Numbers what a process says: one count for the process, one link a topic."""

    def __init__(self, source: str) -> None:
        self.source = source
        self._sequence = 0
        self._previous: dict[str, int] = {}

    def sent(self, message: Message, said_ns: int, parents: tuple[MessageId, ...]) -> Sent:
        """Put a message into its envelope. Its arrays become read-only.

        Raises FieldError where a field holds what every listener would refuse: better the
        speaker stops, with its own words, than those who wait for it.
        """
        topic = TOPIC_OF[type(message)].name
        try:
            check_arrays(message)
        except FieldError as error:
            raise FieldError(f"{self.source} may not say this on {topic}: {error}") from None
        for value in msgspec.structs.astuple(message):
            if isinstance(value, np.ndarray):
                value.flags.writeable = False
        sequence = self._sequence
        self._sequence += 1
        previous = self._previous.get(topic, -1)
        self._previous[topic] = sequence
        return Sent(topic, self.source, sequence, previous, said_ns, parents, message)


@dataclass
class Turn:
    """A handler's turn: the message it heard, when it began, what computing costs, what it says.

    ``heard`` names the message being handled. A module that remembers a message keeps its name,
    and gives it as a parent of what is made from it later.
    """

    start_ns: int
    costs: CostModel
    heard: MessageId
    said: list[tuple[Message, tuple[MessageId, ...]]] = field(default_factory=list)
    works: list[tuple[str, int]] = field(default_factory=list)
    cells: int = 0
    cost_ns: int = 0

    def work(self, kind: str, cells: int) -> None:
        """Report work: table entries touched, of a kind that the compute profile prices."""
        self.works.append((kind, cells))
        self.cells += cells
        self.cost_ns += self.costs.cost_ns(kind, cells)

    def say(self, message: Message, *parents: MessageId) -> None:
        """Say a message at the end of this turn; ``parents`` beside the one being handled.

        Parents are all remembered messages it was made from; of those that went into a state
        which sums up many (a map, a track, a pose), the last one.
        """
        self.said.append((message, parents))

    def left_ns(self, until_ns: int) -> int:
        """Time left for computing until a deadline, counted from the work done so far."""
        return until_ns - self.start_ns - self.cost_ns


Handler: TypeAlias = Callable[[Any, Turn], None]


class Module(Protocol):
    """What a process must offer: a handler for each topic that it listens to."""

    @property
    def handlers(self) -> Mapping[str, Handler]:
        """Handlers by topic."""


class Worker:
    """Carries out grants for one module."""

    def __init__(self, name: str, module: Module, costs: CostModel) -> None:
        self.name = name
        self._handlers = module.handlers
        self._costs = costs
        self._voice = Voice(name)

    def run(self, grant: Grant, heard: tuple[Sent, ...]) -> tuple[Done, list[Sent]]:
        """Handle what was granted, one after the other, each beginning when the last ended."""
        at_ns = grant.time_ns
        handled: list[Handled] = []
        out: list[Sent] = []
        for sent in heard:
            turn = Turn(at_ns, self._costs, sent.id)
            began_ns = time.perf_counter_ns()
            printed = self._handle(sent, turn)
            took_ns = time.perf_counter_ns() - began_ns
            end_ns = at_ns + turn.cost_ns
            handled.append(
                Handled(
                    sent.topic,
                    sent.source,
                    sent.sequence,
                    at_ns,
                    end_ns,
                    turn.cells,
                    len(turn.said),
                    printed,
                    took_ns,
                )
            )
            for message, parents in turn.said:
                named = tuple(dict.fromkeys((sent.id, *parents)))  # each once, what was heard first
                out.append(self._voice.sent(message, end_ns, named))
            at_ns = end_ns
        said = tuple(Said(s.topic, s.source, s.sequence, s.said_ns) for s in out)
        return Done(grant.process, grant.time_ns, tuple(handled), said), out

    def _handle(self, sent: Sent, turn: Turn) -> str:
        """Run the handler; returns what it printed, which belongs into the log."""
        with redirect_stdout(StringIO()) as printed:
            self._handlers[sent.topic](sent.message, turn)
        return printed.getvalue()
