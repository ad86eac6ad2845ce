"""Which features a junction shows in which wedge: Pr(X|J), determined by the geometry.

The robot exits a port heading into the LDP (paper, section 3). Where in the local frame features
may be, which wedge holds each place, and which of them follow from the junction's type says
:mod:`bus.features`. Door jambs do not follow from it: they may be in any wall, with a probability.
The walls behind are beyond the junction itself, in the corridor that the robot came by.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from bus.features import FEATURES, USUAL, Wedges
from bus.grid import DIRECTIONS, JUNCTION_TYPES, OPPOSITE

JAMB_RATE = 0.2
"""Pr(door jamb|a wall is there): offices of five metres have a door each, and a doorway counts if
its middle is within a metre of wall, half to either side of the place (assumption)."""


DOORWAY_RATE = 0.1
"""Pr(it is entered through a doorway|a corridor is there): then walls run on at its corners, and it
opens in their middle all the same (assumption; three of the six rungs of the SRI K-wing are so)."""


class HeadingError(ValueError):
    """A heading that is not one of the four direction bits."""


def heading_number(heading: int) -> int:
    """The place of a heading (direction bit) in N, E, S, W. Raises HeadingError."""
    if heading not in DIRECTIONS:
        raise HeadingError(f"a heading is one of {DIRECTIONS} (N, E, S, W), got {heading}")
    return DIRECTIONS.index(heading)


def presence(junction_type: int, heading: int, wedges: Wedges = USUAL) -> NDArray[np.float64]:
    """Pr(X_{f,w}=1|J) at a junction entered by a heading: (features, wedges).

    The robot came by the corridor behind it, so a type without that corridor cannot be where
    it is: for such a type no feature is present, not even the opening behind, which is
    therefore the evidence that rules the type out. All but door jambs is certain.

    Raises HeadingError.
    """
    heading_number(heading)
    found = np.zeros((len(FEATURES), wedges.count))
    if not junction_type & OPPOSITE[heading]:
        return found
    for feature, wedge in np.ndindex(found.shape):
        place = wedges.place(feature, wedge)
        if place is not None:
            shown = place.shows(feature, junction_type, heading)
            found[feature, wedge] = JAMB_RATE if shown is None else shown
    return found


@dataclass(frozen=True)
class Layout:
    """A junction's type, and which of its ways begin with a doorway: direction bits both."""

    type: int
    doorways: int


@cache
def layouts(heading: int) -> tuple[Layout, ...]:
    """All that a robot with this heading may come to, 27, by type: it came through no doorway.

    Raises HeadingError.
    """
    return tuple(
        Layout(junction_type, doorways)
        for junction_type in np.flatnonzero(enterable(heading)).tolist()
        for doorways in range(JUNCTION_TYPES)
        if doorways & (junction_type & ~OPPOSITE[heading]) == doorways
    )


def share(layout: Layout, heading: int) -> float:
    """Pr(doorways|type): each of the ways ahead and beside has one or not."""
    ways = (layout.type & ~OPPOSITE[heading]).bit_count()
    doors = layout.doorways.bit_count()
    return float(DOORWAY_RATE**doors * (1.0 - DOORWAY_RATE) ** (ways - doors))


@cache
def shares(heading: int) -> NDArray[np.float64]:
    """:func:`share` of every layout, in their order: (layouts,)."""
    found = np.array([share(layout, heading) for layout in layouts(heading)])
    found.flags.writeable = False
    return found


@cache
def members(heading: int) -> NDArray[np.float64]:
    """1 where a layout is of a type that can be entered: (layouts, types), types in order."""
    types = np.array([layout.type for layout in layouts(heading)])
    same = types[:, None] == np.flatnonzero(enterable(heading))
    found: NDArray[np.float64] = same.astype(np.float64)
    found.flags.writeable = False
    return found


def shown(layout: Layout, heading: int, wedges: Wedges = USUAL) -> NDArray[np.float64]:
    """Pr(X_{f,w}=1|layout): (features, wedges).

    Beside a doorway walls run on at the corners; in the middle of its side there is an opening.
    """
    open_sides = presence(layout.type, heading, wedges)
    walls_run_on = presence(layout.type & ~layout.doorways, heading, wedges)
    places = [wedges.place(feature, wedge) for feature, wedge in np.ndindex(open_sides.shape)]
    corner = np.array([place is not None and len(place.sides) > 1 for place in places])
    return np.where(corner.reshape(open_sides.shape), walls_run_on, open_sides)


@cache
def presence_table(wedges: Wedges = USUAL) -> NDArray[np.float64]:
    """Pr(X=1|J) for every heading and type: (headings N E S W, types, features, wedges).

    Summed over the layouts of each type. Features at corners beside the same way are not
    independent given the type: a doorway tells of all of them.
    """
    table = np.zeros((len(DIRECTIONS), JUNCTION_TYPES, len(FEATURES), wedges.count))
    for number, heading in enumerate(DIRECTIONS):
        for layout in layouts(heading):
            seen = shown(layout, heading, wedges)
            table[number, layout.type] += share(layout, heading) * seen
    table.flags.writeable = False
    return table


def enterable(heading: int) -> NDArray[np.bool_]:
    """Which junction types have the corridor that a robot with this heading came by: (16,).

    Raises HeadingError.
    """
    heading_number(heading)
    return np.array([bool(j & OPPOSITE[heading]) for j in range(JUNCTION_TYPES)])
