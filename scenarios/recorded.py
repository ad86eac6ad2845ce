"""The replay-carmen command: a real robot's log, played back to the processes."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from scenarios.draw import draw
from scenarios.ground import draw_ground, generator
from scenarios.launch import Prepared
from scenarios.launching import launch
from scenarios.run_record import Script
from scenarios.scenario import ScenarioError, check
from scenarios.survey_words import playback_text
from simworld.carmen import CarmenError, CarmenLog, read_carmen
from simworld.occupancy import plan_of_log
from simworld.playback import log_begins_s
from simworld.recording import moved_scans
from simworld.registration import Registration
from simworld.settings import Place
from simworld.survey import Survey, SurveyError, survey
from simworld.tour import tour


@dataclass(frozen=True)
class Asked:
    """What the command is given: the log, where the scenario goes, how much is played back."""

    log: Path
    scenario: Path | None
    until_s: float | None
    door_stub_m: float


def replay_carmen_command(asked: Asked, in_process: bool, log: str | None, as_json: bool) -> int:
    """Carry out ``waywiser replay-carmen``; returns the exit status."""

    def make() -> Prepared:
        with Console(stderr=True, quiet=as_json).status(f"surveying {asked.log.name}"):
            return prepare_recorded(asked)

    return launch(make, str(asked.log), in_process, log, as_json)


def prepare_recorded(asked: Asked) -> Prepared:
    """Survey the building in a log and make the scenario that plays it back.

    Raises ScenarioError.
    """
    name = str(asked.log)
    try:
        log = read_carmen(asked.log)
        found = survey(plan_of_log(asked.log), asked.door_stub_m)
        start = _start(log, found, asked.log)
    except CarmenError as error:
        raise ScenarioError(str(error)) from None
    except SurveyError as error:
        raise ScenarioError(f"{name}: {error}") from None
    text = playback_text(found, asked.log, start)
    if asked.scenario is not None:
        _write(asked.scenario, text)
    table = tomllib.loads(text)
    changes: tuple[str, ...] = ()
    if asked.until_s is not None:
        changes = (f"world.until_s={asked.until_s}",)
        table["world"]["until_s"] = asked.until_s
    scenario = check(table, name)
    return Prepared(Script(_stem(asked.log), text, changes, scenario), draw(scenario, name))


def _start(log: CarmenLog, found: Survey, path: Path) -> tuple[Place, int] | None:
    """The junction that the recorded robot comes to first, and its heading, if it comes to any."""
    bare = check(tomllib.loads(playback_text(found, path, None)), str(path))
    building = draw_ground(bare, generator(bare)).building
    laid = Registration(found.plan, found.turn_rad, (0.0, 0.0), 1.0)
    try:
        begins_s = log_begins_s(log)
    except CarmenError as error:
        raise CarmenError(f"{path}: {error}") from None
    stops = tour(moved_scans(log.scans, laid), begins_s, building)[1:2]
    return (building.grid.place(stops[0].place), stops[0].heading) if stops else None


def _stem(log: Path) -> str:
    return log.name.removesuffix(".gz").removesuffix(".log")


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise ScenarioError(
            f"--scenario {path}: found that it cannot be written ({error.strerror}), expected a "
            f"file in a folder that can"
        ) from None
