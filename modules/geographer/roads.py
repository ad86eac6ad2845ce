"""How long corridors take, as far as driving them has taught.

All corridors between the same two grid lines are equally long, so each drive measures a whole
row or column of them. What was never driven is taken to be average.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bus.grid import Grid

FIRST_GUESS_S = 240.0
"""About four minutes between two LDPs (paper, section 5)."""


@dataclass(frozen=True, eq=False)
class Roads:
    """Mean drive times between neighbouring grid lines, and how many drives they rest on."""

    grid: Grid
    total_s: NDArray[np.float64]
    drives: NDArray[np.int64]

    def _gap(self, corridor: int) -> int:
        """Which pair of neighbouring lines a corridor joins: columns first, then rows."""
        if corridor < self.grid.east_corridors:
            return corridor % (self.grid.columns - 1)
        row = (corridor - self.grid.east_corridors) // self.grid.columns
        return self.grid.columns - 1 + row

    def driven(self, corridor: int, drive_s: float) -> Roads:
        """Roads after one more drive."""
        gap = self._gap(corridor)
        total_s, drives = self.total_s.copy(), self.drives.copy()
        total_s[gap] += drive_s
        drives[gap] += 1
        return replace(self, total_s=total_s, drives=drives)

    def corridor_s(self) -> NDArray[np.float64]:
        """Expected drive time of every corridor, (corridors,)."""
        known = self.drives > 0
        average = float(self.total_s.sum() / self.drives.sum()) if known.any() else FIRST_GUESS_S
        gap_s = np.where(known, self.total_s / np.maximum(self.drives, 1), average)
        return np.array([gap_s[self._gap(c)] for c in range(self.grid.corridors)])


def unknown_roads(grid: Grid) -> Roads:
    """Roads before any drive."""
    gaps = grid.columns + grid.rows - 2
    return Roads(grid, np.zeros(gaps), np.zeros(gaps, np.int64))
