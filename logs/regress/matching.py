"""Which run of one side is compared with which of the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from logs.mcap_file import MAGIC
from logs.reader import LogReadError
from logs.regress.baseline import read_baseline
from logs.regress.summary import Identity, Summary, summarise


class MismatchError(ValueError):
    """Two sides that are not about the same runs: what differs."""


@dataclass(frozen=True)
class Pair:
    """The runs of one identity on both sides; either has at least one."""

    identity: Identity
    base: tuple[Summary, ...]
    new: tuple[Summary, ...]


@dataclass(frozen=True)
class Matched:
    """``missing`` has what is on one side alone, in words."""

    pairs: tuple[Pair, ...]
    missing: tuple[str, ...]


def read_side(path: Path) -> tuple[Summary, ...]:
    """The runs of a log, of a folder of logs, or of a baseline.

    Raises LogReadError, BaselineError.
    """
    if path.is_dir():
        logs = logs_in(path)
        if not logs:
            raise LogReadError(f"{path}: found no *.mcap in the folder, expected logs of runs")
        return tuple(summarise(log) for log in logs)
    return (summarise(path),) if _is_log(path) else read_baseline(path)


def logs_in(folder: Path) -> list[Path]:
    """The logs in a folder by name, without those of wall stamps."""
    return sorted(p for p in folder.glob("*.mcap") if not p.name.endswith(".wall.mcap"))


def _is_log(path: Path) -> bool:
    if path.suffix == ".mcap":
        return True
    try:
        with path.open("rb") as file:
            return file.read(len(MAGIC)) == MAGIC
    except OSError:
        return False


def match(base: Sequence[Summary], new: Sequence[Summary]) -> Matched:
    """Match the runs by what they were made from.

    Raises MismatchError where a scenario and seed is on both sides, but made from other things,
    and where nothing is on both sides.
    """
    sides = _by_identity(base), _by_identity(new)
    common = sorted(sides[0].keys() & sides[1].keys())
    alone = [sorted(sides[k].keys() - sides[1 - k].keys()) for k in (0, 1)]
    for left in alone[0]:
        for right in alone[1]:
            if (left.scenario, left.seed) == (right.scenario, right.seed):
                raise MismatchError(_differs(sides[0][left][0], sides[1][right][0]))
    missing = [f"{of}: in BASE, but not in NEW" for of in alone[0]]
    missing += [f"{of}: in NEW, but not in BASE" for of in alone[1]]
    if not common:
        raise MismatchError("found no run that is on both sides; " + "; ".join(missing))
    pairs = tuple(Pair(of, tuple(sides[0][of]), tuple(sides[1][of])) for of in common)
    return Matched(pairs, tuple(missing))


def _by_identity(runs: Sequence[Summary]) -> dict[Identity, list[Summary]]:
    found: dict[Identity, list[Summary]] = {}
    for run in runs:
        found.setdefault(run.identity, []).append(run)
    return found


def _differs(base: Summary, new: Summary) -> str:
    of, other = base.identity, new.identity
    words = []
    if of.profile != other.profile:
        words.append(f"profile {of.profile!r} and {other.profile!r}")
    if of.made_from != other.made_from:
        words.append(
            f"the scenario and what was set in it (hash {of.made_from} and {other.made_from})"
        )
    return (
        f"{base.where} and {new.where}: both are {of.scenario} with seed {of.seed}, "
        f"expected the same run, found that these differ: {'; '.join(words)}"
    )
