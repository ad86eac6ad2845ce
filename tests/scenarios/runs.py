"""Whole runs for tests: small scenarios as tables, what was said in them, their logs."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from bus.messages import Message
from bus.turns import Module
from bus.wire import Sent
from scenarios.draw import draw
from scenarios.in_process import run_in_process
from scenarios.launch import Launched, Prepared, launch_processes
from scenarios.modules import build_module
from scenarios.run_record import Script
from scenarios.scenario import Scenario, check, find, load

Table = dict[str, Any]
Said = TypeVar("Said", bound=Message)

MAPS = Path(__file__).resolve().parents[3] / "shared" / "maps"
"""Floor plans of real buildings, where they are at hand."""

LITTLE: Table = {
    "about": "four corridors in a ring, two errands and one person",
    "world": {
        "columns_m": [0.0, 20.0],
        "rows_m": [0.0, 18.0],
        "start": {"junction": [0, 0], "heading": "S", "ahead_m": 6.0},
        "person": [{"enters": {"at_s": 150, "ahead_m": 8.0}, "yields": False}],
    },
    "errand": [
        {"from": [0, 0], "to": [1, 1], "expected_again": 1.0},
        {"from": [1, 1], "to": [0, 0], "expected_again": 1.0},
    ],
    "compute": {"profile": "host"},
}


def with_changes(table: Mapping[str, Any], changes: Mapping[str, Any]) -> Table:
    """A table with some of its keys changed; a dot leads into an inner table."""
    changed = copy.deepcopy(dict(table))
    for key, value in changes.items():
        *parents, last = key.split(".")
        inner = changed
        for parent in parents:
            inner = inner.setdefault(parent, {})
        inner[last] = value
    return changed


def scenario_of(table: Mapping[str, Any], **changes: Any) -> Scenario:
    """A checked scenario; a change's key has ``__`` for the dot."""
    dotted = {key.replace("__", "."): value for key, value in changes.items()}
    return check(with_changes(table, dotted), "a test's table")


def shipped(name: str, *changes: str, seed: int | None = None) -> Script:
    """The script of a shipped scenario, changed as on the command line."""
    path = find(name)
    text = path.read_text(encoding="utf-8")
    return Script(name, text, changes, load(path, changes, seed))


def script_of(scenario: Scenario) -> Script:
    """A test's own scenario as a script."""
    return Script("test", "", (), scenario)


def everything_said(
    scenario: Scenario, build: Callable[..., Module] = build_module
) -> tuple[Sent, ...]:
    """A run in this process: its messages in the order of the log."""
    said: list[Sent] = []
    run_in_process(scenario, draw(scenario, "a test"), said.append, build)
    return tuple(said)


def of_kind(said: Iterable[Sent], kind: type[Said]) -> list[Said]:
    """The messages of one kind, in order."""
    return [sent.message for sent in said if isinstance(sent.message, kind)]


def log_in_process(
    script: Script, path: Path, build: Callable[..., Module] = build_module
) -> bytes:
    """The bytes of the log of a run in this process."""
    with script.open_log(path) as log:
        run_in_process(script.scenario, draw(script.scenario, "a test"), log.write, build)
    return path.read_bytes()


def log_of_processes(script: Script, path: Path) -> tuple[Launched, bytes]:
    """A run with every process apart, and the bytes of its log."""
    path.touch()
    prepared = Prepared(script, draw(script.scenario, "a test"))
    launched = launch_processes(prepared, path, lambda _: None)
    return launched, path.read_bytes()
