"""The calibrate commands."""

from __future__ import annotations

import json
import os
import sys
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from bus.features import USUAL, WedgeError, Wedges
from modules.classifier.sensor_model import SHIPPED
from scenarios.calibrate_compute import calibrate_compute
from scenarios.calibrate_detectors import RING, kept_part, model_of, run_trials
from scenarios.calibration_kept import KeptError
from scenarios.calibration_report import as_object, page, show
from scenarios.commands import BAD_INPUT, GOOD, INCONCLUSIVE
from scenarios.costs import HOST_FILE
from scenarios.detector_tally import Tally
from scenarios.say import refuse
from scenarios.scenario import ScenarioError, find, load
from simworld.settings import ring_of
from simworld.sonar import SonarError, SonarRing


@dataclass(frozen=True)
class DetectorTrials:
    """What the user asked for.

    None means for ``workers`` every core, for ``out`` the shipped file, for ``wedges`` as many as
    the scenario has, or the usual number.
    """

    trials: int
    seed: int
    out: Path | None = None
    html: Path | None = None
    scenario: str | None = None
    change: tuple[str, ...] = ()
    workers: int | None = None
    wedges: int | None = None
    as_json: bool = False


def detectors_command(asked: DetectorTrials) -> int:
    """Carry out ``waywiser calibrate detectors``."""
    path = asked.out or SHIPPED
    partly = path.with_name(path.name + ".part")
    try:
        ring, wedges = _sensing(asked)
        if wedges != USUAL and asked.out is None:
            raise ScenarioError(
                f"--wedges {wedges.count}: found no --out, expected a file: the shipped model is "
                f"for {USUAL.count}"
            )
        _check_writable(path, "--out")
        if asked.html is not None:
            _check_writable(asked.html, "--html")
        tally = _tally(asked, ring, wedges, partly)
        model = model_of(tally, asked.trials, asked.seed, ring, _options(asked))
        path.write_text(model.as_json(), encoding="utf-8")
        if asked.html is not None:
            asked.html.write_text(page(model, tally), encoding="utf-8")
        partly.unlink()
    except KeyboardInterrupt:
        again = f"{partly} keeps what is done; the same command goes on from there"
        return refuse(f"stopped: {again}", INCONCLUSIVE, as_json=asked.as_json)
    except (KeptError, ScenarioError, SonarError, WedgeError) as error:
        return refuse(error, BAD_INPUT, as_json=asked.as_json)
    except OSError as error:
        said = f"{error.filename}: cannot be written ({error.strerror})"
        return refuse(said, BAD_INPUT, as_json=asked.as_json)
    if asked.as_json:
        print(json.dumps({"written": str(path), **as_object(model, tally)}))
    else:
        show(model, tally, Console())
        print(f"written: {path}")
    return GOOD


def _tally(asked: DetectorTrials, ring: SonarRing, wedges: Wedges, partly: Path) -> Tally:
    workers = asked.workers or len(os.sched_getaffinity(0))
    kept = kept_part(partly, asked.trials, asked.seed, ring, wedges)
    with Progress(console=Console(stderr=True)) as bar:
        task = bar.add_task("trials", total=asked.trials)

        def tell(done: int) -> None:
            bar.update(task, completed=done)

        return run_trials(asked.trials, asked.seed, workers, tell, ring, kept, wedges)


def _sensing(asked: DetectorTrials) -> tuple[SonarRing, Wedges]:
    """The ring and the wedges of a scenario, or the usual ones; ``--wedges`` comes first.

    Raises ScenarioError and SonarError.
    """
    ring, wedges = RING, USUAL
    if asked.scenario is not None:
        scenario = load(find(asked.scenario), asked.change)
        ring, wedges = ring_of(scenario.world.sonar), Wedges(scenario.sensing.wedges)
    elif asked.change:
        raise ScenarioError("--set: found without --scenario, expected a scenario to change")
    return ring, wedges if asked.wedges is None else Wedges(asked.wedges)


def _options(asked: DetectorTrials) -> list[str]:
    """The options that tell which ring and which wedges it was."""
    named = [] if asked.scenario is None else [f"--scenario {asked.scenario}"]
    named += [] if asked.wedges in (None, USUAL.count) else [f"--wedges {asked.wedges}"]
    return named + [f"--set {change}" for change in asked.change]


def _check_writable(path: Path, option: str) -> None:
    """Now, not after minutes of trials. Raises ScenarioError."""
    if path.is_dir() or not path.absolute().parent.is_dir():
        found = "a folder" if path.is_dir() else "no such folder"
        raise ScenarioError(f"{option} {path}: found {found}, expected a file to write")


def compute_command(name: str, out: Path | None) -> int:
    """Carry out ``waywiser calibrate compute``."""
    try:
        path = find(name)
        scenario = load(path, ["compute.profile=free"])
    except ScenarioError as error:
        print(f"waywiser: {error}", file=sys.stderr)
        return BAD_INPUT
    return _write(out or HOST_FILE, calibrate_compute(scenario, str(path)))


def _write(path: Path, text: str) -> int:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        print(f"waywiser: --out {path}: cannot be written ({error.strerror})", file=sys.stderr)
        return BAD_INPUT
    print(f"written: {path}")
    return GOOD
