"""Launching a scenario: in processes of their own under a supervisor, or all in one."""

from __future__ import annotations

import contextlib
import os
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from bus.link import endpoint
from bus.topics import MODULES, RECORDER, WORLD
from logs.wall import wall_path
from scenarios.draw import Drawn, draw
from scenarios.in_process import run_in_process
from scenarios.interrupt import interruptible
from scenarios.module_order import ModuleOrder, write_module_order
from scenarios.modules import ModuleRefusedError
from scenarios.order import Order, write_order
from scenarios.parts import prices_of
from scenarios.run_record import Script
from scenarios.scenario import ScenarioError, find, load
from scenarios.supervisor import Progress, Supervisor
from scenarios.wall_record import WallRecord

RUNS = Path("logs/runs")


@dataclass(frozen=True)
class Launched:
    """How a launch went: why the run ended, where its log and the processes' output are.

    ``failed`` has for each process that failed how it ended and its last words. ``output`` is
    None where no process failed or printed anything. A run that never began leaves no log.
    """

    reason: str
    log: Path
    output: Path | None
    simulated_s: float
    wall_s: float
    started_after_s: float
    handlers: int
    failed: dict[str, str]


@dataclass(frozen=True, eq=False)
class Prepared:
    """A scenario that has been checked in full: ready to run."""

    script: Script
    drawn: Drawn


def prepare(name: str | None, changes: Sequence[str], seed: int | None) -> Prepared:
    """Read, change and check a scenario, and draw its world. Raises ScenarioError."""
    path = find(name)
    scenario = load(path, changes, seed)
    drawn = draw(scenario, str(path))
    text = path.read_text(encoding="utf-8")
    return Prepared(Script(path.stem, text, tuple(changes), scenario), drawn)


@contextlib.contextmanager
def claimed_log(prepared: Prepared, wanted: str | None) -> Iterator[Path]:
    """The log's file, made now; removed in the end if nothing was written to it.

    Raises ScenarioError if it cannot be written.
    """
    path = Path(wanted) if wanted else _free_path(prepared.script)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.open("ab").close()
    except OSError as error:
        raise ScenarioError(
            f"--log {path}: found that it cannot be written ({error.strerror}), "
            f"expected a file in a folder that can"
        ) from None
    try:
        yield path
    finally:
        if path.is_file() and not path.stat().st_size:
            path.unlink()


def _free_path(script: Script) -> Path:
    stamp = time.strftime("%Y%m%d-%H%M%S")
    name = f"{script.name}-seed{script.scenario.seed}-{stamp}"
    path, again = RUNS / f"{name}.mcap", 1
    while path.exists():
        again += 1
        path = RUNS / f"{name}-{again}.mcap"
    return path


def launch_in_process(prepared: Prepared, log: Path) -> Launched:
    """Run everything in this process. Raises ModuleRefusedError, LogWriteError."""
    began_s = time.monotonic()
    script = prepared.script
    with interruptible() as interrupts:
        try:
            with WallRecord(log, script) as wall, script.open_log(log) as run_log:
                ended = run_in_process(
                    script.scenario,
                    prepared.drawn,
                    run_log.write,
                    stop=interrupts.any,
                    measured=wall.measured,
                )
        except ModuleRefusedError:
            log.unlink()  # there was no run
            wall_path(log).unlink(missing_ok=True)
            raise
    wall_s = time.monotonic() - began_s
    return Launched(ended.reason, log, None, ended.simulated_s, wall_s, 0.0, ended.handlers_run, {})


def _write_orders(prepared: Prepared, log: Path, output: Path, at: str) -> dict[str, Path]:
    """The orders of every process, as files beside its output; the world's first."""
    script, run = prepared.script, f"{os.getpid():x}-{time.time_ns():x}"
    whole = output / "run.json"
    write_order(Order(run, at, str(log.resolve()), script), whole)
    prices = prices_of(script.scenario.compute)
    orders = {WORLD: whole, RECORDER: whole}
    for name in MODULES:
        orders[name] = output / f"{name}.json"
        settings = script.scenario.modules.get(name, {})
        write_module_order(
            ModuleOrder(
                name, run, at, prepared.drawn.facts, settings, script.scenario.seed, prices
            ),
            orders[name],
        )
    return orders


def launch_processes(prepared: Prepared, log: Path, show: Callable[[Progress], None]) -> Launched:
    """Run every process apart, under the supervisor. Raises PortError, ModuleRefusedError."""
    bus = prepared.script.scenario.bus
    at = endpoint(bus.port)
    output = _output_of(log)
    orders = _write_orders(prepared, log, output, at)
    began_s = time.monotonic()
    failed = refused = False
    supervisor = Supervisor(orders, output, bus.patience_s)
    try:
        with supervisor:
            ended = supervisor.run(show)
        failed = bool(ended.failed)
    except ModuleRefusedError:
        refused = True
        raise
    finally:
        if not supervisor.progress.started and log.is_file():
            log.unlink()
            wall_path(log).unlink(missing_ok=True)
        if not failed:
            _tidy(output, orders, words=refused)
    wall_s = time.monotonic() - began_s - ended.started_after_s
    return Launched(
        ended.reason,
        log,
        output if output.exists() else None,
        ended.progress.simulated_s,
        wall_s,
        ended.started_after_s,
        ended.progress.handlers,
        ended.failed,
    )


def _output_of(log: Path) -> Path:
    """The folder for what the processes print: beside the log, if that is a file in a folder."""
    if not log.is_file():
        return Path(tempfile.mkdtemp(prefix="waywiser-output-"))
    output = log.with_suffix(".output")
    try:
        output.mkdir(exist_ok=True)
    except OSError as error:
        raise ScenarioError(
            f"{output}: found that it cannot be made ({error.strerror}), expected room for a "
            f"folder beside the log"
        ) from None
    return output


def _tidy(output: Path, orders: dict[str, Path], *, words: bool) -> None:
    """Remove the orders, what is empty, ``words`` or not, and the folder if nothing is left."""
    for name, order in orders.items():
        order.unlink(missing_ok=True)
        said = output / f"{name}.txt"
        if said.exists() and (words or not said.stat().st_size):
            said.unlink()
    with contextlib.suppress(OSError):
        output.rmdir()
