"""The recorder's side of virtual time: it writes what it has received in the order it is told."""

from __future__ import annotations

import queue
import time
from collections import deque
from collections.abc import Callable
from typing import TypeAlias

import zenoh

from bus import link
from bus.protocol import CommitEntry, unpack_commit
from bus.refusals import Reporter
from bus.topics import RECORDER
from bus.wire import MessageId, RefusedError, Sent, unpack

Item: TypeAlias = tuple[str, bytes]

PAYLOAD_PATIENCE_S = 20.0


class Recording:
    """Holds payloads until a commit names them, then hands them to ``write``.

    The queue has no bound: a recorder that stalls must not slow the bus. ``patience_s``: how
    long, by the wall clock, it waits for a payload before it counts it as ``lost``.
    """

    def __init__(
        self,
        session: zenoh.Session,
        keys: link.Keys,
        write: Callable[[Sent], None],
        patience_s: float = PAYLOAD_PATIENCE_S,
    ) -> None:
        self._keys = keys
        self._write = write
        self._patience_s = patience_s
        self._queue: queue.SimpleQueue[Item] = queue.SimpleQueue()
        self._held: dict[MessageId, Sent] = {}
        self._reporter = Reporter(session, keys)
        self._due: deque[CommitEntry] = deque()
        self._last = False
        self.lost: list[MessageId] = []
        # Every topic there could be: what is said on one that is not in the table is refused.
        self._subscribers = [
            link.subscribe(session, key, self._queue.put) for key in (keys.every_topic, keys.commit)
        ]
        self._token = session.liveliness().declare_token(keys.alive(RECORDER))

    def run(self) -> None:
        """Write until the last commit is carried out."""
        first: CommitEntry | None = None
        until_s = 0.0
        while not self._last or self._due:
            try:
                left_s = max(0.0, until_s - time.monotonic()) if self._due else None
                self._take(*self._queue.get(timeout=left_s))
            except queue.Empty:
                self._give_up_first()
            self._write_due()
            if self._due and self._due[0] is not first:
                first, until_s = self._due[0], time.monotonic() + self._patience_s

    def _take(self, key: str, data: bytes) -> None:
        try:
            if key == self._keys.commit:
                entries, last = unpack_commit(data)
                self._due.extend(entries)
                self._last = self._last or last
            else:
                sent = unpack(self._keys.topic_of(key), data)
                self._held[sent.id] = sent
        except RefusedError as error:
            self._reporter.report(error)

    def _write_due(self) -> None:
        """Write as far as the payloads have come: they travel apart from the commits."""
        while self._due:
            entry = self._due[0]
            if not isinstance(entry, Sent):
                if entry not in self._held:
                    return
                entry = self._held.pop(entry)
            self._due.popleft()
            self._write(entry)

    def _give_up_first(self) -> None:
        name = self._due.popleft()
        assert not isinstance(name, Sent)
        self.lost.append(name)
        print(f"lost: message {name[1]} of {name[0]} never came", flush=True)
