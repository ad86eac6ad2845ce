"""A study as text in the terminal: what an analysis prints, and then where the time went."""

from __future__ import annotations

from dataclasses import replace

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from logs.chains import DecisionChain
from logs.decisions import KINDS, Decisions, summarise
from logs.paths import PathTimes
from logs.report import LISTED, ledger_table, make_table, render, seconds, title
from logs.spread import NS_PER_S, spread
from logs.study import Study
from logs.wall import CostCheck

COSTS_LISTED = 10
"""How many kinds of handlers are held against the cost model; --json has all."""


def render_study(found: Study, console: Console) -> None:
    """Print what one log says: the ledger first, late chains, queues, age of the data, beliefs."""
    render(found.analysis, console)
    late = [one for one in found.chains if one.slack_ns < 0]
    if late:
        console.print(_late_chains(late))
    console.print(_queues(found))
    if found.costs:
        console.print(_costs(found.costs))
    console.print(_ages(found.chains))
    if found.paths:
        console.print(_paths(found.paths))
    if any(of.distributions for of in found.calibration):
        console.print(_calibration(found))
    for line in _notes(found):
        console.print(line, highlight=False)


def render_studies(found: list[Study], console: Console) -> None:
    """Print one row a log, and the ledger of all together."""
    rows = make_table("Logs", "run", "decisions", "late", "idle", "simulated", left=("run",))
    for one in found:
        decisions = one.analysis.decisions
        rows.add_row(
            escape(title(one.analysis)),
            str(sum(of.asked for of in decisions)),
            str(sum(of.late for of in decisions)),
            seconds(sum(of.idle_s for of in decisions)),
            seconds(one.analysis.duration_s),
        )
    console.print(rows)
    console.print(ledger_table(combined(found)))


def combined(found: list[Study]) -> tuple[Decisions, ...]:
    """The ledger of several logs as one."""
    rows = summarise([entry for one in found for entry in one.ledger], {})
    unsettled: dict[str, int] = {}
    for one in found:
        for of in one.analysis.decisions:
            unsettled[of.kind] = unsettled.get(of.kind, 0) + of.unsettled
    return tuple(replace(row, unsettled=unsettled.get(row.kind, 0)) for row in rows)


def _late_chains(late: list[DecisionChain]) -> Table:
    columns = ("number", "kind", "slack", "response", "most of it", "chain")
    table = make_table("Late chains", *columns, left=("kind", "most of it", "chain"))
    for one in late[:LISTED]:
        table.add_row(
            str(one.decision),
            escape(one.kind),
            seconds(one.slack_ns / NS_PER_S),
            seconds(one.chain.response_ns / NS_PER_S),
            _most(one),
            escape("\n> ".join(one.chain.topics)) + ("" if one.chain.whole else "\n(cut short)"),
        )
    return table


def _most(one: DecisionChain) -> str:
    longest = one.chain.longest
    if longest is None:
        return "-"
    hop, what, took_ns = longest
    where = "bus" if what == "transport" else hop.process
    return escape(f"{where} {what} {seconds(took_ns / NS_PER_S)}")


def _queues(found: Study) -> Table:
    columns = ("process", "handler", "handled", "median", "p95", "longest", "waited", "at most")
    table = make_table("Handlers and queues", *columns, left=("process", "handler"))
    for process in found.processes:
        for k, of in enumerate(process.handlers):
            table.add_row(
                "" if k else escape(process.process),
                escape(of.topic),
                f"{of.took.number:,}",
                seconds(of.took.median_s),
                seconds(of.took.p95_s),
                seconds(of.took.max_s),
                "" if k else f"{process.waited_at_all:,}",
                "" if k else seconds(process.waited.max_s),
            )
    return table


def _costs(costs: tuple[CostCheck, ...]) -> Table:
    """The most expensive kinds of handlers: what they took on the machine and in the model."""
    columns = ("process", "handler", "handled", "measured", "modelled", "ratio", "with cells")
    table = make_table(
        "Does the cost model hold? (medians; ratio of totals; correlation of time with cells)",
        *columns,
        left=("process", "handler"),
    )
    for of in costs[:COSTS_LISTED]:
        table.add_row(
            escape(of.process),
            escape(of.topic),
            f"{of.handlers:,}",
            seconds(of.measured_median_s),
            seconds(of.modelled_median_s),
            "-" if of.ratio is None else f"{of.ratio:.2f}",
            "-" if of.correlation is None else f"{of.correlation:.2f}",
        )
    return table


def _ages(chains: tuple[DecisionChain, ...]) -> Table:
    columns = ("kind", "decisions", "newest median", "longest", "oldest median", "longest")
    table = make_table("Age of the percepts at the decision", *columns, left=("kind",))
    for kind in dict.fromkeys((*KINDS, *(one.kind for one in chains))):
        ages = [one.chain.age for one in chains if one.kind == kind and one.chain.age]
        newest = spread([age.newest_ns for age in ages])
        oldest = spread([age.oldest_ns for age in ages])
        times = (newest.median_s, newest.max_s, oldest.median_s, oldest.max_s)
        table.add_row(escape(kind), str(len(ages)), *map(seconds, times))
    return table


def _paths(paths: tuple[PathTimes, ...]) -> Table:
    columns = ("kind", "from", "hops", "best", "worst", "first", "last", "longest")
    table = make_table(
        "Response times (medians; of a decision: best, worst; of an input: first, last)",
        *columns,
        left=("kind", "from"),
    )
    for of in paths:
        medians = (of.best.median_s, of.worst.median_s, of.first.median_s, of.last.median_s)
        kind = of.topics[-1].removeprefix("decision/")
        path = (escape(kind), escape(of.topics[0]), str(len(of.topics) - 1))
        table.add_row(*path, *map(seconds, medians), seconds(of.last.max_s))
    return table


def _calibration(found: Study) -> Table:
    columns = ("distribution", "number", "brier", "log score", "thought impossible")
    table = make_table("Beliefs against the truth", *columns, left=("distribution",))
    for of in found.calibration:
        numbers = ("-" if v is None else f"{v:.4f}" for v in (of.brier, of.log_score))
        table.add_row(escape(of.about), f"{of.distributions:,}", *numbers, str(of.impossible))
    return table


def _notes(found: Study) -> list[str]:
    of = found.registration
    lines = [
        f"Registration: where it believed to be {of.right}, elsewhere {of.wrong}, "
        f"not known {of.unknown} of {of.beliefs} beliefs"
    ]
    if found.unknown_parents:
        lines.append(f"Chains: {found.unknown_parents} parents of messages were not found")
    if not found.hop_ns:
        lines.append("The log does not say how long a hop takes: it is counted as queueing")
    return lines
