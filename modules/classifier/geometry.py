"""Which features a junction shows in which wedge: Pr(X|J), determined by the geometry.

The robot exits a port heading into the LDP (paper, section 3). The local frame has its
origin on the port line, centred in the corridor, +x ahead and +y left; the junction is the
square x 0..w, y -w/2..w/2, w the corridors' width. Eight wedges of 45 degrees, wedge k
centred k * 45 degrees counter-clockwise. A feature belongs to the wedge that holds its place:

=====  ==================================================================
wedge  holds
=====  ==================================================================
0      the far side of the square, at (w, 0)
1      the middle of the left side (w/2, w/2), at 45 degrees, and the
       far-left corner (w, w/2), at 26.6 degrees
2      the near-left corner (0, w/2), at 90 degrees
3      the left wall of the corridor behind
4      the corridor behind
5..7   as 3..1, on the right
=====  ==================================================================
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from bus.features import CONVEX_CORNER, FEATURES, FLAT_WALL, OPENING, WEDGES
from bus.grid import DIRECTIONS, JUNCTION_TYPES, LEFT_OF, OPPOSITE, RIGHT_OF


class HeadingError(ValueError):
    """A heading that is not one of the four direction bits."""


def heading_number(heading: int) -> int:
    """The place of a heading (direction bit) in N, E, S, W. Raises HeadingError."""
    if heading not in DIRECTIONS:
        raise HeadingError(f"a heading is one of {DIRECTIONS} (N, E, S, W), got {heading}")
    return DIRECTIONS.index(heading)


def features_present(junction_type: int, heading: int) -> NDArray[np.bool_]:
    """Which X_{f,w} hold at a junction entered by a heading: (features, wedges).

    The robot came by the corridor behind it, so a type without that corridor cannot be where
    it is: for such a type no feature is present, not even the opening in wedge 4, which is
    therefore the evidence that rules the type out. For the types that can be entered,

    - an opening is present ahead (0), left (1), right (7) where the corridor is, always
      behind (4), never in the other wedges;
    - a flat wall is present in 0, 1, 7 where no corridor is; in 2 and 6 where the side's wall
      runs on through the near corner's place, that is where the side is closed; always in 3
      and 5, never in 4;
    - a convex corner is present in 2 and 6 where the side is open, in 1 and 7 where both the
      side and the way ahead are open; nowhere else.

    Raises HeadingError.
    """
    heading_number(heading)
    present = np.zeros((len(FEATURES), WEDGES), dtype=np.bool_)
    if not junction_type & OPPOSITE[heading]:
        return present
    ahead = bool(junction_type & heading)
    left = bool(junction_type & LEFT_OF[heading])
    right = bool(junction_type & RIGHT_OF[heading])
    present[OPENING] = (ahead, left, False, False, True, False, False, right)
    present[FLAT_WALL] = (not ahead, not left, not left, True, False, True, not right, not right)
    present[CONVEX_CORNER] = (False, left & ahead, left, False, False, False, right, right & ahead)
    return present


@cache
def presence_table() -> NDArray[np.bool_]:
    """Pr(X=1|J) for every heading and type: (headings N E S W, types, features, wedges)."""
    table = np.array(
        [[features_present(j, h) for j in range(JUNCTION_TYPES)] for h in DIRECTIONS],
        dtype=np.bool_,
    )
    table.flags.writeable = False
    return table


def enterable(heading: int) -> NDArray[np.bool_]:
    """Which junction types have the corridor that a robot with this heading came by: (16,).

    Raises HeadingError.
    """
    return presence_table()[heading_number(heading), :, OPENING, WEDGES // 2]
