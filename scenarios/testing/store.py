"""The runs of one test session: each is run once, and its log kept if a test failed on it."""

from __future__ import annotations

from pathlib import Path

from logs.wall import wall_path
from scenarios.testing.runs import Run, Wanted, run_wanted


class Store:
    """Runs by what was wanted. ``keep_all``: leave every log, not only those of failures."""

    def __init__(self, folder: Path, *, keep_all: bool) -> None:
        self._folder = folder
        self._keep_all = keep_all
        self._runs: dict[Wanted, Run] = {}
        self._kept: dict[Path, None] = {}

    def run(self, wanted: Wanted) -> Run:
        """The run, carried out where it was not yet. Raises what running raises."""
        if wanted not in self._runs:
            name = Path(wanted.scenario).stem
            seed = "" if wanted.seed is None else f"-seed{wanted.seed}"
            log = self._folder / f"{name}{seed}-{len(self._runs) + 1}.mcap"
            self._runs[wanted] = run_wanted(wanted, log)
        return self._runs[wanted]

    def keep(self, log: Path) -> None:
        """A test failed on this log."""
        self._kept[log] = None

    def close(self) -> None:
        """Remove the logs that nobody will look at."""
        if self._keep_all:
            return
        for run in self._runs.values():
            if run.log not in self._kept:
                run.log.unlink(missing_ok=True)
                wall_path(run.log).unlink(missing_ok=True)
