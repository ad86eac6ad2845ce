"""Where each detector d_{f,w} looks from, where to, and which surfaces it looks for.

The local frame is the paper's (section 3), its places are those of :mod:`bus.features`. Sonar
hears a smooth wall only near its normal, and a corner from anywhere, so there are two kinds of
view, each from a vantage half a corridor's width from its walls:

- *square on* a side: a wall answers along the normal and a little beside it, an open side
  does not answer, the jambs of a doorway in the wall answer beside the normal;
- *at a corner*, 45 degrees to the walls that may meet there: a corner answers, a wall that runs
  on does not; the walls beside it answer 45 degrees to the left and right of the view, both of
  them by a concave corner, one by a wall that runs on, none by a convex corner.

Every d_{f,w} can be run. One whose wedge holds no place looks along the wedge's middle from the
port: there is nothing in the geometry that it could find, and the classifier never asks for it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from bus.features import (
    FAR_LEFT,
    FAR_RIGHT,
    FAR_SIDE,
    LEFT_SIDE,
    NEAR_LEFT,
    NEAR_RIGHT,
    RIGHT_SIDE,
    USUAL,
    WALL_LEFT,
    WALL_RIGHT,
    WAY_BEHIND,
    WedgeError,
    Wedges,
)


class DetectorError(ValueError):
    """A feature, wedge, width or set of echoes that no detector can work with."""


@dataclass(frozen=True)
class View:
    """A vantage on the corridor's axis and the direction faced there.

    ``vantage`` is its x in half corridor widths; ``facing_rad`` is relative to the heading on
    exit from the port; ``at_corner`` tells the two kinds of view apart. Having faced its target the
    robot drives ``approach`` half widths nearer before it pings.
    """

    vantage: float
    facing_rad: float
    at_corner: bool
    approach: float = 0.0


LOOKS_IN = 0.45
"""A side may be a corridor behind a doorway. From the axis the jambs of one 0.7 m wide answer as a
wall does; from 0.55 half widths away the cone of 15 degrees, swept by 3 to each side, passes
between them, if the robot is within 17 cm of the middle."""


def _square_on(vantage: float, facing_deg: float, approach: float = 0.0) -> View:
    return View(vantage, math.radians(facing_deg), at_corner=False, approach=approach)


def _at_corner(facing_deg: float) -> View:
    return View(1.0, math.radians(facing_deg), at_corner=True)


_VIEWS = {
    FAR_SIDE: _square_on(1.0, 0.0),
    LEFT_SIDE: _square_on(1.0, 90.0, LOOKS_IN),
    RIGHT_SIDE: _square_on(1.0, -90.0, LOOKS_IN),
    FAR_LEFT: _at_corner(45.0),
    FAR_RIGHT: _at_corner(-45.0),
    NEAR_LEFT: _at_corner(135.0),
    NEAR_RIGHT: _at_corner(-135.0),
    WALL_LEFT: _square_on(-1.0, 90.0),
    WALL_RIGHT: _square_on(-1.0, -90.0),
    WAY_BEHIND: _square_on(0.0, 180.0),
}
"""The walls behind are seen from behind the port, the way behind from the port, all else from
the centre of the junction."""


def view_of(feature: int, wedge: int, wedges: Wedges = USUAL) -> View:
    """Where detector d_{f,w} looks from and to. Raises DetectorError."""
    try:
        place = wedges.place(feature, wedge)
    except WedgeError as error:
        raise DetectorError(str(error)) from None
    if place is None:
        return View(0.0, wedges.middle_rad(wedge), at_corner=False)
    return _VIEWS[place]
