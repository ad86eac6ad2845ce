"""What a sonar cone hears of a round thing: range and whether it is heard at all.

A transducer hears the nearest point inside its cone. A thing that only grazes the cone is
heard a little further off than its nearest point, and that difference between neighbouring
transducers is what tells on which side of the centre line a person walks.
"""

from __future__ import annotations

import math
from typing import NamedTuple, TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

from bus.facts import Ring

Floats: TypeAlias = NDArray[np.float64]

AHEAD_RAD = math.radians(35.0)
"""A transducer looks ahead if its axis is no further than this from straight ahead."""

FEWEST = 3
"""So many must look ahead, or left and right cannot be told apart."""

NARROWEST_RAD = math.atan2(0.25, 3.8)
"""Half of the narrowest cone. Who walks just in the robot's way, his shoulder 0.25 m off the
middle, must be heard straight ahead when there is time left: 2.75 s at a walking pace, 3.8 m."""


class RingError(ValueError):
    """A sonar ring that does not see ahead."""


class Cones(NamedTuple):
    """The cones of the transducers that look ahead; a *cone* is an index into the first two.

    ``numbers`` (cones,) are the transducers, straight ahead first, then by pairs, the left one
    first; ``edges`` (cones, 4) unit vectors along the left and the right edge of each. The ring
    hears as far as ``farthest_m``, with ``transducers`` in all.
    """

    numbers: NDArray[np.int64]
    edges: Floats
    farthest_m: float
    transducers: int


def cones_ahead(ring: Ring) -> Cones:
    """The cones that look ahead. Raises RingError for a ring that sees too little ahead."""
    step_rad = 2.0 * math.pi / ring.transducers
    beside = int((AHEAD_RAD + 1e-9) / step_rad)
    numbers = [0] + [sign * k for k in range(1, beside + 1) for sign in (1, -1)]
    if len(set(numbers)) < FEWEST or ring.half_angle_rad < NARROWEST_RAD:
        raise RingError(
            f"found a ring of {ring.transducers} transducers with cones of "
            f"{math.degrees(ring.half_angle_rad):g} degrees to each side, of which {len(numbers)} "
            f"look ahead; expected {FEWEST} within {math.degrees(AHEAD_RAD):g} degrees and cones "
            f"of at least {math.degrees(NARROWEST_RAD):.1f} degrees to each side"
        )
    axes = np.array(numbers) * step_rad
    left, right = axes + ring.half_angle_rad, axes - ring.half_angle_rad
    edges = np.stack([np.cos(left), np.sin(left), np.cos(right), np.sin(right)], axis=1)
    return Cones(np.array(numbers), edges, ring.farthest_m, ring.transducers)


USUAL = cones_ahead(Ring())
"""Those of the ring that a robot carries unless the scenario says otherwise."""


@njit(cache=True)
def heard_in_cone(
    ahead_m: float, left_m: float, radius_m: float, edges: Floats, cone: int
) -> tuple[float, bool]:
    """Range to a disc's nearest point in a cone at the origin, and whether the cone holds any.

    ``ahead_m`` and ``left_m`` are the disc's centre in the robot's frame (x ahead, y left);
    ``edges`` as of :class:`Cones`. Where nothing is heard the range is of no use.
    """
    away = math.sqrt(ahead_m * ahead_m + left_m * left_m)
    if away < radius_m * 1.0001:  # inside the disc: as if at its rim
        return 0.0001 * radius_m, ahead_m > 0.0
    beyond_left = edges[cone, 0] * left_m - edges[cone, 1] * ahead_m
    beyond_right = edges[cone, 3] * ahead_m - edges[cone, 2] * left_m
    if beyond_left <= 0.0 and beyond_right <= 0.0:
        return away - radius_m, True
    if beyond_left > 0.0:
        along = edges[cone, 0] * ahead_m + edges[cone, 1] * left_m
        inside = radius_m * radius_m - beyond_left * beyond_left
    else:
        along = edges[cone, 2] * ahead_m + edges[cone, 3] * left_m
        inside = radius_m * radius_m - beyond_right * beyond_right
    if inside < 0.0 or along < 0.0:
        return along, False
    return along - math.sqrt(inside), True
