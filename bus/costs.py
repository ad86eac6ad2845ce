"""What computing costs: cells into simulated nanoseconds, as data.

A *cell* is one entry of a table that a handler touches, the measure of the paper's Table 1.
A profile is a line for each kind of work: so much for starting, so much a cell.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from types import MappingProxyType
from typing import Literal, TypeAlias

KINDS = (
    "echo",  # sensor: a firing of the ring
    "scan",  # detectors: an echo of a sensing action kept
    "interpret",  # detectors: echoes into a reading
    "sensing",  # classifier: which feature next
    "reading",  # classifier: a likelihood
    "belief",  # geographer: an update of the map
    "path",  # decider
    "track",  # reactor: a scan taken in
    "reaction",  # reactor: an act chosen
    "note",  # anything that only remembers
)


WhyStopped: TypeAlias = Literal["nothing left", "settled", "out of cells"]
"""Why an anytime procedure stopped: it has done all there is to do, more cannot be expected to
change the answer, or what comes next does not fit into the cells it was given."""


@dataclass(frozen=True)
class Rate:
    """What one kind of work costs: ``fixed_ns`` to begin, ``cell_ns`` a cell."""

    fixed_ns: float = 0.0
    cell_ns: float = 0.0


@dataclass(frozen=True)
class CostModel:
    """A compute profile, with what a scenario adds to some kinds to make them slower."""

    profile: str
    rates: Mapping[str, Rate] = field(default_factory=dict)
    extra_ns: Mapping[str, int] = field(default_factory=dict)

    def cost_ns(self, kind: str, cells: int) -> int:
        """Simulated time of ``cells`` cells of a kind of work. Whole nanoseconds."""
        rate = self.rates.get(kind, _FREE)
        return round(rate.fixed_ns + rate.cell_ns * cells) + self.extra_ns.get(kind, 0)

    def cells_within(self, kind: str, time_ns: int) -> int:
        """The most cells whose cost is within a time, at most UNLIMITED; -1 if none is."""
        # Asked of cost_ns itself: whatever it rounds, the answer fits and one more does not.
        sizes = range(UNLIMITED + 1)
        return bisect_right(sizes, time_ns, key=partial(self.cost_ns, kind)) - 1


_FREE = Rate()
UNLIMITED = 2**62

HUEY_CELL_NS = 948_000.0
HUEY_BELIEF_NS = 2_090_000_000.0
HUEY_COMPILED_NS = 10_000.0
"""A cell of a compiled table, against one of a general network: about a hundred instructions on
a workstation of 1990 with some ten million a second (assumption; the paper does not price it)."""

_HUEY = {
    "belief": Rate(HUEY_BELIEF_NS, HUEY_CELL_NS),
    "sensing": Rate(0.0, HUEY_CELL_NS),
    "reading": Rate(0.0, HUEY_CELL_NS),
    "path": Rate(0.0, HUEY_CELL_NS),
    "interpret": Rate(0.0, HUEY_COMPILED_NS),
    "track": Rate(0.0, HUEY_COMPILED_NS),
    "reaction": Rate(0.0, HUEY_COMPILED_NS),
    # echo, scan and note cost nothing: the sonar board and the base do them
}

PROFILES: Mapping[str, Mapping[str, Rate]] = MappingProxyType(
    {
        "free": {},
        # Fitted to the paper's Table 1: 2.09 s + 0.948 ms a cell of a belief update, r = 0.997.
        # What else is inference gets the same price a cell, and nothing to begin with.
        "huey-1990": MappingProxyType(_HUEY),
    }
)
