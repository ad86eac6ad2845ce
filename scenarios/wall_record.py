"""What cannot repeat, apart from the log: what each handler took on this machine."""

from __future__ import annotations

import os
import platform
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Self

from bus.coordinator import Handled
from bus.messages import WallSpan
from bus.topics import CLOCK
from bus.turns import Voice
from logs.run_log import LogWriteError, RunLog
from logs.wall import wall_path
from scenarios.run_record import Script


class WallRecord:
    """RUN.wall.mcap beside RUN.mcap: wall stamps, the machine, and every handler's wall time.

    It is an extra: where it cannot be written it says so once, and the run goes on without.
    """

    def __init__(self, log: Path, script: Script) -> None:
        metadata = {
            "scenario": script.name,
            "seed": str(script.scenario.seed),
            "machine": f"{platform.machine()}, {os.cpu_count()} cores, {platform.platform()}",
            "python": platform.python_version(),
        }
        self._began_ns = time.monotonic_ns()
        self._voice = Voice(CLOCK)
        self._log: RunLog | None = None
        if log.is_file() or not log.exists():  # a log into a device has nothing beside it
            with self._or_without():
                self._log = RunLog(wall_path(log), time.time_ns(), metadata, {})

    @contextmanager
    def _or_without(self) -> Iterator[None]:
        try:
            yield
        except LogWriteError as error:
            self._log = None
            print(f"no wall stamps from here on: {error}", file=sys.stderr, flush=True)

    def measured(self, process: str, handled: Handled) -> None:
        """Write down one handler's work."""
        if self._log is None:
            return
        span = WallSpan(
            process,
            handled.topic,
            handled.source,
            handled.sequence,
            handled.cells,
            handled.end_ns - handled.start_ns,
            handled.took_ns,
        )
        at_ns = time.monotonic_ns() - self._began_ns
        with self._or_without():
            self._log.write(self._voice.sent(span, at_ns, ()))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        where: TracebackType | None,
    ) -> None:
        if self._log is not None:
            with self._or_without():
                self._log.close()
