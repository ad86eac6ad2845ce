"""Launching a scenario: in processes of their own under a supervisor, or all in one."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from bus.link import endpoint
from bus.topics import MODULES, RECORDER, WORLD
from scenarios.costs import cost_model
from scenarios.draw import Drawn, draw
from scenarios.in_process import run_in_process
from scenarios.module_order import ModuleOrder, Prices, write_module_order
from scenarios.order import Order, write_order
from scenarios.run_record import Script
from scenarios.scenario import ScenarioError, find, load
from scenarios.supervisor import Progress, Supervised, Supervisor

RUNS = Path("logs/runs")


@dataclass(frozen=True)
class Launched:
    """How a launch went: why the run ended, where its log and the processes' output are."""

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


def prepare(name: str, changes: Sequence[str], seed: int | None) -> Prepared:
    """Read, change and check a scenario, and draw its world. Raises ScenarioError."""
    path = find(name)
    scenario = load(path, changes, seed)
    drawn = draw(scenario, str(path))
    text = path.read_text(encoding="utf-8")
    return Prepared(Script(path.stem, text, tuple(changes), scenario), drawn)


def log_path(prepared: Prepared, wanted: str | None) -> Path:
    """Where the log goes; its folder is made. Raises ScenarioError if it cannot be written."""
    script = prepared.script
    stamp = time.strftime("%Y%m%d-%H%M%S")
    name = f"{script.name}-seed{script.scenario.seed}-{stamp}.mcap"
    path = Path(wanted) if wanted else RUNS / name
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("wb"):
            pass
    except OSError as error:
        raise ScenarioError(
            f"--log {path}: found that it cannot be written ({error.strerror}), "
            f"expected a path in a folder that can"
        ) from None
    return path


def launch_in_process(prepared: Prepared, log: Path) -> Launched:
    """Run everything in this process."""
    began_s = time.monotonic()
    with prepared.script.open_log(log) as run_log:
        ended = run_in_process(prepared.script.scenario, prepared.drawn, run_log.write)
    wall_s = time.monotonic() - began_s
    return Launched(ended.reason, log, None, ended.simulated_s, wall_s, 0.0, ended.handlers_run, {})


def _write_orders(prepared: Prepared, log: Path, output: Path, at: str) -> dict[str, Path]:
    """The orders of every process, as files beside its output; the world's first."""
    script, run = prepared.script, f"{log.stem}-{time.time_ns():x}"
    whole = output / "run.json"
    write_order(Order(run, at, str(log.resolve()), script), whole)
    costs = cost_model(script.scenario.compute)
    prices = Prices(costs.profile, dict(costs.rates), dict(costs.extra_ns))
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
    """Run every process apart, under the supervisor. Raises PortError."""
    at = endpoint(prepared.script.scenario.bus.port)
    output = log.with_suffix(".output")
    output.mkdir(exist_ok=True)
    began_s = time.monotonic()
    with Supervisor(_write_orders(prepared, log, output, at), output) as supervisor:
        ended: Supervised = supervisor.run(show)
    wall_s = time.monotonic() - began_s - ended.started_after_s
    return Launched(
        ended.reason,
        log,
        output,
        ended.progress.simulated_s,
        wall_s,
        ended.started_after_s,
        ended.progress.handlers,
        ended.failed,
    )
