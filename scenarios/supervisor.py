"""Starts a run's processes, watches them, and leaves nothing behind.

The supervisor is the parent of all: it alone hears the terminal's Ctrl-C, sees every exit, and
keeps every process's output. It takes no part in the run, so nothing it does can change it.
"""

from __future__ import annotations

import contextlib
import os
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

import msgspec

from bus.topics import RECORDER, WORLD
from scenarios.interrupt import interruptible
from scenarios.modules import REFUSED, ModuleRefusedError

PROGRAM = {WORLD: "scenarios.world_process", RECORDER: "scenarios.recorder_process"}
"""What the processes run that are no modules."""

ZENOH_THREADS = "(rx: (worker_threads: 1), app: (worker_threads: 1))"
"""One thread each is enough for a process that waits for its turn; more cost a run some 6 %."""

LAST_WORDS_LINES = 12
SHUTDOWN_S = 20.0
"""How long processes may take to leave by themselves once the run is over."""

CRASH_SHUTDOWN_S = 0.5
"""The same where the run never began or the world has crashed: others that crash with it."""

SILENCE_S = 60.0
"""The world may be silent for so much longer than it waits for a module."""

TICK_S = 0.2


@dataclass
class Watched:
    """One process and what is known of it."""

    name: str
    popen: subprocess.Popen[bytes]
    output: Path
    frozen: str = ""

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
    ``patience_s`` is how long, by the wall clock, the world waits for a module before it counts
    as frozen.
    """

    def __init__(self, orders: Mapping[str, Path], output: Path, patience_s: float) -> None:
        self._orders = orders
        self._output = output
        self._patience_s = patience_s
        self._silence_s = patience_s + SILENCE_S
        self._watched: dict[str, Watched] = {}
        self._reports: queue.SimpleQueue[dict[str, Any] | None] = queue.SimpleQueue()
        self._asked_to_go: list[str] = []
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
                env={**os.environ, "ZENOH_RUNTIME": ZENOH_THREADS},
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
        """Follow the run to its end. Ctrl-C asks the world to end it; a second one ends us.

        Raises ModuleRefusedError where a module cannot do what the scenario asks.
        """
        began_s = time.monotonic()
        started_after_s = 0.0
        reason = ""
        with interruptible(self._stop_world) as interrupts:
            for said in self._reports_until_the_end(lambda: show(self.progress)):
                if said["state"] == "started":
                    started_after_s = time.monotonic() - began_s
                reason = self._take(said) or reason
            over = bool(reason)  # else the world never came to its end
            if interrupts.any() and not over:
                reason = "stopped"
                self._asked_to_go.append(WORLD)
            failed = self._failures(reason, over=over)
        show(self.progress)
        return Supervised(reason, self.progress, failed, started_after_s)

    def _reports_until_the_end(self, tick: Callable[[], None]) -> Iterator[dict[str, Any]]:
        """What the world says, until it has gone, is frozen, or nobody can get it going."""
        heard_s = time.monotonic()
        while True:
            tick()
            try:
                said = self._reports.get(timeout=TICK_S)
            except queue.Empty:
                self._note_states()
                if self._cannot_start():
                    return
                if time.monotonic() - heard_s > self._silence_s:
                    self._frozen(WORLD, self._silence_s)
                    return
                continue
            if said is None:
                return
            heard_s = time.monotonic()
            yield said

    def _note_states(self) -> None:
        for name, watched in self._watched.items():
            code = watched.popen.poll()
            if code is not None and name not in self._asked_to_go:
                self.progress.states[name] = _how(code) if code else "ended"

    def _cannot_start(self) -> bool:
        return not self.progress.started and any(
            watched.popen.poll() not in (None, 0) for watched in self._watched.values()
        )

    def _take(self, said: dict[str, Any]) -> str:
        state = said["state"]
        if state == "ready":
            self.progress.states[said["process"]] = "ready"
        elif state == "kill":
            self._asked_to_go.append(said["process"])
            self._watched[said["process"]].popen.kill()
            self.progress.states[said["process"]] = "killed as planned"
        elif state == "started":
            self.progress.started = True
            self.progress.states = dict.fromkeys(self.progress.states, "running")
        else:
            for name in ("simulated_s", "errands_done", "errands", "on_time", "late", "handlers"):
                setattr(self.progress, name, said[name])
        return str(said.get("reason", ""))

    def _stop_world(self) -> None:
        self._watched[WORLD].popen.send_signal(signal.SIGTERM)

    def _frozen(self, name: str, patience_s: float) -> None:
        self._watched[name].frozen = f"frozen: no answer for {patience_s:g} s"
        self._watched[name].popen.kill()

    def _failures(self, reason: str, *, over: bool) -> dict[str, str]:
        """Give the processes time to leave; say of each that failed how, and its last words."""
        _, frozen, name = reason.partition("process frozen: ")
        if frozen and name in self._watched:
            self._frozen(name, self._patience_s)
        until_s = time.monotonic() + (SHUTDOWN_S if over else CRASH_SHUTDOWN_S)
        failed: dict[str, str] = {}
        for name, watched in self._watched.items():
            how = self._end_of(watched, until_s)
            if how is None and over:
                how = "did not leave when the run was over"
            if how and name not in self._asked_to_go:
                failed[name] = f"{how}\n{watched.last_words()}".rstrip()
        return failed

    def _end_of(self, watched: Watched, until_s: float) -> str | None:
        """How a process ended: "" if well, None if it did not by then."""
        try:
            code = watched.popen.wait(max(0.0, until_s - time.monotonic()))
        except subprocess.TimeoutExpired:
            self.progress.states[watched.name] = "ended by the supervisor"
            return None
        if code == REFUSED and not self.progress.started:
            raise ModuleRefusedError(f"{watched.name}: {watched.last_words()}")
        how = watched.frozen or (_how(code) if code else "")
        self.progress.states[watched.name] = how or "ended"
        return how

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
