"""Where the corridors and junctions of a building are on its floor."""

from __future__ import annotations

from dataclasses import dataclass

from bus.grid import DIRECTIONS, EAST, NORTH, STEP, Grid
from bus.messages import MapBelief, TrueBuilding

Point = tuple[float, float]


@dataclass(frozen=True)
class Floor:
    """The grid of a building, and where its intersections are, in metres."""

    grid: Grid
    columns_m: tuple[float, ...]
    rows_m: tuple[float, ...]
    width_m: float

    @staticmethod
    def of(building: TrueBuilding) -> Floor:
        """The floor of a building."""
        columns_m, rows_m = building.columns_m.tolist(), building.rows_m.tolist()
        grid = Grid(len(columns_m), len(rows_m))
        return Floor(grid, tuple(columns_m), tuple(rows_m), building.corridor_width_m)

    def carries(self, belief: MapBelief) -> bool:
        """Whether a belief is about the grid of this floor."""
        grid = self.grid
        places = (grid.rows, grid.columns)
        return belief.corridors.shape == (grid.corridors,) and belief.junctions.shape[:2] == places

    def position_m(self, intersection: int) -> Point:
        """The centre of an intersection."""
        x, y = self.grid.place(intersection)
        return self.columns_m[x], self.rows_m[y]

    def corridor_m(self, corridor: int) -> tuple[Point, Point]:
        """The centre line of a corridor, from the edge of one junction to that of the other."""
        first, second = self.grid.ends(corridor)
        (x0, y0), (x1, y1) = self.position_m(first), self.position_m(second)
        half = self.width_m / 2
        if y0 == y1:
            return (x0 + half, y0), (x1 - half, y1)
        return (x0, y0 + half), (x1, y1 - half)

    def walls_m(self, corridors: list[int]) -> list[tuple[Point, Point]]:
        """The walls round the corridors of a map, and those that close its junctions."""
        walls: list[tuple[Point, Point]] = []
        for corridor in range(self.grid.corridors):
            if corridors[corridor]:
                walls += self._sides(corridor)
        for intersection in range(self.grid.intersections):
            walls += self._closed_sides(intersection, corridors)
        return walls

    def _sides(self, corridor: int) -> list[tuple[Point, Point]]:
        (x0, y0), (x1, y1) = self.corridor_m(corridor)
        half = self.width_m / 2
        dx, dy = (0.0, half) if y0 == y1 else (half, 0.0)
        return [((x0 + s * dx, y0 + s * dy), (x1 + s * dx, y1 + s * dy)) for s in (1.0, -1.0)]

    def _closed_sides(self, intersection: int, corridors: list[int]) -> list[tuple[Point, Point]]:
        x, y = self.grid.place(intersection)
        leaving = {d: self.grid.corridor(x, y, d) for d in DIRECTIONS}
        closed = [d for d, corridor in leaving.items() if corridor < 0 or not corridors[corridor]]
        if len(closed) == len(DIRECTIONS):
            return []  # no junction here
        return [self._side(intersection, d) for d in closed]

    def _side(self, intersection: int, direction: int) -> tuple[Point, Point]:
        x, y = self.position_m(intersection)
        dx, dy = STEP[direction]
        half = self.width_m / 2
        middle_x, middle_y = x + half * dx, y + half * dy
        along = STEP[NORTH if dx else EAST]
        return (
            (middle_x - half * along[0], middle_y - half * along[1]),
            (middle_x + half * along[0], middle_y + half * along[1]),
        )
