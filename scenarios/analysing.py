"""The analyse and check commands."""

from __future__ import annotations

import json
from contextlib import ExitStack, closing
from dataclasses import asdict
from pathlib import Path

from rich.console import Console
from rich.markup import escape

from logs import checking
from logs.analysis import IN_TIME
from logs.checking import CheckedLog, check_log, checked_to_json
from logs.perfetto import write_trace
from logs.picture import write_page
from logs.reader import LogReadError
from logs.run_log import LogWriteError
from logs.study import Study, study, study_to_json
from logs.tables import Tables
from logs.timing_report import combined, render_studies, render_study
from scenarios.commands import BAD_INPUT, FAILED, GOOD, INCONCLUSIVE
from scenarios.say import refuse


def analyse_command(
    paths: list[Path],
    html: Path | None,
    tables: Path | None,
    perfetto: Path | None,
    as_json: bool,
) -> int:
    """Carry out ``waywiser analyse``; returns the exit status."""
    try:
        found = _studies(paths, tables)
        if perfetto is not None:
            write_trace(found[0], perfetto)
        if html is not None:
            write_page(found[0], html)
    except (LogReadError, LogWriteError) as error:
        return refuse(error, BAD_INPUT, as_json=as_json)
    if as_json:
        together = [asdict(of) for of in combined(found)]
        print(json.dumps({"logs": [study_to_json(one) for one in found], "combined": together}))
    else:
        _say(found, {"pictures": html, "tables": tables, "trace": perfetto})
    if any(one.analysis.inconclusive for one in found):
        return INCONCLUSIVE
    return GOOD if all(one.analysis.verdict == IN_TIME for one in found) else FAILED


def _studies(paths: list[Path], tables: Path | None) -> list[Study]:
    with ExitStack() as open_files:
        table = open_files.enter_context(closing(Tables(tables))) if tables else None
        return [_study(path, table) for path in paths]


def _study(path: Path, table: Tables | None) -> Study:
    """Study one log, and fill the tables on the way if they were asked for."""
    if table is None:
        return study(path)
    table.begin(path)
    found = study(path, table.span)
    table.study(found)
    return found


def _say(found: list[Study], written: dict[str, Path | None]) -> None:
    console = Console()
    if len(found) == 1:
        render_study(found[0], console)
    else:
        render_studies(found, console)
    for what, path in written.items():
        if path is not None:
            console.print(f"{what}: {path}", soft_wrap=True, highlight=False, markup=False)


_STATUS = {checking.GOOD: GOOD, checking.WRONG: FAILED, checking.INCONCLUSIVE: INCONCLUSIVE}


def check_command(path: Path, as_json: bool) -> int:
    """Carry out ``waywiser check``; returns the exit status."""
    try:
        checked = check_log(path)
    except LogReadError as error:
        return refuse(error, BAD_INPUT, as_json=as_json)
    if as_json:
        print(json.dumps(checked_to_json(checked)))
    else:
        _say_checked(checked)
    return _STATUS[checked.verdict]


def _say_checked(checked: CheckedLog) -> None:
    console = Console(highlight=False, soft_wrap=True)
    console.print(f"{escape(checked.path)}: {checked.verdict}")
    for check in checked.checks:
        mark = "missing" if check.missing else "wrong" if check.wrong else "ok"
        console.print(f"  {mark:8}{check.about} ({check.counted})", markup=False)
        for text in (*check.missing, *check.wrong):
            console.print(f"          {text}", markup=False)
