"""Running two installations in turn, so that the machine is the same for both.

A run is a process of its own, as a user starts it. The order within a round alternates, so
that a drift of the machine falls on both sides alike.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from logs.regress.wall import CANNOT_SAY, WallComparison, compare_wall, typical_work_s
from scenarios.commands import FAILED, GOOD

BASE, NEW = "base", "new"


class RoundError(RuntimeError):
    """An installation that cannot be run, or whose run failed: which one, and its words."""


@dataclass(frozen=True)
class Installation:
    """How to start one side's ``waywiser``, and in which folder."""

    command: tuple[str, ...]
    folder: Path


@dataclass(frozen=True)
class Measure:
    """What is run: a scenario, changes to it, and how many rounds; more only if unclear."""

    scenario: str
    changes: tuple[str, ...]
    rounds: int
    most_rounds: int


def installation(path: Path, scratch: Path) -> Installation:
    """A source tree (a folder with waywiser.py) or a Python that has waywiser installed.

    Raises RoundError.
    """
    if (path / "waywiser.py").is_file():
        return Installation((sys.executable, "-m", "waywiser"), path.resolve())
    if path.is_file() and os.access(path, os.X_OK):
        return Installation((str(path.absolute()), "-m", "waywiser"), scratch)
    raise RoundError(
        f"{path}: found {'a folder' if path.is_dir() else 'no program'}, expected a source tree "
        f"with waywiser.py in it or a Python in which waywiser is installed"
    )


def this_installation(scratch: Path) -> Installation:
    """The installation that runs now."""
    tree = Path(__file__).resolve().parents[1]
    return Installation((sys.executable, "-m", "waywiser"), tree if _is_tree(tree) else scratch)


def _is_tree(folder: Path) -> bool:
    return (folder / "waywiser.py").is_file()


def run_once(of: Installation, measure: Measure, log: Path) -> None:
    """One run in a process of its own. Raises RoundError where it leaves no whole log."""
    scenario = Path(measure.scenario)
    name = str(scenario.resolve()) if scenario.is_file() else measure.scenario
    changes = [word for change in measure.changes for word in ("--set", change)]
    command = [*of.command, "launch", name, "--in-process", "--log", str(log), "--json", *changes]
    done = subprocess.run(command, cwd=of.folder, capture_output=True, text=True, check=False)
    # an expectation that fails leaves a run as well; so does a Python that fails, but no log
    if done.returncode not in (GOOD, FAILED) or not log.is_file():
        said = done.stderr.strip().splitlines() or ["it said nothing"]
        raise RoundError(
            f"{' '.join(command)} (in {of.folder}): exit status {done.returncode} and no whole "
            f"log: {said[-1]}"
        )


def run_rounds(
    sides: Sequence[Installation],
    measure: Measure,
    folder: Path,
    show: Callable[[str], None],
) -> None:
    """Run base and new in turn; their logs go to ``folder``/base and ``folder``/new.

    The first run of a side is not kept: it may compile. Raises RoundError, LogReadError.
    """
    for name in (BASE, NEW):
        (folder / name).mkdir()
    for name, side in zip((BASE, NEW), sides, strict=True):
        show(f"warming up: {name}")
        run_once(side, measure, folder / f"warm-{name}.mcap")
    done = 0
    found = {BASE: list[float](), NEW: list[float]()}
    while done < measure.rounds or (
        done < measure.most_rounds and _so_far(found).verdict == CANNOT_SAY
    ):
        turns = list(zip((BASE, NEW), sides, strict=True))
        for name, side in turns if done % 2 == 0 else reversed(turns):
            show(f"round {done + 1} of {max(measure.rounds, done + 1)}: {name}")
            log = folder / name / f"{done:03}.mcap"
            run_once(side, measure, log)
            took_s = typical_work_s(log)
            if took_s is None:
                raise RoundError(f"{log}: found no wall stamps beside the log of {name}")
            found[name].append(took_s)
        done += 1


def _so_far(found: dict[str, list[float]]) -> WallComparison:
    return compare_wall(found[BASE], found[NEW])
