"""The HTML of a page: the words and tables around its figures, filled into ``page.html``."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from importlib.resources import files
from string import Template

from bus.messages import LedgerEntry
from logs.analysis import Analysis
from logs.decisions import KINDS
from logs.figures import building_figure
from logs.page.data import as_script, notes, page_data
from logs.page.plots import belief_figures, slack_figure
from logs.page.record import Record
from logs.page.tables import table
from logs.paths import PathTimes
from logs.report import seconds, title
from logs.study import Study

SCRIPTS = ("state.js", "replay.js", "timeline.js", "decisions.js", "main.js")
"""The page's script, in the order in which its parts stand on the page."""

MOST_ERRANDS = 200


def document(found: Study, record: Record) -> str:
    """The whole page, which needs nothing else."""
    analysis, ledger = found.analysis, found.ledger
    data = page_data(record, ledger, found.chains, analysis.duration_s)
    reasons = "".join(f"<p>because {escape(reason)}</p>" for reason in analysis.reasons)
    left_out = "".join(f'<p class="soft">{escape(note)}</p>' for note in notes(record, ledger))
    return Template(_part("page.html")).substitute(
        title=escape(title(analysis)),
        style=_part("page.css"),
        reasons=reasons,
        summary=escape(_summary(analysis)),
        ledger=_ledger(analysis),
        replay_hidden="" if record.building is not None else " hidden",
        building="" if record.building is None else building_figure(record.building),
        kinds="".join(_kind_box(kind) for kind in _kinds(ledger)),
        notes=left_out,
        slack=_slack(ledger),
        belief=_belief(analysis, record),
        loads=_loads(analysis),
        errands=_errands(analysis),
        paths=_paths(found.paths),
        data=as_script(data),
        script="\n".join(_part(name) for name in SCRIPTS),
    )


def _part(name: str) -> str:
    return files("logs.page").joinpath(name).read_text(encoding="utf-8")


def _kinds(ledger: Sequence[LedgerEntry]) -> list[str]:
    return list(dict.fromkeys((*KINDS, *(entry.kind for entry in ledger))))


def _kind_box(kind: str) -> str:
    name = escape(kind)
    return f'<label><input type="checkbox" name="kind" value="{name}" checked>{name}</label>'


def _summary(analysis: Analysis) -> str:
    ended = f"ended: {analysis.ended}" if analysis.ended else "without an end"
    met = analysis.encounters
    words = [f"{seconds(analysis.duration_s)} simulated, {ended}"]
    if analysis.errands.number:
        words.append(
            f"{analysis.errands.number} errands done in {seconds(analysis.errands.time_s)}, "
            f"{seconds(analysis.errands.shortest_s)} at least"
        )
    if met.number:
        words.append(f"{met.number} people met, {met.collisions} collisions")
    if analysis.belief is not None:
        of = analysis.belief
        words.append(f"corridors known at the end: {of.right} right, {of.wrong} wrong")
    return "; ".join(words) + "."


def _ledger(analysis: Analysis) -> str:
    head = ("kind", "asked", "on time", "late", "slack min", "median", "max", "idle", "causes")
    rows = [
        (
            of.kind,
            str(of.asked),
            str(of.on_time),
            str(of.late),
            *map(seconds, (of.slack_min_s, of.slack_median_s, of.slack_max_s, of.idle_s)),
            ", ".join(f"{cause} {number}" for cause, number in of.causes.items()),
        )
        for of in analysis.decisions
    ]
    return table(head, rows, "Decisions and their deadlines")


def _slack(ledger: Sequence[LedgerEntry]) -> str:
    drawn = "".join(
        slack_figure(kind, [entry for entry in ledger if entry.kind == kind])
        for kind in _kinds(ledger)
    )
    return drawn or "<p>No decision was made.</p>"


def _belief(analysis: Analysis, record: Record) -> str:
    if not record.beliefs:
        return ""
    return (
        '<section aria-labelledby="belief-heading"><h2 id="belief-heading">Belief</h2>'
        f"{belief_figures(record.beliefs, analysis.duration_s)}</section>"
    )


def _paths(paths: tuple[PathTimes, ...]) -> str:
    rows = [
        (
            of.topics[-1].removeprefix("decision/"),
            " \u2192 ".join(of.topics[:-1]),
            f"{of.decisions:,}",
            *map(seconds, (of.best.median_s, of.worst.median_s, of.worst.max_s)),
            *map(seconds, (of.first.median_s, of.last.median_s)),
        )
        for of in paths
    ]
    if not rows:
        return ""
    head = ("decision", "from, over", "number", "best", "worst", "the longest", "first", "last")
    words = (
        "Medians. Of a decision: from the newest (best) and the oldest (worst) message that it was "
        "made from on that way. Of such a message: to the first and the last decision made from it."
    )
    return (
        '<section aria-labelledby="paths-heading"><h2 id="paths-heading">Response times</h2>'
        f'<p class="soft">{words}</p>{table(head, rows)}</section>'
    )


def _loads(analysis: Analysis) -> str:
    rows = [
        (
            load.process,
            f"{load.handlers:,}",
            f"{load.cells:,}",
            seconds(load.busy_s),
            "-" if load.share is None else f"{load.share:.2%}",
        )
        for load in analysis.loads
    ]
    head = ("process", "handlers", "cells", "busy", "share of the run")
    return table(head, rows, "Work of each process") if rows else ""


def _errands(analysis: Analysis) -> str:
    each = analysis.errands.each[:MOST_ERRANDS]
    rows = [
        (
            f"{of.errand}: {of.start[0]},{of.start[1]} to {of.goal[0]},{of.goal[1]}",
            seconds(of.time_s),
            seconds(of.shortest_s),
            "-" if of.ratio is None else f"{of.ratio:.2f}",
        )
        for of in each
    ]
    if not rows:
        return ""
    more = analysis.errands.number - len(each)
    caption = "Errands, planned against actual" + (f"; {more:,} more are left out" if more else "")
    return table(("errand", "actual", "shortest", "ratio"), rows, caption)
