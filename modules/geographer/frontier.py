"""The state tables of the frontier method, built once for each width of a grid.

The grid is swept one intersection at a time, row by row. Between two intersections the state
is what the corridors chosen so far look like from the part not yet swept: which of them
cross the frontier, and which of those are connected. Around one intersection only four plugs
change, west and south going in and north and east going out. All states of the
other places that look alike from the intersection are one *rest*, so a state is a pair:

- *enter code* 0 to 3 (south 1, west 2) and a rest, before the intersection;
- *leave code* 0 to 3 (north 1, east 2) and a rest, after it.

A junction type is then ``4 * enter code + leave code``. With code 0 the intersection has no
corridor on that side, and the rest is one of `idle` partitions of the other places. With codes
1 to 3 it is one of `joined` partitions that include the intersection. A state's index is the
rest for code 0, else ``idle + (code - 1) * joined + rest``. Rests are numbered such that the
first `idle` of the joined ones are the idle ones with a new component that only the
intersection belongs to; rest 0 has nothing anywhere else.

Two states more stand at the end: DONE (the one component is complete) and DEAD (a component
ended while others go on: not connected).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from modules.geographer.partitions import Indices, Labels, Partitions, partition_count

Table = NDArray[np.int32]

START = 0
"""The state before the first intersection: no corridor yet."""


@dataclass(frozen=True)
class Frontier:
    """The states and moves for grids of one width.

    `enter` (width, states) takes the state after the previous intersection to the state before
    the intersection in a column; `close` (width, joined) takes a joined rest to the state after
    an intersection that no corridor leaves.
    """

    width: int
    idle: int
    joined: int
    enter: Table
    close: Table

    @property
    def states(self) -> int:
        """How many states there are, DONE and DEAD among them."""
        return state_count(self.width)

    @classmethod
    def of(cls, width: int, progress: Callable[[int, int], None] | None = None) -> Frontier:
        """Build the tables: time and memory grow about fivefold with each line.

        `progress` is called with the number of columns done and their number.
        """
        partitions = Partitions.of(width)
        columns = [_Column.of(partitions, x) for x in range(width)]
        enter = []
        for x in range(width):
            if progress is not None:
                progress(x, width)
            enter.append(_enter(partitions, columns[x - 1], columns[x]))
        close = [_close(partitions, column) for column in columns]
        if progress is not None:
            progress(width, width)
        return cls.from_tables(
            width, np.array(enter, dtype=np.int32), np.array(close, dtype=np.int32)
        )

    @classmethod
    def from_tables(cls, width: int, enter: Table, close: Table) -> Frontier:
        """The frontier with these tables, of the shapes that :func:`table_shapes` gives."""
        return cls(width, partition_count(width - 1), close.shape[1], enter, close)


def table_shapes(width: int) -> tuple[tuple[int, int], tuple[int, int]]:
    """The shapes of `enter` and `close` for a width."""
    joined = partition_count(width) - partition_count(width - 1)
    return (width, state_count(width)), (width, joined)


def update_cells(width: int, steps: int) -> int:
    """Table entries touched by a backward and a forward pass.

    Each meets at each intersection every state once and every pair of a state and one of the 16
    junction types that it allows once.
    """
    idle = partition_count(width - 1)
    joined = partition_count(width) - idle
    return 2 * steps * (state_count(width) + 4 * idle + 12 * joined)


def state_count(width: int) -> int:
    """How many states a frontier of this width has, DONE and DEAD among them."""
    idle = partition_count(width - 1)
    return idle + 3 * (partition_count(width) - idle) + 2


@dataclass(frozen=True)
class _Column:
    """The rests around the intersection in one column, as rows of the partitions.

    `place` (partitions,) is the number of each partition among the idle or joined rests.
    """

    x: int
    idle: Indices
    joined: Indices
    place: Indices

    @property
    def states(self) -> int:
        return len(self.idle) + 3 * len(self.joined) + 2

    @classmethod
    def of(cls, partitions: Partitions, x: int) -> _Column:
        labels = partitions.labels
        here = labels[:, x]
        idle = np.flatnonzero(here == 0)
        with_new = labels[idle].copy()
        with_new[:, x] = labels.shape[1] + 1
        alone = partitions.rank(with_new)
        shared = np.flatnonzero((here > 0) & ((labels == here[:, None]).sum(axis=1) > 1))
        joined = np.concatenate([alone, shared])
        place = np.zeros(len(labels), np.int64)
        place[idle] = np.arange(len(idle))
        place[joined] = np.arange(len(joined))
        return cls(x, idle, joined, place)

    def index(self, code: NDArray[np.int64], rest: Indices) -> Indices:
        """The index of states from their codes and their rests."""
        shifted: Indices = len(self.idle) + (code - 1) * len(self.joined) + rest
        return np.where(code == 0, rest, shifted)


def _enter(partitions: Partitions, before: _Column, here: _Column) -> Indices:
    """From states after the intersection in column `before` to states before that in `here`."""
    turned = here.x <= before.x  # a new row: nothing enters from the west
    parts = []
    for code in range(4):
        rests = before.joined if code else before.idle
        if turned and code & 2:
            parts.append(np.full(len(rests), here.states - 1))
            continue
        labels = partitions.labels[rests].copy()
        west = labels[:, before.x] * np.uint8(code >> 1)
        if not code & 1:
            labels[:, before.x] = 0
        south = labels[:, here.x].copy()
        _join(labels, here.x, west, south)
        arriving = 2 * (west > 0).astype(np.int64) + (south > 0)
        parts.append(here.index(arriving, here.place[partitions.rank(labels)]))
    parts.append(np.array([here.states - 2, here.states - 1]))
    return np.concatenate(parts)


def _join(labels: Labels, x: int, west: Labels, south: Labels) -> None:
    """Put the intersection on place x, one component with what enters from west and south."""
    both = (west > 0) & (south > 0)
    labels[:] = np.where((labels == south[:, None]) & both[:, None], west[:, None], labels)
    labels[:, x] = np.where(west > 0, west, south)


def _close(partitions: Partitions, here: _Column) -> Indices:
    """From joined rests to the states after an intersection that no corridor leaves."""
    labels = partitions.labels[here.joined].copy()
    labels[:, here.x] = 0
    after = here.place[partitions.rank(labels)]
    after[: len(here.idle)] = here.states - 1
    after[0] = here.states - 2
    return after
