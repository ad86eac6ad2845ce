"""A picture of a survey over its plan: one SVG file with the plan's image in it."""

from __future__ import annotations

import base64
import io
import math

import numpy as np
from PIL import Image

from bus.grid import type_name
from simworld.floor_plan import FloorPlan
from simworld.survey import Survey

FREE, UNKNOWN, OCCUPIED = 255, 215, 0


def survey_svg(survey: Survey) -> str:
    """The upright plan with grid lines, corridors and junctions; a metre is a unit."""
    rows, columns = survey.plan.cells.free.shape
    side_m = survey.plan.cells.resolution_m
    corners = [
        survey.plan.to_world(u, v) for u in (0.0, columns * side_m) for v in (0.0, rows * side_m)
    ]
    west, east = min(x for x, _ in corners), max(x for x, _ in corners)
    south, north = min(y for _, y in corners), max(y for _, y in corners)
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{west:.2f} {-north:.2f} '
            f'{east - west:.2f} {north - south:.2f}" font-family="sans-serif" font-size="1.2">',
            '<g transform="scale(1,-1)">',
            _image(survey.plan),
            *(_line(x, south, x, north, "grid") for x in survey.columns_m),
            *(_line(west, y, east, y, "grid") for y in survey.rows_m),
            *(_path(path) for path in survey.paths_m),
            *_corridors(survey),
            "</g>",
            *_names(survey),
            "</svg>\n",
        ]
    )


STYLES = {
    "grid": 'stroke="#69c" stroke-width="0.08" stroke-dasharray="0.6 0.4"',
    "corridor": 'stroke="#c33" stroke-width="0.35" stroke-opacity="0.6"',
}


def _image(plan: FloorPlan) -> str:
    cells = plan.cells
    grey = np.where(cells.occupied, OCCUPIED, np.where(cells.free, FREE, UNKNOWN))
    png = io.BytesIO()
    Image.fromarray(grey[::-1].astype(np.uint8)).save(png, "PNG", optimize=True)
    data = base64.b64encode(png.getvalue()).decode()
    (rows, columns), side_m = grey.shape, cells.resolution_m
    c, s = math.cos(plan.turn_rad), math.sin(plan.turn_rad)
    x, y = plan.origin_m
    return (
        f'<g transform="matrix({c:.6f} {s:.6f} {-s:.6f} {c:.6f} {x:.3f} {y:.3f})">'
        f'<image transform="matrix({side_m} 0 0 {-side_m} 0 {rows * side_m:.3f})" '
        f'width="{columns}" height="{rows}" style="image-rendering:pixelated" '
        f'href="data:image/png;base64,{data}"/></g>'
    )


def _line(x0: float, y0: float, x1: float, y1: float, style: str) -> str:
    return f'<line x1="{x0:.2f}" y1="{y0:.2f}" x2="{x1:.2f}" y2="{y1:.2f}" {STYLES[style]}/>'


def _path(path_m: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> str:
    points = " ".join(f"{x:.2f},{y:.2f}" for x, y in path_m)
    return f'<polyline points="{points}" fill="none" stroke="#393" stroke-width="0.15"/>'


def _corridors(survey: Survey) -> list[str]:
    def at(place: tuple[int, int]) -> tuple[float, float]:
        return survey.columns_m[place[0]], survey.rows_m[place[1]]

    return [_line(*at(c.ends[0]), *at(c.ends[1]), "corridor") for c in survey.corridors]


def _names(survey: Survey) -> list[str]:
    """A dot where each junction is seen, and its place and type beside it."""
    marks = []
    for junction in survey.junctions:
        column, row = junction.place
        x, y = junction.at_m or (survey.columns_m[column], survey.rows_m[row])
        marks.append(f'<circle cx="{x:.2f}" cy="{-y:.2f}" r="0.4" fill="#c33"/>')
        words = f"{column},{row} {type_name(junction.type)}"
        marks.append(f'<text x="{x + 0.7:.2f}" y="{-y - 0.7:.2f}" fill="#006">{words}</text>')
    return marks
