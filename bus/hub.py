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
from bus.inbox import Inbox, LostPayloadError
from bus.protocol import CommitEntry, pack_commit, pack_grant, unpack_done, unpack_refusal
from bus.refusals import Refusals
from bus.topics import RECORDER, WORLD, heard_by
from bus.wire import RefusedError, Sent, pack, unpack

GRANT_PATIENCE_S = 60.0
"""How long a granted process may compute, by the wall clock, before it counts as frozen."""

READY_PATIENCE_S = 300.0
FAREWELL_PATIENCE_S = 60.0

Item: TypeAlias = tuple[str, bytes]
ALIVE, GONE = "alive", "gone"


class NotReadyError(RuntimeError):
    """Not all processes became ready: which ones did not."""


class Hub:
    """Carries out grants over the bus.

    ``lost`` is told of every process that goes while the run goes on, once, with how: ``down``
    or ``frozen``, which it is when a grant is not answered within ``patience_s`` of the wall
    clock. ``refused`` is told of every message that was not let in.
    """

    def __init__(
        self,
        session: zenoh.Session,
        keys: link.Keys,
        processes: Sequence[str],
        lost: Callable[[str, str], None],
        refused: Callable[[RefusedError], None],
        patience_s: float = GRANT_PATIENCE_S,
    ) -> None:
        self._session = session
        self._keys = keys
        self._queue: queue.SimpleQueue[Item] = queue.SimpleQueue()
        self._lost = lost
        self._refused = refused
        self._patience_s = patience_s
        self._inbox = Inbox()
        self._refusals = Refusals()
        self._open: dict[str, int] = {}
        self._dones: dict[str, Done] = {}
        self._present: set[str] = set()
        self._gone: list[str] = []
        self._grants = {name: link.publisher(session, keys.grant(name)) for name in processes}
        self._commits = link.publisher(session, keys.commit)
        self._topics: dict[str, zenoh.Publisher] = {}
        wanted = [keys.topic(t.name) for t in heard_by(WORLD)] + [keys.done, keys.refused]
        self._subscribers = [link.subscribe(session, key, self._queue.put) for key in wanted]
        self._watch = link.watch_alive(session, keys, self._alive_changed)

    def _alive_changed(self, process: str, alive: bool) -> None:
        self._queue.put((ALIVE if alive else GONE, process.encode()))

    def wait_until_ready(self, say: Callable[[str], None]) -> None:
        """Wait for every process's token. Raises NotReadyError after five minutes.

        The first run on a machine compiles: that may take half a minute and more.
        """
        expected = {*self._grants, RECORDER}
        told: set[str] = set()

        def all_ready() -> bool:
            for process in sorted(self._present - told):
                say(process)
            told.update(self._present)
            return expected <= self._present

        if not self._sort_until(all_ready, READY_PATIENCE_S):
            missing = ", ".join(sorted(expected - self._present))
            raise NotReadyError(f"not ready after {READY_PATIENCE_S:g} s: {missing}")

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
        """Grant all, wait for all; what is lost on the way is missing from the answer.

        ``world_turn`` handles the world's own grant. Raises LostPayloadError if what the world
        is to hear does not come.
        """
        waiting = [g for g in grants if g.process != WORLD]
        for grant in waiting:
            self._open[grant.process] = grant.time_ns
            self._grants[grant.process].put(pack_grant(grant))
        dones: list[Done] = []
        for grant in grants:
            if grant.process == WORLD:
                self._wait_for_payloads(grant)
                dones.append(world_turn(grant, self._inbox.take(grant.messages)))
        for grant in waiting:
            self._wait_for_done(grant.process)
            if grant.process in self._dones:
                dones.append(self._dones.pop(grant.process))
        return dones

    def _wait_for_payloads(self, grant: Grant) -> None:
        if not self._sort_until(lambda: self._inbox.has(grant.messages), self._patience_s):
            missing = self._inbox.missing(grant.messages)
            raise LostPayloadError(WORLD, grant.time_ns, missing, self._patience_s)

    def _wait_for_done(self, name: str) -> None:
        if not self._sort_until(
            lambda: name in self._dones or name in self._gone, self._patience_s
        ):
            self._leave(name, "frozen")

    def _sort_until(self, come: Callable[[], bool], patience_s: float) -> bool:
        """Take in what arrives until something has come; False if it has not within a time."""
        until_s = time.monotonic() + patience_s
        while not come():
            try:
                self._sort(*self._queue.get(timeout=max(0.0, until_s - time.monotonic())))
            except queue.Empty:
                return False
        return True

    def _sort(self, kind: str, data: bytes) -> None:
        if kind == ALIVE:
            if data.decode() not in self._gone:
                self._present.add(data.decode())
        elif kind == GONE:
            if data.decode() not in self._gone:
                self._leave(data.decode(), "down")
        elif kind == self._keys.done:
            self._take_done(data)
        elif kind == self._keys.refused:
            self._pass_on(data)
        else:
            try:
                self._inbox.put(unpack(self._keys.topic_of(kind), data))
            except RefusedError as error:
                self._refusals.note(error)  # the recorder refuses it too, and tells

    def _leave(self, process: str, how: str) -> None:
        self._present.discard(process)
        self._open.pop(process, None)
        self._gone.append(process)
        self._lost(process, how)

    def _take_done(self, data: bytes) -> None:
        try:
            done = unpack_done(data)
            if self._open.get(done.process) != done.time_ns:
                raise RefusedError("done", done.process, -1, f"no grant of {done.time_ns} ns open")
        except RefusedError as error:
            self._refusals.note(error)
            self._refused(error)
            return
        del self._open[done.process]
        self._dones[done.process] = done

    def _pass_on(self, data: bytes) -> None:
        try:
            refusal = unpack_refusal(data)
        except RefusedError as error:
            self._refusals.note(error)
            refusal = error
        self._refused(refusal)

    def commit(self, entries: list[CommitEntry], *, last: bool = False) -> None:
        """Tell the recorder what to write next."""
        self._commits.put(pack_commit(entries, last=last))

    def farewell(self) -> None:
        """The run is over: stop every module, and wait until the recorder has written all."""
        self._lost = lambda _process, _how: None
        for grants in self._grants.values():
            grants.put(b"")
        self._sort_until(lambda: not self._present, FAREWELL_PATIENCE_S)
