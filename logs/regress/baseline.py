"""Baselines: runs as text that is committed, a line a handler and a line a decision.

JSON lines, so that a changed decision is a changed line in a review. A file holds one run or
several, each beginning with a line ``run``.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import TypeAlias

import msgspec

from logs.regress.summary import Decision, Identity, Summary, Work

VERSION = 1


class BaselineError(ValueError):
    """A file that is no baseline: which one, the line, what was found and expected."""


class RunLine(msgspec.Struct, frozen=True, tag_field="line", tag="run", forbid_unknown_fields=True):
    """The first line of a run: what it was made from and how it ended."""

    version: int
    scenario: str
    seed: int
    profile: str
    made_from: str
    ended: str
    duration_ns: int


Line: TypeAlias = RunLine | Work | Decision


def baseline_text(runs: Iterable[Summary]) -> str:
    """The text of a baseline, its runs in order of what they were made from."""
    lines: list[Line] = []
    for run in sorted(runs, key=lambda run: run.identity):
        of = run.identity
        lines.append(
            RunLine(
                VERSION, of.scenario, of.seed, of.profile, of.made_from, run.ended, run.duration_ns
            )
        )
        lines += run.work
        lines += run.ledger
    return "".join(msgspec.json.encode(line).decode() + "\n" for line in lines)


def write_baseline(path: Path, runs: Iterable[Summary]) -> None:
    """Write a baseline, all at once: who reads it meanwhile sees the old one or the new."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        file.write(baseline_text(runs))
    Path(name).chmod(0o644)
    Path(name).replace(path)


def read_baseline(path: Path) -> tuple[Summary, ...]:
    """The runs of a baseline. Raises BaselineError."""
    runs: list[tuple[RunLine, list[Work], list[Decision]]] = []
    for number, text in enumerate(_lines(path), start=1):
        line = _line(path, number, text)
        if isinstance(line, RunLine):
            runs.append((line, [], []))
        elif not runs:
            raise BaselineError(f"{path}: line {number}: found no run yet, expected a line run")
        elif isinstance(line, Work):
            runs[-1][1].append(line)
        else:
            runs[-1][2].append(line)
    if not runs:
        raise BaselineError(f"{path}: found nothing in it, expected a baseline")
    return tuple(_summary(path, *run) for run in runs)


def _lines(path: Path) -> list[str]:
    try:
        return path.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise BaselineError(
            f"{path}: found {error.strerror}, expected a log, a folder of logs or a baseline"
        ) from None
    except UnicodeDecodeError:
        raise BaselineError(
            f"{path}: found a file that is neither a log nor text, expected one of the two"
        ) from None


def _line(path: Path, number: int, text: str) -> Line:
    try:
        line: Line = msgspec.json.decode(text, type=Line)
    except msgspec.DecodeError as error:
        raise BaselineError(
            f"{path}: line {number}: found {error}, expected a line of a baseline"
        ) from None
    if isinstance(line, RunLine) and line.version != VERSION:
        raise BaselineError(
            f"{path}: line {number}: version: found {line.version}, expected {VERSION}"
        )
    return line


def _summary(path: Path, run: RunLine, work: list[Work], ledger: list[Decision]) -> Summary:
    identity = Identity(run.scenario, run.seed, run.profile, run.made_from)
    where = f"{path} ({identity})"
    return Summary(identity, run.ended, run.duration_ns, tuple(work), tuple(ledger), where)
