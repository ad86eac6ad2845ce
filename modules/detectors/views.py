"""Where each detector d_{f,w} looks from, where to, and which surfaces it looks for.

The local frame is the paper's (section 3): the origin on the imaginary line of the exit port,
centred in the corridor, +x ahead, +y left; wedge k is centred k * 45 degrees
counter-clockwise. Sonar hears a smooth wall only near its normal, and a corner from anywhere,
so there are two kinds of view, each from a vantage half a corridor's width from its walls:

- *square on* a side: a wall answers along the normal and a little beside it, an open side
  does not answer;
- *at a corner*, 45 degrees to the walls that may meet there: a corner answers, a wall that runs
  on does not; the walls beside it answer 45 degrees to the left and right of the view, both of
  them by a concave corner, one by a wall that runs on, none by a convex corner.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from bus.features import CONVEX_CORNER, FEATURES, WEDGES


class DetectorError(ValueError):
    """A feature, wedge, width or set of echoes that no detector can work with."""


@dataclass(frozen=True)
class View:
    """A vantage on the corridor's axis and the direction faced there.

    ``vantage`` is its x in half corridor widths; ``facing_rad`` is relative to the heading on
    exit from the port; ``at_corner`` tells the two kinds of view apart.
    """

    vantage: float
    facing_rad: float
    at_corner: bool


def _square_on(vantage: float, facing_deg: float) -> View:
    return View(vantage, math.radians(facing_deg), at_corner=False)


def _at_corner(facing_deg: float) -> View:
    return View(1.0, math.radians(facing_deg), at_corner=True)


_SQUARE_ON = {
    0: _square_on(1.0, 0.0),
    1: _square_on(1.0, 90.0),
    3: _square_on(-1.0, 90.0),
    4: _square_on(0.0, 180.0),
    5: _square_on(-1.0, -90.0),
    7: _square_on(1.0, -90.0),
}
_NEAR_CORNERS = {2: _at_corner(135.0), 6: _at_corner(-135.0)}
_FAR_CORNERS = {1: _at_corner(45.0), 7: _at_corner(-45.0)}


def check_detector(feature: int, wedge: int) -> None:
    """Raise DetectorError unless there is a detector for this feature and wedge."""
    if not (0 <= feature < len(FEATURES) and 0 <= wedge < WEDGES):
        raise DetectorError(
            f"features are 0..{len(FEATURES) - 1} and wedges 0..{WEDGES - 1}, "
            f"got feature {feature}, wedge {wedge}"
        )


def detector_code(feature: int, wedge: int) -> int:
    """The code of a detector, ``feature * wedges + wedge``. Raises DetectorError."""
    check_detector(feature, wedge)
    return feature * WEDGES + wedge


def view_of(feature: int, wedge: int) -> View:
    """Where detector d_{f,w} looks from and to. Raises DetectorError.

    In wedges 1 and 7 an opening or a wall is looked for in the middle of the side, a convex
    corner at the far corner. Wedges 3 and 5 are seen from behind the port, wedge 4 from the
    port, the others from the centre of the junction.
    """
    check_detector(feature, wedge)
    if feature == CONVEX_CORNER and wedge in _FAR_CORNERS:
        return _FAR_CORNERS[wedge]
    return _NEAR_CORNERS.get(wedge) or _SQUARE_ON[wedge]
