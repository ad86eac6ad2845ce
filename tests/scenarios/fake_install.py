"""Programs that stand in for a Python with waywiser in it: they leave logs without running."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from bus.coordinator import Handled
from scenarios.launch import prepare
from scenarios.wall_record import WallRecord

_PROGRAM = """\
#!{python}
import pathlib, shutil, sys
words = sys.argv
log = pathlib.Path(words[words.index("--log") + 1])
here = pathlib.Path(__file__).parent
calls = here.parent / "calls.txt"
with calls.open("a") as file:
    file.write(here.name + " " + log.name + "\\n")
number = sum(line.startswith(here.name) for line in calls.read_text().splitlines()) - 1
made = sorted(here.glob("made-*.mcap"))
made = [path for path in made if not path.name.endswith(".wall.mcap")]
path = made[number % len(made)]
shutil.copy(path, log)
shutil.copy(path.with_suffix(".wall.mcap"), log.with_suffix(".wall.mcap"))
"""


def fake_install(folder: Path, log: Path, took_ms: list[float]) -> Path:
    """A program that leaves ``log``, its n-th run with handlers that took ``took_ms[n]``.

    What it was called for stands in ``calls.txt`` beside ``folder``.
    """
    folder.mkdir()
    for number, ms in enumerate(took_ms):
        path = folder / f"made-{number:02}.mcap"
        path.write_bytes(log.read_bytes())
        with WallRecord(path, prepare("aces", [], 1).script) as wall:
            for part in np.linspace(0.9, 1.1, 5):
                took_ns = round(ms * 1e6 * part)
                wall.measured("decider", Handled("belief/map", "world", 1, 0, 1, 1, 0, "", took_ns))
    program = folder / "python"
    program.write_text(_PROGRAM.format(python=sys.executable))
    program.chmod(0o755)
    return program


def calls(folder: Path) -> list[str]:
    """Which installation was called for which log, in order."""
    return (folder / "calls.txt").read_text().splitlines()
