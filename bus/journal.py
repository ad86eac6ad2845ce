"""The order in which a virtual run is written down: by the time things were said.

Handlers announce what they will have said at their end, later than now; the journal holds it
back until the clock has passed that time, so that the order never depends on who ran first.
"""

from __future__ import annotations

import heapq
from typing import Generic, TypeVar

from bus.coordinator import Said
from bus.topics import PRIORITY

Entry = TypeVar("Entry")


class Journal(Generic[Entry]):
    """Entries in the order (time said, priority, source, sequence)."""

    def __init__(self) -> None:
        self._heap: list[tuple[int, int, str, int, Entry]] = []

    def note(self, said: Said, entry: Entry) -> None:
        """Hold an entry until the clock has passed its time."""
        rank = PRIORITY.get(said.source, len(PRIORITY))
        heapq.heappush(self._heap, (said.said_ns, rank, said.source, said.sequence, entry))

    def drop(self, source: str, after_ns: int) -> None:
        """Forget what a source would have said after a time: it is gone."""
        self._heap = [e for e in self._heap if e[2] != source or e[0] <= after_ns]
        heapq.heapify(self._heap)

    def before(self, now_ns: int | None) -> list[Entry]:
        """All entries said before ``now_ns`` (None: all that are left), in order."""
        out: list[Entry] = []
        while self._heap and (now_ns is None or self._heap[0][0] < now_ns):
            out.append(heapq.heappop(self._heap)[4])
        return out
