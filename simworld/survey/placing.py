"""From upright ways and grid lines to the corridors and junctions of a grid."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TypeAlias

import numpy as np

from bus.grid import DIRECTIONS, EAST, NORTH, STEP
from simworld.survey.lines import Lines, across_m
from simworld.survey.net import Net, Way
from simworld.survey.result import Corridor, Junction, Place, Position
from simworld.survey.straighten import runs_east

Pair: TypeAlias = tuple[Place, Place]


def corridor_widths(
    net: Net, widths_m: Mapping[Way, float], lines: Lines
) -> tuple[dict[Pair, float], list[str]]:
    """The width of each corridor by its ends, and what was left out, in words.

    A way that passes grid lines is a corridor from each to the next. Left out are ways whose ends
    lie on one intersection.
    """
    found: dict[Pair, float] = {}
    left_out = []
    for way in net.ways:
        pairs = _pairs(way, lines)
        if not pairs:
            x, y = way.path_m[0]
            left_out.append(f"too short for a grid line: {x:.1f}, {y:.1f}, {way.length_m:.1f} m")
        for pair in pairs:
            found[pair] = max(found.get(pair, 0.0), widths_m[way])
    return dict(sorted(found.items())), left_out


def _pairs(way: Way, lines: Lines) -> list[Pair]:
    a, b = sorted((lines.column[end], lines.row[end]) for end in way.ends)
    dx, dy = STEP[EAST if runs_east(way) else NORTH]
    steps = (b[0] - a[0]) * dx + (b[1] - a[1]) * dy
    return [
        ((a[0] + k * dx, a[1] + k * dy), (a[0] + (k + 1) * dx, a[1] + (k + 1) * dy))
        for k in range(steps)
    ]


def used_lines(corridors: Mapping[Pair, float]) -> tuple[list[int], list[int]]:
    """The numbers of the columns and rows that have a junction."""
    places = [place for ends in corridors for place in ends]
    return sorted({x for x, _ in places}), sorted({y for _, y in places})


def junctions_of(net: Net, lines: Lines, corridors: Mapping[Pair, float]) -> tuple[Junction, ...]:
    """The junctions by place, on the lines that are used."""
    columns, rows = used_lines(corridors)
    at_m = _measured(net, lines)
    found = []
    for x, y in sorted({place for ends in corridors for place in ends}):
        at = at_m.get((x, y))
        off_m = None if at is None else math.dist(at, (lines.columns_m[x], lines.rows_m[y]))
        place = columns.index(x), rows.index(y)
        found.append(Junction(place, _type((x, y), corridors), at, off_m))
    return tuple(found)


def corridors_of(lines: Lines, corridors: Mapping[Pair, float]) -> tuple[Corridor, ...]:
    """The corridors by their ends, on the lines that are used."""
    columns, rows = used_lines(corridors)
    return tuple(
        Corridor(
            ends=(
                (columns.index(ax), rows.index(ay)),
                (columns.index(bx), rows.index(by)),
            ),
            length_m=(lines.columns_m[bx] - lines.columns_m[ax])
            + (lines.rows_m[by] - lines.rows_m[ay]),
            width_m=width_m,
        )
        for ((ax, ay), (bx, by)), width_m in corridors.items()
    )


def _type(place: Place, corridors: Mapping[Pair, float]) -> int:
    bits = 0
    for direction in DIRECTIONS:
        dx, dy = STEP[direction]
        a, b = sorted((place, (place[0] + dx, place[1] + dy)))
        bits |= direction * ((a, b) in corridors)
    return bits


def _measured(net: Net, lines: Lines) -> dict[Place, Position]:
    """Where the plan shows each intersection: where the ways that meet there would cross."""
    at: dict[Place, list[Position]] = {}
    across: dict[Place, tuple[list[float], list[float]]] = {}
    for number, position in net.places.items():
        at.setdefault((lines.column[number], lines.row[number]), []).append(position)
    for way in net.ways:
        axis = 1 if runs_east(way) else 0
        for end in way.ends:
            place = lines.column[end], lines.row[end]
            across.setdefault(place, ([], []))[axis].append(across_m(way, axis))
    measured = {}
    for place, positions in at.items():
        xs, ys = across.get(place, ([], []))
        measured[place] = (
            float(np.mean(xs or [x for x, _ in positions])),
            float(np.mean(ys or [y for _, y in positions])),
        )
    return measured
