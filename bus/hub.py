"""The hub's side of virtual time: grants out, dones in, all through one queue.

The process of the coordinator is the router of the star. It sees only grants, dones, and the
payloads meant for the world itself.
"""

from __future__ import annotations

import queue
import time
from collections.abc import Callable, Sequence
from typing import TypeAlias

import zenoh

from bus import link
from bus.coordinator import Done, Grant
from bus.inbox import Inbox
from bus.process import Refusals
from bus.protocol import CommitEntry, pack_commit, pack_grant, unpack_done
from bus.topics import RECORDER, WORLD, heard_by
from bus.wire import RefusedError, Sent, pack, unpack

GRANT_PATIENCE_S = 60.0
"""How long a granted process may compute, by the wall clock, before it counts as frozen."""

READY_PATIENCE_S = 60.0
FAREWELL_PATIENCE_S = 60.0

Item: TypeAlias = tuple[str, bytes]
ALIVE, GONE = "alive", "gone"


class NotReadyError(RuntimeError):
    """Not all processes became ready: which ones did not."""


class Hub:
    """Carries out grants over the bus.

    ``world_turn`` handles the world's own grants. ``lost`` is told of every process that goes
    while the run goes on, once, with how: ``down`` or ``frozen``.
    """

    def __init__(
        self,
        session: zenoh.Session,
        keys: link.Keys,
        processes: Sequence[str],
        lost: Callable[[str, str], None],
    ) -> None:
        self._session = session
        self._keys = keys
        self._queue: queue.SimpleQueue[Item] = queue.SimpleQueue()
        self._lost = lost
        self._inbox = Inbox()
        self._refusals = Refusals()
        self._dones: dict[str, Done] = {}
        self._present: set[str] = set()
        self._gone: list[str] = []
        self._grants = {name: link.publisher(session, keys.grant(name)) for name in processes}
        self._commits = link.publisher(session, keys.commit)
        self._topics: dict[str, zenoh.Publisher] = {}
        wanted = [keys.topic(t.name) for t in heard_by(WORLD)] + [keys.done]
        self._subscribers = [link.subscribe(session, key, self._queue.put) for key in wanted]
        self._watch = link.watch_alive(session, keys, self._alive_changed)

    def _alive_changed(self, process: str, alive: bool) -> None:
        self._queue.put((ALIVE if alive else GONE, process.encode()))

    def wait_until_ready(self, say: Callable[[str], None]) -> None:
        """Wait for every process's token. Raises NotReadyError after a minute."""
        expected = {*self._grants, RECORDER}
        until_s = time.monotonic() + READY_PATIENCE_S
        while not expected <= self._present:
            try:
                before = set(self._present)
                self._sort(*self._queue.get(timeout=max(0.01, until_s - time.monotonic())))
            except queue.Empty:
                missing = ", ".join(sorted(expected - self._present))
                raise NotReadyError(f"not ready after {READY_PATIENCE_S:g} s: {missing}") from None
            for process in sorted(self._present - before):
                say(process)

    def put(self, sent: Sent) -> None:
        """Publish what the world says."""
        publisher = self._topics.get(sent.topic)
        if publisher is None:
            publisher = link.publisher(self._session, self._keys.topic(sent.topic))
            self._topics[sent.topic] = publisher
        publisher.put(pack(sent))

    def carry_out(
        self, grants: list[Grant], world_turn: Callable[[Grant, tuple[Sent, ...]], Done]
    ) -> list[Done]:
        """Grant all, wait for all; what is lost on the way is missing from the answer."""
        waiting = [g for g in grants if g.process != WORLD]
        for grant in waiting:
            self._grants[grant.process].put(pack_grant(grant))
        dones: list[Done] = []
        for grant in grants:
            if grant.process == WORLD:
                self._wait(lambda g=grant: self._inbox.has(g.messages), WORLD)  # type: ignore[misc]
                dones.append(world_turn(grant, self._inbox.take(grant.messages)))
        for grant in waiting:
            name = grant.process
            self._wait(lambda n=name: n in self._dones or n in self._gone, name)  # type: ignore[misc]
            if name in self._dones:
                dones.append(self._dones.pop(name))
        return dones

    def _wait(self, come: Callable[[], bool], process: str) -> None:
        while not come():
            try:
                self._sort(*self._queue.get(timeout=GRANT_PATIENCE_S))
            except queue.Empty:
                self._gone.append(process)
                self._lost(process, "frozen")
                return

    def _sort(self, kind: str, data: bytes) -> None:
        if kind == self._keys.done:
            done = unpack_done(data)
            self._dones[done.process] = done
        elif kind == ALIVE:
            self._present.add(data.decode())
        elif kind == GONE:
            self._present.discard(data.decode())
            self._gone.append(data.decode())
            self._lost(data.decode(), "down")
        else:
            try:
                self._inbox.put(unpack(self._keys.topic_of(kind), data))
            except RefusedError as error:
                self._refusals.note(error)

    def commit(self, entries: list[CommitEntry], *, last: bool = False) -> None:
        """Tell the recorder what to write next."""
        self._commits.put(pack_commit(entries, last=last))

    def farewell(self) -> None:
        """The run is over: stop every module, and wait until the recorder has written all."""
        self._lost = lambda _process, _how: None
        for grants in self._grants.values():
            grants.put(b"")
        until_s = time.monotonic() + FAREWELL_PATIENCE_S
        while self._present and time.monotonic() < until_s:
            try:
                self._sort(*self._queue.get(timeout=max(0.01, until_s - time.monotonic())))
            except queue.Empty:
                return
