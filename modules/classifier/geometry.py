"""Which features a junction shows in which wedge: Pr(X|J), determined by the geometry.

The robot exits a port heading into the LDP (paper, section 3). Where in the local frame features
may be, which wedge holds each place, and which of them follow from the junction's type says
:mod:`bus.features`. Door jambs do not follow from it: they may be in any wall, with a probability.
The walls behind are beyond the junction itself, in the corridor that the robot came by.
"""

from __future__ import annotations

import math
from functools import cache
from itertools import product

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


@cache
def presence_table(wedges: Wedges = USUAL) -> NDArray[np.float64]:
    """Pr(X=1|J) for every heading and type: (headings N E S W, types, features, wedges).

    As :func:`presence` has it, but for corners of corridors that may have doorways.
    """
    table = np.array(
        [[_with_doorways(j, h, wedges) for j in range(JUNCTION_TYPES)] for h in DIRECTIONS]
    )
    table.flags.writeable = False
    return table


def _with_doorways(junction_type: int, heading: int, wedges: Wedges) -> NDArray[np.float64]:
    """Pr(X=1|J), summed over which of the corridors ahead and beside have doorways."""
    certain = presence(junction_type, heading, wedges)
    ways = [d for d in DIRECTIONS if junction_type & d and d != OPPOSITE[heading]]
    summed = np.zeros_like(certain)
    for doors in product((False, True), repeat=len(ways)):
        walls = sum(d for d, door in zip(ways, doors, strict=True) if door)
        share = math.prod(DOORWAY_RATE if door else 1 - DOORWAY_RATE for door in doors)
        summed += share * presence(junction_type & ~walls, heading, wedges)
    places = (wedges.place(feature, wedge) for feature, wedge in np.ndindex(certain.shape))
    at_corner = np.array([place is not None and len(place.sides) > 1 for place in places])
    return np.where(at_corner.reshape(certain.shape), summed, certain)


def enterable(heading: int) -> NDArray[np.bool_]:
    """Which junction types have the corridor that a robot with this heading came by: (16,).

    Raises HeadingError.
    """
    heading_number(heading)
    return np.array([bool(j & OPPOSITE[heading]) for j in range(JUNCTION_TYPES)])
