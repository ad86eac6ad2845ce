"""The recorder's side of virtual time: it writes what it has received in the order it is told."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from typing import Generic, Protocol, TypeVar

import zenoh

from bus import link
from bus.protocol import unpack_commit
from bus.refusals import Reporter
from bus.topics import RECORDER
from bus.wire import MessageId, RefusedError

PAYLOAD_PATIENCE_S = 20.0
_LOOK_EVERY_S = 0.001
"""How often it looks whether a payload that is due has come: it is seldom behind its commit."""


class Named(Protocol):
    """Something made of a message that still knows the message's name."""

    @property
    def id(self) -> MessageId:
        """The message's name."""


Entry = TypeVar("Entry", bound=Named)


class Recording(Generic[Entry]):
    """Holds payloads until a commit names them, then hands them to ``write``, many at a time.

    ``take`` makes of a message's topic and bytes what is written; it raises RefusedError for what
    may not be let in. What comes in waits in a queue without a bound, outside of Python: a
    recorder that stalls must not slow the bus. ``patience_s``: how long, by the wall clock, it
    waits for a payload before it counts it as ``lost``.
    """

    def __init__(
        self,
        session: zenoh.Session,
        keys: link.Keys,
        take: Callable[[str, bytes], Entry],
        write: Callable[[list[Entry]], None],
        patience_s: float = PAYLOAD_PATIENCE_S,
    ) -> None:
        self._commits_key = keys.commit
        self._before_topic = len(keys.topic(""))
        self._take = take
        self._write = write
        self._patience_s = patience_s
        self._held: dict[MessageId, Entry] = {}
        self._reporter = Reporter(session, keys)
        self._due: deque[MessageId | Entry] = deque()
        self._last = False
        self._waits_for: object = None
        self._until_s = 0.0
        self.lost: list[MessageId] = []
        # Every topic there could be: what is said on one that is not in the table is refused.
        self._subscriber = link.queue_up(session, keys.every_topic)
        self._token = session.liveliness().declare_token(keys.alive(RECORDER))

    def run(self) -> None:
        """Write until the last commit is carried out."""
        receive = self._subscriber.handler.recv
        while not self._last or self._due:
            sample = self._wait_for_due() if self._due else receive()
            if sample is None:
                self._give_up_first()
            else:
                self._sort(str(sample.key_expr), sample.payload.to_bytes())
            if self._due:
                self._write_due()

    def _wait_for_due(self) -> zenoh.Sample | None:
        """What comes next, None if the payload that is due has been waited for too long."""
        first = self._due[0]
        if first is not self._waits_for:
            self._waits_for = first
            self._until_s = time.monotonic() + self._patience_s
        while (sample := self._subscriber.handler.try_recv()) is None:
            if time.monotonic() >= self._until_s:
                return None
            time.sleep(_LOOK_EVERY_S)
        return sample

    def _sort(self, key: str, data: bytes) -> None:
        try:
            if key == self._commits_key:
                self._commit(data)
            else:
                entry = self._take(key[self._before_topic :], data)
                self._held[entry.id] = entry
        except RefusedError as error:
            self._reporter.report(error)

    def _commit(self, data: bytes) -> None:
        entries, last = unpack_commit(data)
        self._last = self._last or last
        for first, second in entries:
            if isinstance(second, int):
                self._due.append((first, second))
                continue
            try:
                self._due.append(self._take(first, second))
            except RefusedError as error:
                self._reporter.report(error)

    def _write_due(self) -> None:
        """Write as far as the payloads have come: they travel apart from the commits."""
        ready: list[Entry] = []
        while self._due:
            entry = self._due[0]
            if isinstance(entry, tuple):
                if entry not in self._held:
                    break
                entry = self._held.pop(entry)
            self._due.popleft()
            ready.append(entry)
        if ready:
            self._write(ready)

    def _give_up_first(self) -> None:
        name = self._due.popleft()
        assert isinstance(name, tuple)
        self.lost.append(name)
        print(f"lost: message {name[1]} of {name[0]} never came", flush=True)
