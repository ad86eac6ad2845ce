"""The diff command."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

from logs.diff.aftermath import Aftermath, aftermath
from logs.diff.contents import FieldDifference
from logs.diff.report import aftermath_lines, first_lines, setting_lines
from logs.diff.settings import setting_differences
from logs.diff.words import duration
from logs.first_difference import Comparison, compare_logs
from logs.reader import LogReadError
from scenarios.commands import BAD_INPUT, FAILED, GOOD, INCONCLUSIVE
from scenarios.say import refuse


def diff_command(base: Path, new: Path, as_json: bool) -> int:
    """Carry out ``waywiser diff``; returns the exit status."""
    try:
        settings = setting_differences(base, new)
        compared = compare_logs(base, new)
        followed = aftermath(base, new) if compared.first is not None else None
    except LogReadError as error:
        return refuse(error, BAD_INPUT, as_json=as_json)
    status = _status(compared)
    if as_json:
        print(json.dumps(_facts(status, (base, new), settings, compared, followed)))
    else:
        print("\n".join(_lines(settings, compared, followed)))
    return status


def _status(compared: Comparison) -> int:
    if compared.first is not None:
        return FAILED
    return INCONCLUSIVE if compared.incomplete else GOOD


def _facts(
    status: int,
    logs: tuple[Path, Path],
    settings: tuple[FieldDifference, ...],
    compared: Comparison,
    followed: Aftermath | None,
) -> dict[str, object]:
    return {
        "status": status,
        "base": str(logs[0]),
        "new": str(logs[1]),
        "settings": [asdict(one) for one in settings],
        **asdict(compared),
        "aftermath": None if followed is None else asdict(followed),
    }


def _lines(
    settings: tuple[FieldDifference, ...], compared: Comparison, followed: Aftermath | None
) -> list[str]:
    lines = list(setting_lines(settings))
    first, equal = compared.first, f"{compared.equal:,} messages"
    if first is None:
        lines.append(f"no difference: {equal} are equal, bit for bit")
    else:
        lines.append(f"the runs part at {duration(first.at_ns)}, after {equal} that are equal")
        lines += first_lines(first)
    if followed is not None:
        lines += aftermath_lines(followed)
    return lines + [f"not all is there: {reason}" for reason in compared.incomplete]
