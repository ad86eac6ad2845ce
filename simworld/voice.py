"""The world's voice and ear: what it says at this moment, what it has heard and waits for."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any

import simpy

from bus.coordinator import Said
from bus.messages import Message
from bus.turns import Voice
from bus.wire import MessageId, Sent


@dataclass(frozen=True)
class Outlet:
    """Where the world's messages go: ``put`` onto the bus, ``said`` to the clock."""

    put: Callable[[Sent], None]
    said: Callable[[Said], None]


class Speaker:
    """Says things at the present simulated time."""

    def __init__(self, env: simpy.Environment, outlet: Outlet, name: str) -> None:
        self._env = env
        self._outlet = outlet
        self._voice = Voice(name)

    def say(self, message: Message, *parents: MessageId) -> None:
        """Say a message now."""
        sent = self._voice.sent(message, int(self._env.now), parents)
        self._outlet.put(sent)
        self._outlet.said(Said(sent.topic, sent.source, sent.sequence, sent.said_ns))


class Mailbox:
    """What was heard, by what it is about, for processes that wait for it."""

    def __init__(self, env: simpy.Environment) -> None:
        self._env = env
        self._held: dict[Hashable, Any] = {}
        self._awaited: dict[Hashable, simpy.Event] = {}

    def put(self, about: Hashable, value: Any) -> None:
        """Keep a value; whoever waits for it goes on."""
        self._held[about] = value
        event = self._awaited.pop(about, None)
        if event is not None:
            event.succeed()

    def has(self, about: Hashable) -> bool:
        """Whether it is here."""
        return about in self._held

    def take(self, about: Hashable) -> Any:
        """The value, which is kept no longer."""
        return self._held.pop(about)

    def wait(self, about: Hashable) -> simpy.Event:
        """An event for its coming. Check ``has`` first."""
        event = self._env.event()
        self._awaited[about] = event
        return event
