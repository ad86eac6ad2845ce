"""An analysis as text in the terminal, for 100 columns."""

from __future__ import annotations

from rich import box
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from logs.analysis import IN_TIME, INCONCLUSIVE, Analysis
from logs.belief import SURE, FinalBelief
from logs.decisions import Decisions, LateDecision

LISTED = 12
"""How many late decisions and errands are listed; the rest is only counted."""

_STYLE = {IN_TIME: "bold green", INCONCLUSIVE: "bold yellow"}


def render(analysis: Analysis, console: Console) -> None:
    """Print what a log says: the verdict first, the ledger, then what came of the run."""
    _heading(analysis, console)
    console.print(ledger_table(analysis.decisions))
    if analysis.late:
        console.print(_late(analysis.late))
        _more(len(analysis.late), console)
    _errands(analysis, console)
    for line in _summary(analysis):
        console.print(line, highlight=False, soft_wrap=False)
    if analysis.loads:
        console.print(_loads(analysis))
    if analysis.refused:
        console.print(_refused(analysis))


def seconds(value: float | None) -> str:
    """A time for a table: about four digits, in the unit that suits it."""
    if value is None:
        return "-"
    size = abs(value)
    if size >= 10.0:
        return f"{value:,.1f} s"
    if size >= 1.0 or size == 0.0:
        return f"{value:.3f} s" if size else "0 s"
    return f"{value * 1e3:.1f} ms" if size >= 1e-3 else f"{value * 1e6:.1f} µs"


def title(analysis: Analysis) -> str:
    """Scenario, seed and verdict of a run in one line."""
    scenario = analysis.metadata.get("scenario", analysis.path)
    seed = analysis.metadata.get("seed")
    name = scenario if seed is None else f"{scenario}, seed {seed}"
    return f"{name}: {verdict(analysis)}"


def verdict(analysis: Analysis) -> str:
    """The verdict in words."""
    settled = sum(of.asked for of in analysis.decisions)
    late = f"{len(analysis.late)} of {settled} decisions late"
    if analysis.inconclusive:
        return f"{INCONCLUSIVE} ({late} in what the log holds)"
    return late if analysis.late else f"all {settled} decisions in time"


def _heading(analysis: Analysis, console: Console) -> None:
    console.print(escape(title(analysis)), style=_STYLE.get(analysis.verdict, "bold red"))
    for reason in analysis.reasons:
        console.print(f"  because {escape(reason)}", highlight=False)
    ended = f"ended: {analysis.ended}" if analysis.ended else "without an end"
    messages = f"{sum(analysis.topics.values()):,} messages"
    console.print(
        f"{analysis.duration_s:,.1f} s simulated, {escape(ended)}, {messages}", highlight=False
    )


def make_table(name: str, *columns: str, left: tuple[str, ...] = ()) -> Table:
    """An empty table; the columns in ``left`` are set to the left."""
    table = Table(title=name, title_justify="left", title_style="bold")
    table.box, table.pad_edge, table.collapse_padding = box.SIMPLE_HEAD, False, True
    for column in columns:
        table.add_column(column, justify="left" if column in left else "right")
    return table


def ledger_table(decisions: tuple[Decisions, ...]) -> Table:
    """The decisions of each kind."""
    columns = ("kind", "asked", "on time", "late", "slack min", "median", "max", "idle", "causes")
    table = make_table("Decisions", *columns, left=("kind", "causes"))
    for of in decisions:
        late = f"{of.late} ({of.never} never)" if of.never else str(of.late)
        table.add_row(
            escape(of.kind),
            str(of.asked),
            str(of.on_time),
            f"[red]{late}[/red]" if of.late else late,
            seconds(of.slack_min_s),
            seconds(of.slack_median_s),
            seconds(of.slack_max_s),
            seconds(of.idle_s),
            _causes(of),
        )
    return table


def _causes(of: Decisions) -> str:
    causes = [f"{escape(cause)} {number}" for cause, number in of.causes.items()]
    if of.unsettled:
        causes.append(f"[dim]{of.unsettled} unsettled[/dim]")
    return "\n".join(causes)


def _late(late: tuple[LateDecision, ...]) -> Table:
    columns = ("number", "kind", "visit", "due at", "slack", "idle", "cells", "instead", "cause")
    table = make_table("Late decisions", *columns, left=("kind", "instead", "cause"))
    for one in late[:LISTED]:
        table.add_row(
            str(one.decision),
            escape(one.kind),
            str(one.visit),
            seconds(one.until_s),
            "never" if one.slack_s is None else seconds(one.slack_s),
            seconds(one.idle_s),
            f"{one.cells:,}",
            escape(one.instead),
            escape(one.cause),
        )
    return table


def _errands(analysis: Analysis, console: Console) -> None:
    errands = analysis.errands
    if not errands.number:
        console.print("No errand was done.")
        return
    table = make_table("Errands", "number", "from", "to", "time", "shortest", "ratio")
    for one in errands.each[:LISTED]:
        places = [f"{x},{y}" for x, y in (one.start, one.goal)]
        times = (seconds(one.time_s), seconds(one.shortest_s), _ratio(one.ratio))
        table.add_row(str(one.errand), *places, *times)
    table.add_section()
    totals = (seconds(errands.time_s), seconds(errands.shortest_s), _ratio(errands.ratio))
    table.add_row(f"all {errands.number}", "", "", *totals)
    console.print(table)
    _more(errands.number, console)


def _more(number: int, console: Console) -> None:
    if number > LISTED:
        console.print(f"  and {number - LISTED} more", highlight=False)


def _ratio(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}"


def _summary(analysis: Analysis) -> list[str]:
    sensing, met = analysis.sensing, analysis.encounters
    lines = [f"Belief: {_belief(analysis.belief)}"]
    rate = "" if sensing.per_visit is None else f", {sensing.per_visit:.2f} a junction"
    lines.append(f"Sensing: {sensing.readings} readings, {sensing.visits} junctions{rate}")
    if met.closest_m is None:
        lines.append("Encounters: none")
    else:
        lines.append(
            f"Encounters: {met.number}, collisions {met.collisions}, "
            f"closest {met.closest_m:.2f} m, delay {seconds(met.delay_s)}"
        )
    return lines


def _belief(belief: FinalBelief | None) -> str:
    if belief is None:
        return "none to compare with the building"
    true_map = belief.note or f"{belief.true_map:.6f}"
    return (
        f"true map {true_map}; corridors known at {SURE}: {belief.right} right, "
        f"{belief.wrong} wrong, {belief.open} open; entropy {belief.entropy:.3f}"
    )


def _loads(analysis: Analysis) -> Table:
    table = make_table("Loads", "process", "handlers", "cells", "busy", "share", left=("process",))
    for load in analysis.loads:
        share = "-" if load.share is None else f"{load.share:.2%}"
        numbers = (f"{load.handlers:,}", f"{load.cells:,}", seconds(load.busy_s), share)
        table.add_row(escape(load.process), *numbers)
    return table


def _refused(analysis: Analysis) -> Table:
    table = make_table("Refused messages", "topic", "source", "number", "reason", left=("reason",))
    for refused in analysis.refused:
        row = (refused.topic, refused.source, str(refused.number), refused.reason)
        table.add_row(*map(escape, row))
    return table
