"""The features that detectors look for, and the wedges in which they look (paper, section 3).

"As Huey exits a port, a local coordinate system is set up with its origin on the imaginary line
defined by the exit port and centered in the corridor. The space about the origin enclosing the
LDP is divided into a set of equi-angular wedges W." Here x is ahead and y to the left, both in
half corridor widths, so that the junction is the square x 0..2, y -1..1. Wedge k of n is centred
k * 360/n degrees counter-clockwise.

A junction has ten places where a feature may be, and each belongs to the wedge that holds its
bearing from the origin, the one further back where it lies between two:

=====================  ==========  =======  ==============================================
place                  at          bearing  which features may be there
=====================  ==========  =======  ==============================================
far side               (2, 0)      0        opening, flat wall
far corners            (2, +-1)    26.6     flat wall, convex corner, concave corner
sides                  (1, +-1)    45       opening, flat wall, door jamb
near corners           (0, +-1)    90       flat wall, convex corner
walls behind           (-1, +-1)   135      flat wall, door jamb
the corridor behind    (-1, 0)     180      opening
=====================  ==========  =======  ==============================================

With 8 wedges these are in 0, 1, 1, 2, 3 and 4 (on the right 7, 7, 6 and 5). What is there follows
from the sides of the junction that meet at the place, each a way or a wall:

- where one side is, an opening if it is a way, else a flat wall;
- at a corner of two sides, a convex corner if both are ways, a flat wall if one is (it runs on
  through the place), a concave corner if neither is;
- in a wall, a door jamb perhaps: the junction's type does not say it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

from bus.grid import LEFT_OF, OPPOSITE, RIGHT_OF

FEATURES = ("opening", "flat_wall", "convex_corner", "concave_corner", "door_jamb")
OPENING, FLAT_WALL, CONVEX_CORNER, CONCAVE_CORNER, DOOR_JAMB = range(5)

AHEAD, LEFT, BEHIND, RIGHT = range(4)
"""Sides of a junction as its robot sees them, in quarter turns counter-clockwise."""

FEWEST, MOST = 4, 360
"""Numbers of wedges that can be: with fewer than four a side and the way ahead are one wedge."""

_BETWEEN = 1e-9
"""Wedges: a bearing so close to the line between two lies on it."""


class WedgeError(ValueError):
    """A number of wedges that there cannot be, or a feature, wedge or detector that is none."""


@dataclass(frozen=True)
class Place:
    """A place of the junction where a feature may be.

    ``x`` and ``y`` are in half corridor widths; ``sides`` are those of the junction that meet
    there: one is a way or a wall, two a corner between ways and walls, none is a wall always;
    ``holds`` are the features that may be there.
    """

    x: float
    y: float
    sides: tuple[int, ...]
    holds: tuple[int, ...]

    @property
    def bearing_deg(self) -> float:
        """From the origin, counter-clockwise, 0 to 180 to either side."""
        return math.degrees(math.atan2(self.y, self.x))

    def shows(self, feature: int, junction_type: int, heading: int) -> bool | None:
        """Whether a feature is here at a junction entered by a heading; None: it may be.

        Never one that the place cannot hold.
        """
        if feature not in self.holds:
            return False
        directions = (heading, LEFT_OF[heading], OPPOSITE[heading], RIGHT_OF[heading])
        ways = sum(bool(junction_type & directions[side]) for side in self.sides)
        walls = len(self.sides) - ways
        if feature == DOOR_JAMB:
            return False if ways else None
        return {
            OPENING: walls == 0,
            FLAT_WALL: walls == 1 or not self.sides,
            CONVEX_CORNER: walls == 0,
            CONCAVE_CORNER: walls == 2,
        }[feature]

    @property
    def mirrored(self) -> Place:
        """The same place on the other side of the axis."""
        sides = tuple({LEFT: RIGHT, RIGHT: LEFT}.get(side, side) for side in self.sides)
        return Place(self.x, -self.y, sides, self.holds)


FAR_SIDE = Place(2, 0, (AHEAD,), (OPENING, FLAT_WALL))
FAR_LEFT = Place(2, 1, (LEFT, AHEAD), (FLAT_WALL, CONVEX_CORNER, CONCAVE_CORNER))
LEFT_SIDE = Place(1, 1, (LEFT,), (OPENING, FLAT_WALL, DOOR_JAMB))
NEAR_LEFT = Place(0, 1, (LEFT, BEHIND), (FLAT_WALL, CONVEX_CORNER))
WALL_LEFT = Place(-1, 1, (), (FLAT_WALL, DOOR_JAMB))
WAY_BEHIND = Place(-1, 0, (BEHIND,), (OPENING,))
FAR_RIGHT, RIGHT_SIDE = FAR_LEFT.mirrored, LEFT_SIDE.mirrored
NEAR_RIGHT, WALL_RIGHT = NEAR_LEFT.mirrored, WALL_LEFT.mirrored
ON_THE_LEFT = (FAR_LEFT, LEFT_SIDE, NEAR_LEFT, WALL_LEFT)
ON_THE_AXIS = (FAR_SIDE, WAY_BEHIND)
PLACES = (*ON_THE_AXIS, *ON_THE_LEFT, *(place.mirrored for place in ON_THE_LEFT))


@dataclass(frozen=True)
class Wedges:
    """The circle in ``count`` equal wedges, and the detectors d_{f,w} that there are.

    Raises WedgeError for a number that is not FEWEST to MOST.
    """

    count: int = 8

    def __post_init__(self) -> None:
        if not FEWEST <= self.count <= MOST:
            raise WedgeError(f"wedges: found {self.count}, expected {FEWEST} to {MOST}")

    @property
    def detectors(self) -> int:
        """How many detectors there are."""
        return len(FEATURES) * self.count

    @property
    def behind(self) -> int:
        """The wedge of the corridor that the robot came by; the left one of two."""
        return self.count // 2

    def code(self, feature: int, wedge: int) -> int:
        """The code of detector d_{f,w}, ``feature * count + wedge``. Raises WedgeError."""
        self.check(feature, wedge)
        return feature * self.count + wedge

    def parts(self, detector: int) -> tuple[int, int]:
        """Feature and wedge of a detector's code. Raises WedgeError."""
        if not 0 <= detector < self.detectors:
            raise WedgeError(f"detectors are 0..{self.detectors - 1}, got {detector}")
        return divmod(detector, self.count)

    def check(self, feature: int, wedge: int) -> None:
        """Raise WedgeError unless there is such a feature and wedge."""
        if not (0 <= feature < len(FEATURES) and 0 <= wedge < self.count):
            raise WedgeError(
                f"features are 0..{len(FEATURES) - 1} and wedges 0..{self.count - 1}, "
                f"got feature {feature}, wedge {wedge}"
            )

    def middle_rad(self, wedge: int) -> float:
        """The bearing of a wedge's middle, counter-clockwise from ahead."""
        return 2.0 * math.pi * wedge / self.count

    def holding(self, place: Place) -> int:
        """The wedge that holds a place."""
        off = abs(place.bearing_deg) * self.count / 360.0
        wedge = min(math.floor(off + 0.5 + _BETWEEN), self.behind)
        return wedge if place.y >= 0 else -wedge % self.count

    def place(self, feature: int, wedge: int) -> Place | None:
        """The place that X_{f,w} is about, None where the wedge holds no place.

        Of several, one that may hold the feature, the nearest to the wedge's middle. A wide wedge
        astride the axis may hold places on both sides of it: those are left out, since one
        detector cannot look at both. Raises WedgeError.
        """
        self.check(feature, wedge)
        return _place(self, feature, wedge)


USUAL = Wedges()
"""As many as there are unless somebody says otherwise."""


@cache
def _place(wedges: Wedges, feature: int, wedge: int) -> Place | None:
    held = [place for place in PLACES if wedges.holding(place) == wedge]
    if any(place in ON_THE_AXIS for place in held):
        held = [place for place in held if place in ON_THE_AXIS]
    middle_deg = 360.0 * wedge / wedges.count

    def worse(place: Place) -> tuple[bool, float]:
        off_deg = abs(math.remainder(place.bearing_deg - middle_deg, 360.0))
        return feature not in place.holds, off_deg

    return min(held, key=worse, default=None)
