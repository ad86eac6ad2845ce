"""The life of a module's process under the virtual clock: be ready, take turns, stop.

Everything arrives in one queue, in order, from zenoh's thread: payloads, grants, the word to
stop. A grant may overtake a payload it names (they come from different processes), so it is
kept until its payloads are there.
"""

from __future__ import annotations

import queue
import time
from typing import TypeAlias

import zenoh

from bus import link
from bus.coordinator import Grant
from bus.inbox import Inbox, LostPayloadError
from bus.protocol import pack_done, unpack_grant
from bus.refusals import Reporter
from bus.topics import heard_by
from bus.turns import Worker
from bus.wire import RefusedError, Sent, pack, unpack

Item: TypeAlias = tuple[str, bytes]

PAYLOAD_PATIENCE_S = 20.0
"""How long a granted process waits for a payload on its way before it says it was lost."""


class ModuleProcess:
    """One module on the star: subscribes to its topics and its grants, says what it has to.

    ``patience_s``: how long it waits, by the wall clock, for the payloads of a grant.
    """

    def __init__(
        self,
        session: zenoh.Session,
        keys: link.Keys,
        worker: Worker,
        patience_s: float = PAYLOAD_PATIENCE_S,
    ) -> None:
        self._keys = keys
        self._worker = worker
        self._patience_s = patience_s
        self._queue: queue.SimpleQueue[Item] = queue.SimpleQueue()
        self._inbox = Inbox()
        self._open: Grant | None = None
        self._until_s = 0.0
        self._reporter = Reporter(session, keys)
        self._session = session
        self._publishers: dict[str, zenoh.Publisher] = {}
        self._done = link.publisher(session, keys.done)
        self._grant_key = keys.grant(worker.name)
        wanted = [keys.topic(t.name) for t in heard_by(worker.name)] + [self._grant_key]
        self._subscribers = [link.subscribe(session, key, self._queue.put) for key in wanted]
        # The token comes last: who sees it knows that everything else is declared.
        self._token = session.liveliness().declare_token(keys.alive(worker.name))

    def run(self) -> None:
        """Take turns until an empty grant says that the run is over.

        Raises LostPayloadError for a payload that does not come, GapError for one before it.
        """
        while True:
            key, data = self._next()
            if key != self._grant_key:
                self._keep(key, data)
            elif not data:
                return
            else:
                self._open_grant(data)
            if self._open is not None and self._inbox.has(self._open.messages):
                self._take(self._open)
                self._open = None

    def _next(self) -> Item:
        if self._open is None:
            return self._queue.get()
        try:
            return self._queue.get(timeout=max(0.0, self._until_s - time.monotonic()))
        except queue.Empty:
            missing = self._inbox.missing(self._open.messages)
            raise LostPayloadError(
                self._worker.name, self._open.time_ns, missing, self._patience_s
            ) from None

    def _keep(self, key: str, data: bytes) -> None:
        try:
            self._inbox.put(unpack(self._keys.topic_of(key), data))
        except RefusedError as error:
            self._reporter.note(error)

    def _open_grant(self, data: bytes) -> None:
        try:
            grant = unpack_grant(self._worker.name, data)
            if self._open is not None:
                reason = f"for {grant.time_ns} ns, while that of {self._open.time_ns} ns is open"
                raise RefusedError("grant", "", -1, reason)
        except RefusedError as error:
            self._reporter.report(error)
            return
        self._open, self._until_s = grant, time.monotonic() + self._patience_s

    def _take(self, grant: Grant) -> None:
        done, said = self._worker.run(grant, self._inbox.take(grant.messages))
        for sent in said:
            self._put(sent)
        self._done.put(pack_done(done))

    def _put(self, sent: Sent) -> None:
        publisher = self._publishers.get(sent.topic)
        if publisher is None:
            publisher = link.publisher(self._session, self._keys.topic(sent.topic))
            self._publishers[sent.topic] = publisher
        publisher.put(pack(sent))
