"""The calibrate commands."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from modules.classifier.sensor_model import SHIPPED
from scenarios.calibrate_compute import calibrate_compute
from scenarios.calibrate_detectors import calibrate
from scenarios.commands import BAD_INPUT, GOOD
from scenarios.costs import HOST_FILE
from scenarios.scenario import ScenarioError, find, load


def detectors_command(trials: int, seed: int, out: Path | None) -> int:
    """Carry out ``waywiser calibrate detectors``."""
    path = out or SHIPPED
    workers = len(os.sched_getaffinity(0))
    with Progress(console=Console(stderr=True)) as bar:
        task = bar.add_task("trials", total=trials)

        def show(done: int) -> None:
            bar.update(task, completed=done)

        model = calibrate(trials, seed, workers, show)
    return _write(path, model.as_json())


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
