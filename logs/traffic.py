"""What was said on each topic: how often, how evenly, how much, and whether all of it is there."""

from __future__ import annotations

from array import array
from dataclasses import dataclass, field
from statistics import median

import numpy as np
from numpy.typing import NDArray

from bus.topics import TOPICS
from logs.spread import NS_PER_S, Spread, spread

FIRST = -1
"""What the first message of a topic names as the one before it."""


@dataclass(frozen=True)
class Traffic:
    """One topic of one log.

    ``rate_hz`` is over the time from the first to the last message; ``jitter_s`` the standard
    deviation of the periods between messages (None below three messages). Sizes are of the
    recorded protobuf message. ``gaps`` counts the messages that the next one on the topic names
    as the one before it, and that the log does not have.
    """

    topic: str
    number: int
    rate_hz: float | None
    period: Spread
    jitter_s: float | None
    median_bytes: float
    total_bytes: int
    gaps: int


@dataclass(slots=True)
class TopicCount:
    """Gathers one topic."""

    said_ns: array[int] = field(default_factory=lambda: array("q"))
    sizes: array[int] = field(default_factory=lambda: array("i"))
    _ends: set[int] = field(default_factory=set)  # here, but not named by a next one yet
    _named: set[int] = field(default_factory=set)  # named by a next one, but not here yet

    def add(self, said_ns: int, size: int, sequence: int, previous: int) -> None:
        """A message was said; ``previous`` is the one that its source said before it here.

        Messages may come in another order than they were numbered in: what is said at the end of
        a long handler is written down after what others said meanwhile.
        """
        self.said_ns.append(said_ns)
        self.sizes.append(size)
        self._link(previous, sequence)

    def _link(self, previous: int, sequence: int) -> None:
        if previous in self._ends:
            self._ends.remove(previous)
        elif previous != FIRST:
            self._named.add(previous)
        if sequence in self._named:
            self._named.remove(sequence)
        else:
            self._ends.add(sequence)

    def add_block(
        self,
        said_ns: NDArray[np.int64],
        sizes: NDArray[np.int64],
        sequence: NDArray[np.int64],
        previous: NDArray[np.int64],
    ) -> None:
        """Messages were said: the same as :meth:`add` for each of them."""
        self.said_ns.frombytes(said_ns.tobytes())
        self.sizes.frombytes(sizes.astype(np.int32).tobytes())
        first, last = int(previous[0]), int(sequence[-1])
        if np.array_equal(previous[1:], sequence[:-1]):  # nothing between first and last is open
            self._link(first, last)
        else:
            for its_previous, its_own in zip(previous.tolist(), sequence.tolist(), strict=True):
                self._link(its_previous, its_own)

    @property
    def gaps(self) -> int:
        """How many messages are named and not here."""
        return len(self._named)

    def traffic(self, topic: str) -> Traffic:
        """What it comes to."""
        said_ns = np.asarray(self.said_ns)
        periods_ns = np.diff(said_ns)
        lasted_ns = int(said_ns[-1] - said_ns[0]) if len(said_ns) else 0
        return Traffic(
            topic,
            len(said_ns),
            len(periods_ns) / (lasted_ns / NS_PER_S) if lasted_ns > 0 else None,
            spread(periods_ns.tolist()),
            float(periods_ns.std()) / NS_PER_S if len(periods_ns) > 1 else None,
            float(median(self.sizes)) if self.sizes else 0.0,
            sum(self.sizes),
            self.gaps,
        )


def new_counts() -> dict[str, TopicCount]:
    """A count for every topic, in the order of their table."""
    return {topic: TopicCount() for topic in TOPICS}


def all_traffic(counts: dict[str, TopicCount]) -> tuple[Traffic, ...]:
    """The topics on which something was said."""
    return tuple(count.traffic(topic) for topic, count in counts.items() if count.said_ns)
