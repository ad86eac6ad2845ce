"""The analyse command."""

from __future__ import annotations

import json
import sys
from pathlib import Path

from rich.console import Console

from logs.analysis import IN_TIME, Analysis, analyse, to_json
from logs.picture import write_page
from logs.reader import LogReadError
from logs.report import render
from logs.run_log import LogWriteError
from scenarios.commands import BAD_INPUT, FAILED, GOOD, INCONCLUSIVE


def analyse_command(paths: list[Path], html: Path | None, as_json: bool) -> int:
    """Carry out ``waywiser analyse``; returns the exit status."""
    try:
        analyses = [analyse(path) for path in paths]
        if html is not None:
            write_page(paths[0], html)
    except (LogReadError, LogWriteError) as error:
        print(f"waywiser: {error}", file=sys.stderr)
        return BAD_INPUT
    if as_json:
        print(json.dumps({"logs": [to_json(analysis) for analysis in analyses]}))
    else:
        _say(analyses, html)
    if any(analysis.inconclusive for analysis in analyses):
        return INCONCLUSIVE
    return GOOD if all(analysis.verdict == IN_TIME for analysis in analyses) else FAILED


def _say(analyses: list[Analysis], html: Path | None) -> None:
    console = Console()
    for analysis in analyses:
        render(analysis, console)
    if html is not None:
        console.print(f"pictures: {html}", soft_wrap=True, highlight=False)
