"""What was observed, laid on the grid as a registration says: one place where the robot may be.

A robot that knows where it is has one registration; one that has lost its place has several, each
with a record of its own. What was seen is counted once in each, and a registration that it leads
off the grid, or that an errand's end contradicts, drops out.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import msgspec
import numpy as np
from numpy.typing import NDArray

from bus.facts import Facts
from bus.grid import OPPOSITE
from modules.geographer.record import Record, neighbour, nothing, recalled
from modules.geographer.roads import Roads, unknown_roads

Floats = NDArray[np.float64]


class LostError(ValueError):
    """No registration is left: what was observed last, and where the robot was thought to be."""


@dataclass(frozen=True, eq=False)
class Registration:
    """One answer to where the robot is, and all that was observed if it is the right one.

    ``place`` is the intersection where the robot stands, or that it left last; ``ahead`` the one
    that it drives to. ``log_prior`` is that of the registration, before anything was observed.
    """

    log_prior: float
    record: Record
    roads: Roads
    place: int
    ahead: int

    def departed(self, heading: int, *, first: bool) -> Registration | None:
        """It drives that way, so there is a corridor; None where that leads off the grid.

        The ``first`` drive begins in a corridor, on the way to the place where it is put.
        """
        grid = self.record.grid
        ahead = self.place if first else neighbour(grid, self.place, heading)
        behind = grid.corridor(*grid.place(ahead), OPPOSITE[heading]) if ahead >= 0 else -1
        if behind < 0:
            return None
        return replace(self, ahead=ahead, record=self.record.with_corridor(behind, exists=True))

    def arrived(self) -> Registration:
        """It is at the place that it drove to."""
        return replace(self, place=self.ahead)

    def drove(self, heading: int, drive_s: float) -> Registration:
        """It came through a corridor from the place that it left."""
        grid = self.record.grid
        corridor = grid.corridor(*grid.place(self.place), heading)
        return replace(self, roads=self.roads.driven(corridor, drive_s))

    def classified(self, likelihood: Floats) -> Registration:
        """A visit's likelihood of the junction where it stands."""
        return replace(self, record=self.record.with_junction(self.place, likelihood))

    def blocked(self, heading: int) -> Registration:
        """It found a wall where it meant to leave. There is none to be learnt of off the grid."""
        grid = self.record.grid
        corridor = grid.corridor(*grid.place(self.place), heading)
        if corridor < 0:
            return self
        return replace(self, record=self.record.with_corridor(corridor, exists=False))


def registrations_of(facts: Facts) -> tuple[Registration, ...]:
    """Where the robot may be before anything is observed."""
    grid, recall = facts.grid, facts.recall
    if recall is msgspec.UNSET:
        return (_at(facts.start, 0.0, nothing(grid)),)
    record = recalled(grid, recall.places)
    return tuple(_at(one.place, math.log(one.probability), record) for one in recall.may_be_at)


def _at(place: int, log_prior: float, record: Record) -> Registration:
    return Registration(log_prior, record, unknown_roads(record.grid), place, place)


def those_left(
    found: Iterable[Registration | None], of: tuple[Registration, ...], seen: str
) -> tuple[Registration, ...]:
    """The registrations that what was ``seen`` leaves. Raises LostError where there is none."""
    left = tuple(one for one in found if one is not None)
    if not left:
        places = ", ".join(str(list(one.record.grid.place(one.place))) for one in of)
        raise LostError(f"found {seen}, which the robot's place leaves out: it was at {places}")
    return left


def weights(log_prior: Floats, log_evidence: Floats) -> Floats:
    """P(registration | observations): prior times evidence, normalised; logs, both (n,).

    ``log_evidence`` is what the belief over all maps returns for the observations placed as each
    registration says. Raises LostError where none is possible.
    """
    logs = log_prior + log_evidence
    most = logs.max(initial=-np.inf)
    if not np.isfinite(most):
        raise LostError(f"found log weights {logs.tolist()}, expected a finite one")
    found = np.exp(logs - most)
    shares: Floats = found / found.sum()
    return shares
