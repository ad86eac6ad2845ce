"""What the robot knows of itself and its task from the beginning."""

from __future__ import annotations

import math

import msgspec

from bus.grid import Grid


class Ring(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """The sonar ring the robot carries: what it is built of, not how well it hears today."""

    transducers: int = 24
    half_angle_rad: float = math.radians(15.0)
    nearest_m: float = 0.15
    farthest_m: float = 10.7


class Recalled(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A junction that is recalled from an earlier day: of which type, and how certainly."""

    place: int
    junction_type: int
    certain: float


class MayBeAt(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """An intersection that may be the first LDP, and how probable that is beforehand."""

    place: int
    probability: float


class Recall(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a robot knows of its building that has lost its place in it (paper, section 2)."""

    places: tuple[Recalled, ...]
    may_be_at: tuple[MayBeAt, ...]


class Facts(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """All that a module is told before the run; of the building, nothing but the grid's size.

    ``start`` is the intersection of the LDP it first drives to, with ``heading``: the landmark
    on which it is registered (paper, section 6). A robot that has lost its place has ``recall``
    instead, and ``start`` is then the likeliest of what may be. ``corridor_width_m`` is nominal;
    ``wedges`` is how many the space about a port is divided into (:mod:`bus.features`).
    """

    columns: int
    rows: int
    start: int
    heading: int
    speed_m_s: float
    corridor_width_m: float = 2.0
    ring: Ring = Ring()
    wedges: int = 8
    recall: Recall | msgspec.UnsetType = msgspec.UNSET

    @property
    def grid(self) -> Grid:
        """The grid lines the building is registered on."""
        return Grid(self.columns, self.rows)
