"""The map command."""

from __future__ import annotations

import json
from pathlib import Path

from rich.console import Console

from scenarios.commands import BAD_INPUT, GOOD
from scenarios.say import refuse
from scenarios.survey_picture import survey_svg
from scenarios.survey_words import say_survey, scenario_text, survey_facts
from simworld.carmen import CarmenError
from simworld.floor_plan import FloorPlan, FloorPlanError, read_floor_plan
from simworld.occupancy import plan_of_log, write_floor_plan
from simworld.survey import Survey, SurveyError, read_doors, survey

IMAGE_SUFFIXES = (".pgm", ".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".gif")
MAP_SUFFIXES = (".yaml", ".yml")


class _WriteError(ValueError):
    """A file that cannot be written."""


def map_command(
    source: Path,
    picture: Path | None,
    scenario: Path | None,
    plan_file: Path | None,
    door_stub_m: float,
    doors: Path | None,
    as_json: bool,
) -> int:
    """Carry out ``waywiser map``; returns the exit status."""
    try:
        with Console(stderr=True, quiet=as_json).status(f"surveying {source.name}"):
            plan = _plan(source)
            if plan_file is not None:
                _write_plan(plan, plan_file)
            found = _survey(source, plan, door_stub_m, doors)
        map_file = source if source.suffix in MAP_SUFFIXES else plan_file
        if picture is not None:
            _write_picture(picture, found)
        if scenario is not None:
            _write(scenario, scenario_text(found, source, map_file))
    except (FloorPlanError, SurveyError, CarmenError, _WriteError) as error:
        return refuse(error, BAD_INPUT, as_json=as_json)
    written = {"plan": plan_file, "picture": picture, "scenario": scenario}
    files = {what: str(path) for what, path in written.items() if path is not None}
    if as_json:
        facts = {"status": GOOD, "source": str(source), **survey_facts(found), "written": files}
        print(json.dumps(facts))
        return GOOD
    console = Console(highlight=False)
    say_survey(found, console)
    for what, path in files.items():
        console.print(f"{what}: {path}", soft_wrap=True, markup=False)
    return GOOD


def _plan(source: Path) -> FloorPlan:
    if source.suffix.lower() in IMAGE_SUFFIXES:
        raise FloorPlanError(
            f"{source}: found an image, expected the YAML file of a ROS map that names it (image, "
            f"resolution, origin, negate, occupied_thresh, free_thresh), or a CARMEN log"
        )
    return read_floor_plan(source) if source.suffix in MAP_SUFFIXES else plan_of_log(source)


def _survey(source: Path, plan: FloorPlan, door_stub_m: float, doors: Path | None) -> Survey:
    closed = read_doors(doors) if doors is not None else ()
    try:
        return survey(plan, door_stub_m, closed)
    except SurveyError as error:
        raise SurveyError(f"{source}: {error}") from None


def _write_picture(path: Path, found: Survey) -> None:
    if path.suffix.lower() != ".svg":
        raise _WriteError(f"--picture {path}: found {path.suffix or 'no suffix'}, expected .svg")
    _write(path, survey_svg(found))


def _write_plan(plan: FloorPlan, path: Path) -> None:
    try:
        write_floor_plan(plan, path)
    except OSError as error:
        raise _WriteError(f"{path}: cannot be written ({error.strerror})") from None


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise _WriteError(f"{path}: cannot be written ({error.strerror})") from None
