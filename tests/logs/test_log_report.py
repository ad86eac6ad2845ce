"""The report reads well in 100 columns, whatever the log holds."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import msgspec
from rich.console import Console

from bus import messages as m
from bus.wire import Sent
from logs.analysis import analyse
from logs.report import LISTED, render, seconds, title


def _lines(path: Path) -> list[str]:
    out = io.StringIO()
    render(analyse(path), Console(file=out, width=100))
    return [line.rstrip() for line in out.getvalue().splitlines()]


def _row(lines: list[str], begin: str) -> str:
    """The one line that begins so, with single spaces."""
    (line,) = [line for line in lines if line.strip().startswith(begin)]
    return " ".join(line.split())


def test_the_verdict_comes_first(run_path: Path) -> None:
    lines = _lines(run_path)
    assert lines[0] == "two by two, seed 7: 2 of 5 decisions late"
    assert lines[1] == "600.0 s simulated, ended: done, 30 messages"


def test_the_ledger_is_a_table_of_100_columns(run_path: Path) -> None:
    lines = _lines(run_path)
    assert max(map(len, lines)) <= 100
    header = _row(lines, "kind      asked")
    assert header == "kind asked on time late slack min median max idle causes"
    row = _row(lines, "sensing ")
    assert row == "sensing 1 1 0 10.0 s 10.0 s 10.0 s 0 s 1 unsettled"
    row = _row(lines, "path  ")
    assert row == "path 3 1 2 (1 never) -20.0 s 85.0 s 190.0 s 30.0 s message lost 1"
    assert "overrun 1" in [line.strip() for line in lines]  # the second cause, on its own line


def test_what_came_of_the_run_is_told(run_path: Path) -> None:
    lines = _lines(run_path)
    assert (
        "Belief: true map 0.606531; corridors known at 0.99: 3 right, 0 wrong, 1 open; "
        "entropy 0.250"
    ) in lines
    assert "Sensing: 2 readings, 1 junctions, 2.00 a junction" in lines
    assert "Encounters: 2, collisions 1, closest 0.10 m, delay 15.0 s" in lines
    assert _row(lines, "1   0,0") == "1 0,0 1,1 500.0 s 400.0 s 1.25"
    assert _row(lines, "decider") == "decider 2 10,000 60.0 s 10.00%"
    assert _row(lines, "ledger ") == "ledger intruder 1 unknown source"


def test_a_log_that_holds_nothing_says_why_it_has_no_verdict(
    make_log: Callable[[list[Sent]], Path],
) -> None:
    lines = _lines(make_log([]))
    assert lines[0].startswith("two by two, seed 7: inconclusive (0 of 0 decisions late")
    assert "  because the log does not say why the run ended" in lines
    assert "No errand was done." in lines
    assert "Encounters: none" in lines
    assert "Belief: none to compare with the building" in lines


def test_many_late_decisions_are_counted_not_listed(
    run: list[Sent], make_log: Callable[[list[Sent]], Path]
) -> None:
    (late,) = [s for s in run if isinstance(s.message, m.LedgerEntry) and s.message.decision == 4]
    many = [
        replace(late, sequence=i, message=msgspec.structs.replace(late.message, decision=i))
        for i in range(LISTED + 5)
    ]
    lines = _lines(make_log(many))
    assert sum("480.0 s" in line for line in lines) == LISTED
    assert "  and 5 more" in lines


def test_words_of_a_log_are_not_taken_for_markup(
    run: list[Sent], make_log: Callable[[list[Sent]], Path]
) -> None:
    ended = replace(run[-1], message=m.RunEnded("[red]stop[/red]"))
    assert any("ended: [red]stop[/red]" in line for line in _lines(make_log([*run[:-1], ended])))


def test_the_title_of_a_run_without_a_name_is_its_path(run_path: Path) -> None:
    nameless = replace(analyse(run_path), metadata={})
    assert title(nameless) == f"{run_path}: 2 of 5 decisions late"


def test_a_run_in_time_says_so(run_path: Path) -> None:
    in_time = replace(analyse(run_path), late=(), verdict="in time")
    assert title(in_time) == "two by two, seed 7: all 5 decisions in time"


def test_times_keep_the_digits_that_matter() -> None:
    assert [seconds(s) for s in (None, 0.0, 2.5e-6, -0.0125, 9.9994, 10.0, 12345.67)] == [
        "-",
        "0 s",
        "2.5 µs",
        "-12.5 ms",
        "9.999 s",
        "10.0 s",
        "12,345.7 s",
    ]
