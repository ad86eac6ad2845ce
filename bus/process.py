"""The life of a module's process under the virtual clock: be ready, take turns, stop.

Everything arrives in one queue, in order, from zenoh's thread: payloads, grants, the word to
stop. A grant may overtake a payload it names (they come from different processes), so it is
kept until its payloads are there.
"""

from __future__ import annotations

import queue
from typing import NoReturn, TypeAlias

import zenoh

from bus import link
from bus.coordinator import Grant
from bus.inbox import Inbox
from bus.protocol import pack_done, unpack_grant
from bus.topics import heard_by
from bus.turns import Worker
from bus.wire import RefusedError, Sent, pack, unpack

Item: TypeAlias = tuple[str, bytes]

PAYLOAD_PATIENCE_S = 20.0
"""How long a granted process waits for a payload on its way before it says it was lost."""


class LostPayloadError(RuntimeError):
    """A payload that a grant names did not come."""


class Refusals:
    """Counts what is refused and says each, so that it is seen in the process's output."""

    def __init__(self) -> None:
        self.count = 0

    def note(self, error: RefusedError) -> None:
        """Count and print a refusal."""
        self.count += 1
        print(f"refused ({self.count}): {error}", flush=True)


class ModuleProcess:
    """One module on the star: subscribes to its topics and its grants, says what it has to."""

    def __init__(self, session: zenoh.Session, keys: link.Keys, worker: Worker) -> None:
        self._keys = keys
        self._worker = worker
        self._queue: queue.SimpleQueue[Item] = queue.SimpleQueue()
        self._inbox = Inbox()
        self._refusals = Refusals()
        self._session = session
        self._publishers: dict[str, zenoh.Publisher] = {}
        self._done = link.publisher(session, keys.done)
        self._grant_key = keys.grant(worker.name)
        wanted = [keys.topic(t.name) for t in heard_by(worker.name)] + [self._grant_key]
        self._subscribers = [link.subscribe(session, key, self._queue.put) for key in wanted]
        # The token comes last: who sees it knows that everything else is declared.
        self._token = session.liveliness().declare_token(keys.alive(worker.name))

    def run(self) -> None:
        """Take turns until an empty grant says that the run is over."""
        while True:
            key, data = self._queue.get()
            if key != self._grant_key:
                self._keep(key, data)
            elif not data:
                return
            else:
                self._take(unpack_grant(self._worker.name, data))

    def _keep(self, key: str, data: bytes) -> None:
        try:
            self._inbox.put(unpack(self._keys.topic_of(key), data))
        except RefusedError as error:
            self._refusals.note(error)

    def _take(self, grant: Grant) -> None:
        while not self._inbox.has(grant.messages):
            try:
                self._keep(*self._queue.get(timeout=PAYLOAD_PATIENCE_S))
            except queue.Empty:
                self._give_up(grant)
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

    def _give_up(self, grant: Grant) -> NoReturn:
        raise LostPayloadError(
            f"{self._worker.name}: granted {self._inbox.missing(grant.messages)} at "
            f"{grant.time_ns} ns, but they did not come within {PAYLOAD_PATIENCE_S:g} s"
        )
