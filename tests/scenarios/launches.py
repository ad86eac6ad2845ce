"""Launching small scenarios from tests, in this process and as a user does."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from typer.testing import CliRunner

from scenarios.commands import app

SHORT = """\
about = "One corridor, there and back"
[world]
columns_m = [0.0, 20.0]
rows_m = [0.0]
[[errand]]
from = [0, 0]
to = [1, 0]
[compute]
profile = "free"
"""

ENDLESS = (
    SHORT.replace("[[errand]]\nfrom = [0, 0]\nto = [1, 0]\n", "")
    + "[random_errands]\ncount = 5000\n"
)
"""Runs until somebody ends it: 5000 errands of minutes each."""

GUARD_S = 60.0
"""A test that waits longer than this for something fails."""


@dataclass(frozen=True)
class Ended:
    """What a command said and its exit status."""

    status: int
    out: str
    err: str

    @property
    def json(self) -> dict[str, Any]:
        """The one JSON object on standard output."""
        facts: dict[str, Any] = json.loads(self.out)
        return facts


def waywiser(*arguments: str) -> Ended:
    """The command line within this process."""
    result = CliRunner().invoke(app, arguments)
    if result.exception is not None and not isinstance(result.exception, SystemExit):
        raise result.exception
    return Ended(result.exit_code, result.stdout, result.stderr)


def start(*arguments: str, **how: Any) -> subprocess.Popen[str]:
    """The command line as a process of its own, in its own session."""
    return subprocess.Popen(
        [sys.executable, "-m", "waywiser", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
        **how,
    )


def ended(process: subprocess.Popen[str]) -> Ended:
    """Wait for a started command."""
    try:
        out, err = process.communicate(timeout=GUARD_S)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        raise
    return Ended(process.returncode, out, err)


def processes_of(output: Path) -> dict[str, int]:
    """The living processes of a run by name: their orders lie in its output folder."""
    found: dict[str, int] = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_bytes().decode().split("\0")
        except OSError:
            continue  # it has just gone
        orders = [Path(word) for word in words if word.startswith(f"{output}{os.sep}")]
        if orders:
            program = next(word for word in words if word.startswith("scenarios."))
            name = program.removeprefix("scenarios.").removesuffix("_process")
            found[orders[0].stem if name == "module" else name] = int(folder.name)
    return found


def wait_until(come: Callable[[], bool], what: str) -> None:
    """Wait for something. Raises AssertionError if it does not come for very long."""
    until_s = time.monotonic() + GUARD_S
    while not come():
        assert time.monotonic() < until_s, f"waited {GUARD_S:g} s for {what}"
        time.sleep(0.02)


def wait_until_running(log: Path) -> None:
    """Wait until the run of a log is well under way: its log has grown beyond its head."""
    wait_until(lambda: log.exists() and log.stat().st_size > 100_000, f"{log} to grow")
