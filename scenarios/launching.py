"""The launch command: run, judge, and say how it went."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path

from rich.console import Console

from bus.link import PortError
from logs.analysis import Analysis, analyse
from logs.reader import LogReadError
from scenarios.commands import BAD_INPUT, FAILED, GOOD, INCONCLUSIVE
from scenarios.expectations import Verdict, judge
from scenarios.launch import (
    Launched,
    Prepared,
    claimed_log,
    launch_in_process,
    launch_processes,
    prepare,
)
from scenarios.modules import ModuleRefusedError
from scenarios.say import refuse
from scenarios.scenario import ScenarioError
from scenarios.show import ProgressShow


def launch_command(
    name: str | None,
    seed: int | None,
    in_process: bool,
    log: str | None,
    changes: list[str],
    as_json: bool,
) -> int:
    """Carry out ``waywiser launch``; returns the exit status."""
    return launch(lambda: prepare(name, changes, seed), str(name), in_process, log, as_json)


def launch(
    make: Callable[[], Prepared], name: str, in_process: bool, log: str | None, as_json: bool
) -> int:
    """Make a scenario ready, run it, judge it and say how it went; returns the exit status."""
    try:
        prepared = make()
        with claimed_log(prepared, log) as path:
            launched = _run(prepared, path, in_process, as_json)
    except ScenarioError as error:
        return refuse(error, BAD_INPUT, as_json=as_json)
    except (PortError, ModuleRefusedError) as error:
        return refuse(f"{name}: {error}", BAD_INPUT, as_json=as_json)
    except OSError as error:  # LogWriteError, and a disk that is full at the start
        return refuse(error, INCONCLUSIVE, as_json=as_json)
    except KeyboardInterrupt:
        return refuse("ended at once, as asked twice", INCONCLUSIVE, as_json=as_json)
    return _conclude(prepared, launched, as_json)


def _run(prepared: Prepared, log: Path, in_process: bool, as_json: bool) -> Launched:
    if in_process:
        return launch_in_process(prepared, log)
    script = prepared.script
    with ProgressShow(script.name, script.scenario.seed, quiet=as_json) as show:
        return launch_processes(prepared, log, show.update)


def _conclude(prepared: Prepared, launched: Launched, as_json: bool) -> int:
    analysis, unreadable = _analysed(launched.log)
    verdicts: list[Verdict] = []
    if analysis is not None:
        scenario = prepared.script.scenario
        errands = len(prepared.drawn.plan.errands)
        verdicts = judge(scenario.expect, analysis, errands)
    status = _status(launched, analysis, verdicts)
    if as_json:
        print(json.dumps(_facts(launched, verdicts, status, unreadable)))
    else:
        _say(launched, verdicts, unreadable)
    return status


def _analysed(log: Path) -> tuple[Analysis | None, str]:
    """What a log says, or why it says nothing."""
    if not log.exists():
        return None, "the run never began; no log"
    try:
        return analyse(log), ""
    except LogReadError as error:
        return None, str(error)


def _status(launched: Launched, analysis: Analysis | None, verdicts: list[Verdict]) -> int:
    if launched.failed or analysis is None or analysis.inconclusive:
        return INCONCLUSIVE
    if launched.reason == "stopped":
        return INCONCLUSIVE
    held = all(verdict.holds for verdict in verdicts)
    return GOOD if held and launched.reason in ("done", "time") else FAILED


def _facts(
    launched: Launched, verdicts: list[Verdict], status: int, unreadable: str
) -> dict[str, object]:
    error = [f"{process}: {how}" for process, how in launched.failed.items()]
    error += [unreadable] if unreadable else []
    return {
        "status": status,
        "reason": launched.reason,
        "log": str(launched.log) if launched.log.exists() else None,
        "output": None if launched.output is None else str(launched.output),
        "simulated_s": launched.simulated_s,
        "wall_s": launched.wall_s,
        "started_after_s": launched.started_after_s,
        "handlers": launched.handlers,
        "failed": launched.failed,
        "expectations": [asdict(verdict) for verdict in verdicts],
        **({"error": "\n".join(error)} if error else {}),
    }


def _say(launched: Launched, verdicts: list[Verdict], unreadable: str) -> None:
    console = Console(highlight=False, soft_wrap=True)
    times = launched.simulated_s / max(launched.wall_s, 1e-9)
    console.print(
        f"{launched.reason or 'no end'} after {launched.simulated_s:,.1f} s simulated "
        f"in {launched.wall_s:.1f} s ({times:,.0f} times real time)"
    )
    for process, how in launched.failed.items():
        first, *words = how.splitlines()
        console.print(f"{process}: {first}", style="bold red", markup=False)
        for line in words:
            console.print(f"  {line}", markup=False)
    for verdict in verdicts:
        mark = "[green]holds[/]" if verdict.holds else "[bold red]does not hold[/]"
        console.print(f"expected {verdict.expected}: found {verdict.found}, {mark}")
    console.print(f"log: {unreadable or launched.log}", markup=False)
    if launched.output is not None:
        console.print(f"what the processes printed: {launched.output}", markup=False)
