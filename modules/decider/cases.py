"""What errands take where the robot may be in several places, driven in maps of each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bus.grid import JUNCTION_TYPES
from modules.decider.as_if_kernels import Frames, look_along, order_costs
from modules.decider.frames import frames_of
from modules.decider.hypotheses import Hypotheses
from modules.decider.situation import Situation

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Looked:
    """What comes of looking along a route first.

    ``after_s`` (acts, cases) with the look's time, ``shows`` (outcomes, cases): what it shows is
    where it ended and the type found there, as probable as the registration's maps have it.
    """

    after_s: Floats
    shows: Floats
    drives: int


@dataclass(frozen=True, eq=False)
class Cases:
    """Every registration with every map of it: what may be, and how probable it is.

    ``weights`` (registrations,) sum to one; ``hypotheses`` are the maps of each, given the type
    of the junction where all of them stand. Acts are orders of registrations: each of them first,
    the others by their weight.
    """

    situations: Sequence[Situation]
    weights: Floats
    hypotheses: Sequence[Hypotheses]
    junction_type: int

    @cached_property
    def frames(self) -> Frames:
        """How the registrations lie to one another, and what each is sure of."""
        return frames_of(self.situations, self.junction_type)

    @cached_property
    def of(self) -> Ints:
        """(cases,): the registration of each."""
        return np.repeat(np.arange(len(self.weights)), [len(h.maps) for h in self.hypotheses])

    @cached_property
    def maps(self) -> NDArray[np.uint8]:
        """(cases, corridors)."""
        return np.concatenate([h.maps for h in self.hypotheses])

    @cached_property
    def shares(self) -> Floats:
        """(cases,): of its registration's probability."""
        return np.concatenate([h.weights for h in self.hypotheses])

    @property
    def probability(self) -> Floats:
        """(cases,): they sum to one."""
        found: Floats = self.weights[self.of] * self.shares
        return found

    @cached_property
    def orders(self) -> Ints:
        """(acts, registrations): as if at which one first, and then."""
        by_weight = np.argsort(-self.weights, kind="stable").tolist()
        return np.array([[a, *[b for b in by_weight if b != a]] for a in by_weight], np.int64)

    @property
    def _goal(self) -> int:
        return self.situations[0].goals[0]

    @property
    def _places(self) -> Ints:
        return np.array([s.place for s in self.situations], np.int64)[self.of]

    def act_s(self) -> tuple[Floats, int]:
        """(acts, cases): what each act takes at once, and the drives it took to find out."""
        return self._acting(self._places, np.zeros(len(self.of)))

    def _acting(self, places: Ints, spent: Floats) -> tuple[Floats, int]:
        costs = np.empty((len(self.orders), len(self.of)))
        drives = order_costs(
            self.frames, self.orders, self.of, self.maps, places, self._goal, spent, costs
        )
        return costs, int(drives)

    def looked(self, route: Ints) -> Looked | None:
        """Drive direction numbers in every case, look at the junction there, and act.

        None for a way that may pass the errand's end: to go there is to act.
        """
        n = len(self.of)
        places, spent, codes = np.empty(n, np.int64), np.empty(n), np.empty(n, np.int64)
        types = self.situations[0].grid.junction_types(self.maps)
        for k, start in enumerate(self._places.tolist()):
            at, spent[k], driven, passed = look_along(
                self.frames, route, int(self.of[k]), self.maps[k], start, self._goal
            )
            if passed:
                return None
            places[k] = at
            codes[k] = driven * JUNCTION_TYPES + int(types[k, at])
        after_s, drives = self._acting(places, spent)
        return Looked(after_s, self._shows(codes), drives)

    def _shows(self, codes: Ints) -> Floats:
        """(outcomes, cases): how probable each code is by the registration of each case."""
        outcomes, which = np.unique(codes, return_inverse=True)
        by_registration = np.zeros((len(outcomes), len(self.weights)))
        np.add.at(by_registration, (which, self.of), self.shares)
        return by_registration[:, self.of]
