"""Count connected maps exactly, with whole numbers of any size."""

from __future__ import annotations

import numpy as np

from modules.geographer.frontier import START, Frontier


def count(frontier: Frontier, steps: int, corridors: int) -> int:
    """How many connected maps a grid of so many steps and corridors has."""
    return _total(frontier, steps, 0, corridors)


def count_by_corridors(frontier: Frontier, steps: int, corridors: int) -> list[int]:
    """How many connected maps have 0, 1, 2, ... corridors.

    Each corridor counts as 2^corridors, above any of the counts, so the counts are the digits
    of one total in that base (Kronecker substitution).
    """
    total = _total(frontier, steps, corridors, corridors * (corridors + 1))
    digit = (1 << corridors) - 1
    return [total >> corridors * k & digit for k in range(corridors + 1)]


def _total(frontier: Frontier, steps: int, shift: int, bits: int) -> int:
    """The sum over connected maps of 2^(shift corridors), known to need so many bits.

    Corridors that lead off the grid need no care: what they belong to never becomes complete.
    """
    idle, joined, done = frontier.idle, frontier.joined, frontier.states - 2
    before = np.zeros(frontier.states, np.int64 if bits < 63 else object)
    before[START] = 1
    reached = before
    for step in range(steps):
        column = step % frontier.width
        entering = before[idle:done].reshape(3, joined).sum(axis=0)
        reached = np.zeros_like(before)
        reached[:idle] = before[:idle]
        reached[done] = before[done]
        np.add.at(reached, frontier.close[column], entering)
        entering[:idle] += before[:idle]
        for leave in (1, 2, 3):
            first = idle + (leave - 1) * joined
            reached[first : first + joined] = entering << shift * leave.bit_count()
        reached[-1] = 0
        before = np.zeros_like(before)
        np.add.at(before, frontier.enter[(column + 1) % frontier.width], reached)
    return int(reached[done])
