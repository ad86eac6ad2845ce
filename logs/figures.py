"""The building as a figure: what stands still is drawn here, what moves by the page's script.

It is SVG whose colours come from the page's style by class, so that it follows the reader's
choice of light or dark.
"""

from __future__ import annotations

from bus.grid import Grid
from bus.messages import TrueBuilding

MARGIN = 0.1
"""Room around the building for labels, as a share of its larger side."""


def building_figure(building: TrueBuilding) -> str:
    """The corridors that exist as outlined floor, and a line for the belief in each of the grid.

    The lines, the robot and what else moves are told apart by their ids; the page's script
    sets them. One unit is a metre; y is turned upside down, as SVG counts it downward.
    """
    grid = Grid(len(building.columns_m), len(building.rows_m))
    ends = [_ends_m(building, grid, corridor) for corridor in range(grid.corridors)]
    x, y = building.columns_m, building.rows_m
    room_m = MARGIN * float(max(x[-1] - x[0], y[-1] - y[0])) + building.corridor_width_m
    left_m, top_m = float(x[0]) - room_m, -float(y[-1]) - room_m
    wide_m = float(x[-1] - x[0]) + 2 * room_m
    high_m = float(y[-1] - y[0]) + 2 * room_m
    half_m = building.corridor_width_m / 2
    there = [end for end, exists in zip(ends, building.corridors.tolist(), strict=True) if exists]
    outlines = [_floor(end, half_m + 0.15, "wall") for end in there]
    floors = [_floor(end, half_m, "floor") for end in there]
    lines = [_belief_line(corridor, end) for corridor, end in enumerate(ends)]
    moving = (
        '<path id="past"/><path id="rays"/><path id="hits"/>'
        '<g id="goal" hidden><circle r="1"/><path d="M0 0V-3.2L2.2 -2.5L0 -1.8"/></g>'
        '<g id="person" hidden><circle r="0.6"/><path d="M-.7 -1.1L0 -1.9L.7 -1.1"/></g>'
        '<g id="robot"><path d="M2 0L.5 .87L.5 -.87Z"/><circle r="1"/></g>'
    )
    size = max(wide_m, high_m)
    return (
        f'<svg id="map" role="img" aria-labelledby="map-title map-words" '
        f'data-size="{size:g}" viewBox="{left_m:g} {top_m:g} {wide_m:g} {high_m:g}">'
        '<title id="map-title">The building and the robot in it</title>'
        '<desc id="map-words">The corridors that exist are outlined; what the robot believes of '
        "each is told by the table of corridors below.</desc>"
        f"{''.join((*outlines, *floors, *lines))}{moving}</svg>"
    )


def _ends_m(building: TrueBuilding, grid: Grid, corridor: int) -> tuple[float, float, float, float]:
    (ax, ay), (bx, by) = (grid.place(end) for end in grid.ends(corridor))
    x, y = building.columns_m, building.rows_m
    return float(x[ax]), -float(y[ay]), float(x[bx]), -float(y[by])


def _floor(ends: tuple[float, float, float, float], half_m: float, kind: str) -> str:
    ax, ay, bx, by = ends
    left, top = min(ax, bx) - half_m, min(ay, by) - half_m
    wide, high = abs(bx - ax) + 2 * half_m, abs(by - ay) + 2 * half_m
    return f'<rect class="{kind}" x="{left:g}" y="{top:g}" width="{wide:.6g}" height="{high:.6g}"/>'


def _belief_line(corridor: int, ends: tuple[float, float, float, float]) -> str:
    ax, ay, bx, by = ends
    return (
        f'<line id="corridor-{corridor}" class="belief" '
        f'x1="{ax:g}" y1="{ay:g}" x2="{bx:g}" y2="{by:g}"/>'
        f'<text id="chance-{corridor}" class="chance" x="{(ax + bx) / 2:g}" y="{(ay + by) / 2:g}"/>'
    )
