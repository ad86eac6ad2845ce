"""What becomes of a message that may not be let in: counted, printed, told to the log."""

from __future__ import annotations

import zenoh

from bus import link
from bus.protocol import pack_refusal
from bus.wire import RefusedError


class Refusals:
    """One process's refusals: counts each and prints it, so that its output shows it."""

    def __init__(self) -> None:
        self.count = 0

    def note(self, error: RefusedError) -> None:
        """Count and print a refusal."""
        self.count += 1
        print(f"refused ({self.count}): {error}", flush=True)


class Reporter:
    """Notes refusals and tells them to the hub, which has them written into the log.

    Whoever alone hears a key tells what it refuses there. The messages of a topic have many
    listeners, and all refuse the same; the recorder hears every topic, so only it tells.
    """

    def __init__(self, session: zenoh.Session, keys: link.Keys) -> None:
        self._refusals = Refusals()
        self._tell = link.publisher(session, keys.refused)

    def note(self, error: RefusedError) -> None:
        """Count and print a refusal, for others tell it."""
        self._refusals.note(error)

    def report(self, error: RefusedError) -> None:
        """Count and print a refusal, and tell it."""
        self._refusals.note(error)
        self._tell.put(pack_refusal(error))
