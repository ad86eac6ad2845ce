"""Starts a run's processes, watches them, and leaves nothing behind.

The supervisor is the parent of all: it alone hears the terminal's Ctrl-C, sees every exit, and
keeps every process's output. It takes no part in the run, so nothing it does can change it.
"""

from __future__ import annotations

import contextlib
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

import msgspec

from bus.topics import RECORDER, WORLD

PROGRAM = {WORLD: "scenarios.world_process", RECORDER: "scenarios.recorder_process"}
"""What the processes run that are no modules."""

LAST_WORDS_LINES = 12
SHUTDOWN_S = 20.0
"""How long processes may take to leave by themselves once the run is over."""


@dataclass
class Watched:
    """One process and what is known of it."""

    name: str
    popen: subprocess.Popen[bytes]
    output: Path
    state: str = "starting"

    def last_words(self) -> str:
        """The end of what it printed."""
        text = self.output.read_text(encoding="utf-8", errors="replace")
        return "\n".join(text.splitlines()[-LAST_WORDS_LINES:])


@dataclass
class Progress:
    """Where a run is."""

    started: bool = False
    simulated_s: float = 0.0
    errands_done: int = 0
    errands: int = 0
    on_time: int = 0
    late: int = 0
    handlers: int = 0
    states: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Supervised:
    """How a run ended: the world's reason ("" if it never said), and who failed how."""

    reason: str
    progress: Progress
    failed: dict[str, str]
    """Process by process: how it ended and its last words."""
    started_after_s: float


class Supervisor:
    """The parent of one run's processes; a context manager that ends them all.

    ``orders`` is the file with its orders for each process, in the order of starting.
    """

    def __init__(self, orders: Mapping[str, Path], output: Path) -> None:
        self._orders = orders
        self._output = output
        self._watched: dict[str, Watched] = {}
        self._reports: queue.SimpleQueue[dict[str, Any] | None] = queue.SimpleQueue()
        self._interrupted = 0
        self._killed: list[str] = []
        self.progress = Progress()

    def __enter__(self) -> Supervisor:
        try:
            for name, order in self._orders.items():
                self._start(name, PROGRAM.get(name, "scenarios.module_process"), order)
        except BaseException:
            self._end_all()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self._end_all()

    def _start(self, name: str, program: str, order: Path) -> None:
        path = self._output / f"{name}.txt"
        reports = name == WORLD
        with path.open("wb") as out:
            popen = subprocess.Popen(
                [sys.executable, "-m", program, str(order)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE if reports else out,
                stderr=out if reports else subprocess.STDOUT,
                # Their own session: Ctrl-C is ours to hear, and ours to pass on.
                start_new_session=True,
            )
        self._watched[name] = Watched(name, popen, path)
        self.progress.states[name] = "starting"
        if popen.stdout is not None:
            threading.Thread(target=self._read, args=(popen.stdout,), daemon=True).start()

    def _read(self, reports: IO[bytes]) -> None:
        for line in reports:
            with contextlib.suppress(msgspec.DecodeError):
                self._reports.put(msgspec.json.decode(line))
        self._reports.put(None)

    def run(self, show: Callable[[Progress], None]) -> Supervised:
        """Follow the run to its end. Ctrl-C asks the world to end it; a second one ends us."""
        began_s = time.monotonic()
        started_after_s = 0.0
        reason = ""
        before = signal.signal(signal.SIGINT, self._interrupt)
        try:
            while True:
                said = self._next_report()
                if said is None:
                    break
                if said["state"] == "started":
                    started_after_s = time.monotonic() - began_s
                reason = self._take(said) or reason
                show(self.progress)
        finally:
            signal.signal(signal.SIGINT, before)
        failed = self._wait_for_all()
        show(self.progress)
        return Supervised(reason, self.progress, failed, started_after_s)

    def _next_report(self) -> dict[str, Any] | None:
        """What the world says next; None once it has gone, or nobody can get it going."""
        while True:
            try:
                return self._reports.get(timeout=0.2)
            except queue.Empty:
                if not self.progress.started and self._dead():
                    return None

    def _dead(self) -> list[str]:
        return [name for name, w in self._watched.items() if w.popen.poll() is not None]

    def _take(self, said: dict[str, Any]) -> str:
        state = said["state"]
        if state == "ready":
            self.progress.states[said["process"]] = "ready"
        elif state == "kill":
            self._killed.append(said["process"])
            self._watched[said["process"]].popen.kill()
            self.progress.states[said["process"]] = "killed as planned"
        elif state == "started":
            self.progress.started = True
            self.progress.states = dict.fromkeys(self.progress.states, "running")
        else:
            for name in ("simulated_s", "errands_done", "errands", "on_time", "late", "handlers"):
                setattr(self.progress, name, said[name])
        return str(said.get("reason", ""))

    def _interrupt(self, *_: object) -> None:
        self._interrupted += 1
        if self._interrupted > 1:
            raise KeyboardInterrupt
        self._watched[WORLD].popen.send_signal(signal.SIGTERM)

    def _wait_for_all(self) -> dict[str, str]:
        """Give every process time to leave; say of each that failed how, and its last words."""
        world_gone = self._watched[WORLD].popen.poll() not in (None, 0)
        until_s = time.monotonic() + (2.0 if world_gone else SHUTDOWN_S)
        failed: dict[str, str] = {}
        for name, watched in self._watched.items():
            try:
                code = watched.popen.wait(max(0.0, until_s - time.monotonic()))
            except subprocess.TimeoutExpired:
                self.progress.states[name] = "ended by the supervisor"
                if not world_gone:
                    failed[name] = "did not leave when the run was over"
                continue
            self.progress.states[name] = "ended" if code == 0 else _how(code)
            if code != 0 and name not in self._killed:
                failed[name] = f"{_how(code)}\n{watched.last_words()}".rstrip()
        return failed

    def _end_all(self) -> None:
        for watched in self._watched.values():
            if watched.popen.poll() is None:
                watched.popen.kill()
        for watched in self._watched.values():
            watched.popen.wait()
            for pipe in (watched.popen.stdin, watched.popen.stdout):
                if pipe is not None:
                    with contextlib.suppress(OSError):
                        pipe.close()


def _how(code: int) -> str:
    if code < 0:
        return f"killed by {signal.Signals(-code).name}"
    return f"ended with status {code}"
