"""Non-crossing partial partitions: which plugs of a frontier are used, and which are connected.

A frontier cuts the grid along a line. Each place on it either carries no corridor or carries
one that belongs to a component of the part already swept. The grid is planar, so components
cannot cross on the line: the states are the non-crossing partial partitions of the places
(A. R. Conway and A. J. Guttmann, J. Phys. A 29, 1996, use the like for lattice animals).

A partition is a row of labels, 0 for an empty place, components numbered from 1 in the order
of their first place.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb

import numpy as np
from numpy.typing import NDArray

Labels = NDArray[np.uint8]
Keys = NDArray[np.int64]
Indices = NDArray[np.int64]


def partition_count(places: int) -> int:
    """How many non-crossing partial partitions there are: the sum of C(n, k) Catalan(k).

    This is sequence A007317 of the OEIS: 1, 2, 5, 15, 51, 188, 731 for 0, 1, 2, ... places.
    """
    return sum(comb(places, k) * comb(2 * k, k) // (k + 1) for k in range(places + 1))


def canonical(labels: Labels) -> Labels:
    """The same partitions (partitions, places), numbered in the order of first places."""
    count, places = labels.shape
    rows = np.arange(count)
    renamed = np.zeros((count, int(labels.max(initial=0)) + 1), np.uint8)
    used = np.zeros(count, np.uint8)
    result = np.zeros_like(labels)
    for place in range(places):
        label = labels[:, place]
        fresh = (label > 0) & (renamed[rows, label] == 0)
        used += fresh
        renamed[rows[fresh], label[fresh]] = used[fresh]
        result[:, place] = renamed[rows, label]
    return result


def keys_of(labels: Labels) -> Keys:
    """One integer a partition, four bits a place; equal for equal canonical labels only."""
    shifts = 4 * np.arange(labels.shape[1], dtype=np.int64)
    keys: Keys = (labels.astype(np.int64) << shifts).sum(axis=1)
    return keys


@dataclass(frozen=True)
class Partitions:
    """All non-crossing partial partitions of some places, in the order of their keys.

    `labels` has shape (partitions, places); the first row is the empty partition.
    """

    labels: Labels
    keys: Keys

    @classmethod
    def of(cls, places: int) -> Partitions:
        """All partitions of so many places (at most 15: four bits a label)."""
        labels = _generate(places)
        keys = keys_of(labels)
        order = np.argsort(keys)
        return cls(labels[order], keys[order])

    def rank(self, labels: Labels) -> Indices:
        """The row of each of these partitions, which need not be canonical."""
        rows: Indices = np.searchsorted(self.keys, keys_of(canonical(labels)))
        return rows


def _generate(places: int) -> Labels:
    """All partitions, place by place.

    A component may be met again only while no component that began later must still go on:
    the open components form a stack, held here as one bit a label. To meet a component again
    closes those above it.
    """
    labels = np.zeros((1, 0), np.uint8)
    used = np.zeros(1, np.int64)
    stack = np.zeros(1, np.int64)
    for place in range(places):
        grown = [(np.pad(labels, ((0, 0), (0, 1))), used, stack)]
        for label in range(1, place + 2):
            rows = np.flatnonzero((stack >> label & 1 == 1) | (used + 1 == label))
            longer = np.pad(labels[rows], ((0, 0), (0, 1)), constant_values=label)
            below = (2 << label) - 1
            grown.append(
                (longer, np.maximum(used[rows], label), (stack[rows] | 1 << label) & below)
            )
        labels = np.concatenate([g[0] for g in grown])
        used = np.concatenate([g[1] for g in grown])
        stack = np.concatenate([g[2] for g in grown])
    return labels
