"""What the robot knows of itself and its task from the beginning."""

from __future__ import annotations

import msgspec

from bus.grid import Grid


class Facts(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """All that a module is told before the run; of the building, nothing but the grid's size.

    ``start`` is the intersection of the LDP it first drives to, with ``heading``: the landmark
    on which it is registered (paper, section 6). ``corridor_width_m`` is nominal.
    """

    columns: int
    rows: int
    start: int
    heading: int
    speed_m_s: float
    corridor_width_m: float = 2.0

    @property
    def grid(self) -> Grid:
        """The grid lines the building is registered on."""
        return Grid(self.columns, self.rows)
