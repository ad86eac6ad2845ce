"""A survey in words, as JSON and as a scenario file."""

from __future__ import annotations

import json
import math
from pathlib import Path
from statistics import median
from typing import Any

from rich.console import Console
from rich.table import Table

from bus.grid import LETTER, type_name
from simworld.settings import Place
from simworld.survey import Junction, Survey

OFF_GRID_M = 1.5
"""A junction further from its grid lines than this, a corridor's width, is worth a warning: what is
one line here may be two corridors."""

NARROWEST_M, WIDEST_M = 1.5, 2.2
"""The robot's detectors are made for corridors of about these widths (paper, section 2: 1.5 to
2 m); a scenario's corridors all have one width."""


def survey_facts(survey: Survey) -> dict[str, Any]:
    """The survey as JSON holds it: metres and degrees, places as [x, y]."""
    return {
        "turn_deg": math.degrees(survey.turn_rad),
        "columns_m": survey.columns_m,
        "rows_m": survey.rows_m,
        "junctions": [
            {
                "place": j.place,
                "type": j.type,
                "corridors": type_name(j.type),
                "at_m": j.at_m,
                "off_m": j.off_m,
            }
            for j in survey.junctions
        ],
        "corridors": [
            {"ends": c.ends, "length_m": c.length_m, "width_m": c.width_m} for c in survey.corridors
        ],
        "left_out": survey.left_out,
    }


def say_survey(survey: Survey, console: Console) -> None:
    """Print what was found."""
    console.print(
        f"{len(survey.junctions)} junctions, {len(survey.corridors)} corridors; upright when "
        f"turned by {math.degrees(survey.turn_rad):+.2f} degrees; positions are in that frame",
        soft_wrap=True,
    )
    console.print(f"columns at x = {_metres(survey.columns_m)} m", soft_wrap=True)
    console.print(f"rows    at y = {_metres(survey.rows_m)} m", soft_wrap=True)
    console.print(_junction_table(survey))
    console.print(_corridor_table(survey))
    off = [junction for junction in survey.junctions if (junction.off_m or 0.0) > OFF_GRID_M]
    if off:
        console.print(
            f"off the grid: {', '.join(_place(j.place) for j in off)} lie more than {OFF_GRID_M:g} "
            f"m from where their lines cross. The building is no clean grid, or open rooms were "
            f"taken for corridors: look at --picture, close doors (--doors), try --door-stub",
            soft_wrap=True,
            markup=False,
        )
    for what in survey.left_out:
        console.print(f"left out: {what}", soft_wrap=True, markup=False)


def _metres(values: tuple[float, ...]) -> str:
    return ", ".join(f"{round(value, 1) + 0.0:.1f}" for value in values)  # no -0.0


def _junction_table(survey: Survey) -> Table:
    table = Table("junction", "corridors", "seen at, m", "off the grid lines, m", box=None)
    for junction in survey.junctions:
        table.add_row(_place(junction.place), type_name(junction.type), *_seen(junction))
    return table


def _seen(junction: Junction) -> tuple[str, str]:
    if junction.at_m is None or junction.off_m is None:
        return "passed by", "-"
    return f"{junction.at_m[0]:.1f}, {junction.at_m[1]:.1f}", f"{junction.off_m:.2f}"


def _corridor_table(survey: Survey) -> Table:
    table = Table("corridor", "length, m", "width, m", box=None)
    for corridor in survey.corridors:
        a, b = corridor.ends
        ends = f"{_place(a)} - {_place(b)}"
        table.add_row(ends, f"{corridor.length_m:.1f}", f"{corridor.width_m:.2f}")
    return table


def _place(place: tuple[int, int]) -> str:
    return f"[{place[0]}, {place[1]}]"


def scenario_text(survey: Survey, source: Path, plan: Path | None) -> str:
    """A scenario file of the building, made to be corrected by hand.

    ``source`` is what was surveyed, ``plan`` the map file that its echoes may come from.
    """
    echoes = (
        f"""\
# Take this in to hear the echoes of the plan itself, instead of those of bare corridors:
# floor_plan = {json.dumps(str(plan.resolve()))}
"""
        if plan
        else ""
    )
    return f"""\
about = {json.dumps(f"A building surveyed from {source.name}")}
seed = 1
epoch = 2026-01-01T00:00:00Z

# Found by `waywiser map` in {json.dumps(str(source))}: turned by
# {math.degrees(survey.turn_rad):+.2f} degrees to stand upright, corridors {_widths(survey)} m wide.
# Places are [x, y] from the south-west. Correct here by hand what the survey took for a corridor,
# or missed; all corridors must stay connected.
{_world(survey)}{echoes}
[random_errands]
count = 6
expected_again = 3.0

# A real building sounds unlike the halls of the calibration. What one visit found is looked into
# again on the next ones, whatever a mistake would cost the errands; quicker errands without.
[modules.classifier]
heeds_stakes = false
wrong_type_s = 300_000.0

[compute]
profile = "host"
"""


def playback_text(survey: Survey, log: Path, start: tuple[Place, int] | None) -> str:
    """A scenario file that plays back a CARMEN log in the building surveyed from it.

    ``start`` is the junction that the recorded robot comes to first, and its heading.
    """
    first = (
        f"start = {{ junction = {_place(start[0])}, heading = {json.dumps(LETTER[start[1]])} }}\n"
        if start
        else ""
    )
    return f"""\
about = {json.dumps(f"What a real robot sensed, from {log.name}")}
seed = 1
epoch = 2026-01-01T00:00:00Z

{_world(survey)}{first}carmen = {json.dumps(str(log.resolve()))}

[compute]
profile = "host"
"""


def _world(survey: Survey) -> str:
    """The table of the building, open at its end for more keys."""
    width_m = median(corridor.width_m for corridor in survey.corridors)
    corridors = ",\n".join(
        f"    [{_place(a)}, {_place(b)}]" for a, b in (c.ends for c in survey.corridors)
    )
    return f"""\
[world]
columns_m = [{_metres(survey.columns_m)}]
rows_m = [{_metres(survey.rows_m)}]
corridors = [
{corridors},
]
corridor_width_m = {min(max(width_m, NARROWEST_M), WIDEST_M):.1f}
"""


def _widths(survey: Survey) -> str:
    widths = [corridor.width_m for corridor in survey.corridors]
    return f"{min(widths):.1f} to {max(widths):.1f}"
