"""The launch command: run, judge, and say how it went."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from pathlib import Path

from rich.console import Console

from bus.link import PortError
from logs.analysis import Analysis, analyse
from logs.reader import LogReadError
from logs.run_log import LogWriteError
from scenarios.commands import BAD_INPUT, FAILED, GOOD, INCONCLUSIVE
from scenarios.expectations import Verdict, judge
from scenarios.launch import (
    Launched,
    Prepared,
    launch_in_process,
    launch_processes,
    log_path,
    prepare,
)
from scenarios.scenario import ScenarioError
from scenarios.show import ProgressShow


def launch_command(
    name: str,
    seed: int | None,
    in_process: bool,
    log: str | None,
    changes: list[str],
    as_json: bool,
) -> int:
    """Carry out ``waywiser launch``; returns the exit status."""
    try:
        prepared = prepare(name, changes, seed)
        launched = _run(prepared, log_path(prepared, log), in_process, as_json)
    except (ScenarioError, PortError) as error:
        print(f"waywiser: {error}", file=sys.stderr)
        return BAD_INPUT
    except LogWriteError as error:
        print(f"waywiser: {error}", file=sys.stderr)
        return INCONCLUSIVE
    return _conclude(prepared, launched, as_json)


def _run(prepared: Prepared, log: Path, in_process: bool, as_json: bool) -> Launched:
    if in_process:
        return launch_in_process(prepared, log)
    script = prepared.script
    with ProgressShow(script.name, script.scenario.seed, quiet=as_json) as show:
        return launch_processes(prepared, log, show.update)


def _conclude(prepared: Prepared, launched: Launched, as_json: bool) -> int:
    try:
        analysis = analyse(launched.log)
    except LogReadError as error:
        analysis = None
        print(f"waywiser: {error}", file=sys.stderr)
    verdicts: list[Verdict] = []
    if analysis is not None:
        scenario = prepared.script.scenario
        errands = len(prepared.drawn.plan.errands)
        verdicts = judge(scenario.expect, analysis, errands)
    status = _status(launched, analysis, verdicts)
    if as_json:
        print(json.dumps(_facts(launched, verdicts, status)))
    else:
        _say(launched, verdicts, status)
    return status


def _status(launched: Launched, analysis: Analysis | None, verdicts: list[Verdict]) -> int:
    if launched.failed or analysis is None or analysis.inconclusive:
        return INCONCLUSIVE
    if launched.reason == "stopped":
        return INCONCLUSIVE
    held = all(verdict.holds for verdict in verdicts)
    return GOOD if held and launched.reason in ("done", "time") else FAILED


def _facts(launched: Launched, verdicts: list[Verdict], status: int) -> dict[str, object]:
    return {
        "status": status,
        "reason": launched.reason,
        "log": str(launched.log),
        "output": None if launched.output is None else str(launched.output),
        "simulated_s": launched.simulated_s,
        "wall_s": launched.wall_s,
        "started_after_s": launched.started_after_s,
        "handlers": launched.handlers,
        "failed": launched.failed,
        "expectations": [asdict(verdict) for verdict in verdicts],
    }


def _say(launched: Launched, verdicts: list[Verdict], status: int) -> None:
    console = Console(highlight=False)
    times = launched.simulated_s / max(launched.wall_s, 1e-9)
    console.print(
        f"{launched.reason or 'no end'} after {launched.simulated_s:,.1f} s simulated "
        f"in {launched.wall_s:.1f} s ({times:,.0f} times real time)"
    )
    for process, how in launched.failed.items():
        first, *words = how.splitlines()
        console.print(f"[bold red]{process}: {first}[/]")
        for line in words:
            console.print(f"  {line}", markup=False)
    for verdict in verdicts:
        mark = "[green]holds[/]" if verdict.holds else "[bold red]does not hold[/]"
        console.print(f"expected {verdict.expected}: found {verdict.found}, {mark}")
    console.print(f"log: {launched.log}", soft_wrap=True)
    if launched.output is not None and status:
        console.print(f"output of every process: {launched.output}", soft_wrap=True)
