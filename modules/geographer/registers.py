"""What a sweep must remember beside the frontier, for evidence that is not local.

Two things: how many corridors there are so far, for a prior on their number; and, for each pair
of neighbours with entangled evidence, the class of the first until the second is met
(:mod:`modules.geographer.pairs`). The classes of all pairs that are open together are one *label*,
the first opened being the most significant digit.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from math import prod

import numpy as np
from numpy.typing import NDArray

from modules.geographer.evidence import Evidence
from modules.geographer.pairs import Link
from modules.geographer.sweep import Sweep

Floats = NDArray[np.float64]
Labels = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Registers:
    """The registers' moves.

    Step s has `labels[s]` labels and `counts[s]` numbers of corridors before it, `labels[s + 1]`
    and `counts[s + 1]` after it. By step: `moves[s]` (labels, 4, 4) the next label by label, enter
    and leave code; `factors[s]` the like-shaped factors of pairs that close. `final` (counts,) is
    the weight of each number of corridors at the end; `counting` whether they are counted at all.
    """

    labels: list[int]
    counts: list[int]
    moves: list[Labels]
    factors: list[Floats]
    final: Floats
    counting: bool

    @classmethod
    def of(cls, sweep: Sweep, evidence: Evidence) -> Registers:
        """The registers that this evidence needs."""
        open_links = _open_links(sweep, evidence)
        steps = [_step(step, *open_links[step : step + 2]) for step in range(sweep.steps)]
        return cls(
            [_size(links) for links in open_links],
            _counts(sweep, evidence),
            [moves for moves, _ in steps],
            [factors for _, factors in steps],
            np.ones(1) if evidence.counts is None else evidence.counts[: _most(evidence) + 1],
            evidence.counts is not None,
        )


def register_values(sweep: Sweep, evidence: Evidence) -> list[int]:
    """How many values the registers have before each step and at the end."""
    labels = [_size(links) for links in _open_links(sweep, evidence)]
    return [label * count for label, count in zip(labels, _counts(sweep, evidence), strict=True)]


def _open_links(sweep: Sweep, evidence: Evidence) -> list[list[Link]]:
    """The links whose class is remembered before each step and at the end."""
    return [
        [link for link in evidence.entangled if link.start < step <= link.end]
        for step in range(sweep.steps + 1)
    ]


def _counts(sweep: Sweep, evidence: Evidence) -> list[int]:
    """How many numbers of corridors there may be before each step and at the end."""
    if evidence.counts is None:
        return [1] * (sweep.steps + 1)
    met = np.cumsum((sweep.north >= 0).astype(int) + (sweep.east >= 0)).tolist()
    return [min(n, _most(evidence)) + 1 for n in [0, *met]]


def _most(evidence: Evidence) -> int:
    """The largest number of corridors that the prior allows."""
    assert evidence.counts is not None
    return int(np.flatnonzero(evidence.counts).max(initial=0))


def _size(links: list[Link]) -> int:
    return prod(len(link.rows) for link in links)


def _step(step: int, before: list[Link], after: list[Link]) -> tuple[Labels, Floats]:
    """The moves and factors (labels before, 4, 4) of one step."""
    moves = np.zeros((_size(before), 16), np.int64)
    factors = np.ones((_size(before), 16))
    for label, digits in enumerate(product(*(range(len(link.rows)) for link in before))):
        remembered = dict(zip(map(id, before), digits, strict=True))
        for link in after:
            digit = link.classes if link.start == step else remembered[id(link)]
            moves[label] = moves[label] * len(link.rows) + digit
        for link in before:
            if link.end == step:
                factors[label] *= link.rows[remembered[id(link)]]
    return moves.reshape(-1, 4, 4), factors.reshape(-1, 4, 4)
