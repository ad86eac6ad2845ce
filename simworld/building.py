"""Office buildings on a grid: what exists, where it is, and the outline of the free space.

The paper (section 3) assumes that "the system of junctions and corridors that make up Huey's
environment can be registered on a grid" and (section 2) that a corridor is bounded "by
uninterrupted parallel surfaces 1.5 to 2 meters apart". So a building here is a map of
:class:`bus.grid.Grid` with metres: a square at each intersection that has a corridor, and a
straight corridor of the same width between two squares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from bus.grid import Grid

_Scalar = TypeVar("_Scalar", bound=np.generic)


class BuildingError(ValueError):
    """The description of a building does not describe one."""


@dataclass(frozen=True, eq=False)
class Building:
    """A building of corridors on a grid. Made by :func:`build`; its arrays are read-only.

    Lengths are metres, x east and y north (ROS REP 103).

    - ``corridors``: (grid.corridors,), 1 where the corridor exists.
    - ``walls``: (n, 4), segments x0, y0, x1, y1 with the free space on their left.
    - ``corners``: (k, 2), the points where two walls meet, convex and concave.
    """

    grid: Grid
    columns_m: tuple[float, ...]
    rows_m: tuple[float, ...]
    corridor_width_m: float
    corridors: NDArray[np.uint8]
    walls: NDArray[np.float64]
    corners: NDArray[np.float64]

    def truth_type(self, x: int, y: int) -> int:
        """The junction type (4 bits, N=1, E=2, S=4, W=8) of intersection (x, y)."""
        types = self.grid.junction_types(self.corridors[None, :])
        return int(types[0, self.grid.intersection(x, y)])

    def position_m(self, x: int, y: int) -> tuple[float, float]:
        """Where the centre of intersection (x, y) is, in metres."""
        return self.columns_m[x], self.rows_m[y]

    def length_m(self, corridor: int) -> float:
        """From the centre of one end's junction to that of the other, in metres."""
        (x0, y0), (x1, y1) = (
            self.position_m(*self.grid.place(end)) for end in self.grid.ends(corridor)
        )
        return (x1 - x0) + (y1 - y0)

    def clearance_m(self, x_m: float, y_m: float) -> float:
        """Distance from a point to the nearest wall, in metres; negative outside the free space."""
        start, along = self.walls[:, :2], self.walls[:, 2:] - self.walls[:, :2]
        away = np.array([x_m, y_m]) - start
        share = np.clip((away * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
        nearest = float(np.linalg.norm(away - share[:, None] * along, axis=1).min())
        return nearest if self._contains(x_m, y_m) else -nearest

    def _contains(self, x_m: float, y_m: float) -> bool:
        """Even-odd rule along the ray to the east: only walls that run north or south count."""
        x0, y0, _, y1 = self.walls.T
        return bool(np.count_nonzero(((y0 > y_m) != (y1 > y_m)) & (x0 > x_m)) % 2)


def build(
    columns_m: Sequence[float],
    rows_m: Sequence[float],
    corridors: NDArray[np.uint8],
    corridor_width_m: float,
) -> Building:
    """The building whose corridors lie on the given grid lines.

    ``columns_m`` are the x of the grid lines that run north, ``rows_m`` the y of those that run
    east, both increasing; ``corridors`` is a map of that grid, (grid.corridors,) of 0 and 1.
    A dead end is closed by the far wall of its junction square.

    Raises BuildingError for a width that is not positive, grid lines that do not increase by more
    than a corridor's width (the corridor between two junction squares needs a length), a map of
    the wrong shape or with other values, and a map that is empty or not connected.
    """
    grid = Grid(len(columns_m), len(rows_m))
    if not (np.isfinite(corridor_width_m) and corridor_width_m > 0.0):
        raise BuildingError(f"corridor_width_m: found {corridor_width_m}, expected more than 0")
    _check_lines("columns_m", columns_m, corridor_width_m)
    _check_lines("rows_m", rows_m, corridor_width_m)
    present = _checked_map(grid, corridors)
    edges_x = _edges(columns_m, corridor_width_m)
    edges_y = _edges(rows_m, corridor_width_m)
    solid_around = np.pad(_free_cells(grid, present), 1)
    return Building(
        grid=grid,
        columns_m=tuple(float(v) for v in columns_m),
        rows_m=tuple(float(v) for v in rows_m),
        corridor_width_m=float(corridor_width_m),
        corridors=_frozen(present),
        walls=_frozen(_outline(solid_around, edges_x, edges_y)),
        corners=_frozen(_corners(solid_around, edges_x, edges_y)),
    )


def random_connected(grid: Grid, density: float, rng: np.random.Generator) -> NDArray[np.uint8]:
    """A random connected map that has ``density`` of the grid's corridors, at least one.

    Grown from one corridor by adding, again and again, one that touches the map. The paper
    (section 3) measures density as the share of possible edges and prefers a medium one; about
    0.6 is medium. Raises BuildingError unless 0 < density <= 1.
    """
    if not 0.0 < density <= 1.0:
        raise BuildingError(f"density: found {density}, expected more than 0 and at most 1")
    present = np.zeros(grid.corridors, dtype=np.uint8)
    ends = np.array([grid.ends(c) for c in range(grid.corridors)])
    reached = np.zeros(grid.intersections, dtype=np.bool_)
    may_join = np.ones(grid.corridors, dtype=np.bool_)
    for _ in range(max(1, round(density * grid.corridors))):
        chosen = int(rng.choice(np.flatnonzero(may_join)))
        present[chosen] = 1
        reached[ends[chosen]] = True
        may_join = reached[ends].any(axis=1) & (present == 0)
    return present


def _check_lines(name: str, lines_m: Sequence[float], width_m: float) -> None:
    for k, (low, high) in enumerate(pairwise(lines_m)):
        if not high > low:
            raise BuildingError(
                f"{name}: found {low} then {high} at {k} and {k + 1}, expected increasing lines"
            )
        if not high - low > width_m:
            raise BuildingError(
                f"{name}: lines {k} and {k + 1} are {high - low:g} m apart, expected more than "
                f"the corridor width of {width_m:g} m, for junction squares leave no corridor"
            )
    if not np.all(np.isfinite(lines_m)):
        raise BuildingError(f"{name}: found {list(lines_m)}, expected finite numbers")


def _checked_map(grid: Grid, corridors: NDArray[np.uint8]) -> NDArray[np.uint8]:
    found = np.asarray(corridors)
    if found.shape != (grid.corridors,):
        raise BuildingError(
            f"corridors: found shape {found.shape}, expected ({grid.corridors},) on a grid of "
            f"{grid.columns} by {grid.rows}"
        )
    if not np.isin(found, (0, 1)).all():
        raise BuildingError(f"corridors: found {found.tolist()}, expected 0 and 1 only")
    present = found.astype(np.uint8)
    if not present.any():
        raise BuildingError("corridors: found none, expected at least one")
    if not grid.connected(present):
        raise BuildingError(
            f"corridors: found {np.flatnonzero(present).tolist()} in more than one component, "
            "expected a connected map"
        )
    return present


def _edges(lines_m: Sequence[float], width_m: float) -> NDArray[np.float64]:
    """Both sides of each line's corridor: between them lie, in turn, squares and corridors."""
    lines = np.asarray(lines_m, dtype=np.float64)
    return np.column_stack([lines - width_m / 2, lines + width_m / 2]).ravel()


def _free_cells(grid: Grid, present: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Which cells between the edges are free, [y, x]: even indices lie on grid lines."""
    free = np.zeros((2 * grid.rows - 1, 2 * grid.columns - 1), dtype=np.bool_)
    for corridor in np.flatnonzero(present):
        (x0, y0), (x1, y1) = (grid.place(end) for end in grid.ends(int(corridor)))
        free[2 * y0 : 2 * y1 + 1, 2 * x0 : 2 * x1 + 1] = True
    return free


def _outline(
    free: NDArray[np.bool_], edges_x: NDArray[np.float64], edges_y: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The walls between free and solid cells; ``free`` has a solid margin of one cell."""
    # A wall lies on an edge where the cells on its two sides differ. Left of north is west.
    cells = free.astype(np.int8)
    rise = (cells[:, 1:] - cells[:, :-1])[1:-1, :]
    climb = (cells[1:, :] - cells[:-1, :])[:, 1:-1]
    walls = [
        (x, edges_y[a], x, edges_y[b]) for k, x in enumerate(edges_x) for a, b in _runs(-rise[:, k])
    ]
    walls += [
        (edges_x[a], y, edges_x[b], y) for k, y in enumerate(edges_y) for a, b in _runs(climb[k, :])
    ]
    return np.array(walls, dtype=np.float64)


def _runs(sides: NDArray[np.int8]) -> list[tuple[int, int]]:
    """Maximal runs of equal non-zero sides as (from, to); turned about where the side is -1."""
    bounds = [0, *(np.flatnonzero(np.diff(sides)) + 1).tolist(), len(sides)]
    runs = [(a, b) for a, b in pairwise(bounds) if sides[a]]
    return [(a, b) if sides[a] > 0 else (b, a) for a, b in runs]


def _corners(
    free: NDArray[np.bool_], edges_x: NDArray[np.float64], edges_y: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Points with one or three free cells around them: the concave and the convex corners."""
    count = free.astype(np.int8)
    around = count[1:, 1:] + count[1:, :-1] + count[:-1, 1:] + count[:-1, :-1]
    j, i = np.nonzero(around % 2)
    return np.column_stack([edges_x[i], edges_y[j]])


def _frozen(array: NDArray[_Scalar]) -> NDArray[_Scalar]:
    array.setflags(write=False)
    return array
