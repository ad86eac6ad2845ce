"""What the logs say as CSV files, for a spreadsheet or a data frame.

``ledger.csv`` has a row a decision, ``spans.csv`` a row a handler, ``topics.csv`` a row a topic,
``chains.csv`` a row a hop, ``paths.csv`` a row a path (its response times), ``beliefs.csv`` a row
a belief about the map. The first column of all is the log. Times end in their unit; what is not
there is an empty cell.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import IO, Any

from bus.messages import LedgerEntry
from logs.chains import DecisionChain
from logs.decisions import NEVER
from logs.loads import SpanRow
from logs.paths import READINGS, PathTimes
from logs.run_log import LogWriteError
from logs.study import Study

LEDGER = LedgerEntry.__struct_fields__
SPANS = SpanRow._fields
TOPICS = (
    *("topic", "number", "rate_hz", "period_min_s", "period_median_s", "period_p95_s"),
    *("period_max_s", "jitter_s", "median_bytes", "total_bytes", "gaps"),
)
CHAINS = (
    *("decision", "kind", "slack_ns", "hop", "topic", "source", "sequence", "process"),
    *("said_ns", "transport_ns", "queueing_ns", "computing_ns"),
)
PATHS = (
    *("path", "inputs", "decisions"),
    *(f"{reading}_{of}_s" for reading in READINGS for of in ("min", "median", "p95", "max")),
)
BELIEFS = (
    *("at_s", "visit", "entropy", "true_map", "right", "wrong", "open"),
    *("x", "y", "true_x", "true_y"),
)
HEADS = {
    **{"ledger": LEDGER, "spans": SPANS, "topics": TOPICS},
    **{"chains": CHAINS, "paths": PATHS, "beliefs": BELIEFS},
}


class Tables:
    """Writes the tables of any number of logs into one folder. Raises LogWriteError."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._log = ""
        self._files: list[IO[str]] = []
        self._rows: dict[str, Any] = {}
        try:
            folder.mkdir(parents=True, exist_ok=True)
            for name, head in HEADS.items():
                file = (folder / f"{name}.csv").open("w", encoding="utf-8", newline="")
                self._files.append(file)
                self._rows[name] = csv.writer(file)
                self._rows[name].writerow(("log", *head))
        except OSError as error:
            raise self._cannot(error) from error

    def begin(self, log: Path) -> None:
        """The rows that follow are of this log."""
        self._log = str(log)

    def span(self, span: SpanRow) -> None:
        """A handler ran."""
        self._write("spans", [span])

    def study(self, found: Study) -> None:
        """A log is over: the tables that are made of all of it."""
        self._write("ledger", map(_ledger_row, found.ledger))
        self._write("topics", _topic_rows(found))
        self._write("chains", (row for one in found.chains for row in _hop_rows(one)))
        self._write("paths", map(_path_row, found.paths))
        self._write("beliefs", _belief_rows(found))

    def close(self) -> None:
        """Finish all files."""
        try:
            for file in self._files:
                file.close()
        except OSError as error:
            raise self._cannot(error) from error

    def _write(self, table: str, rows: Iterable[tuple[Any, ...]]) -> None:
        try:
            self._rows[table].writerows((self._log, *row) for row in rows)
        except OSError as error:
            raise self._cannot(error) from error

    def _cannot(self, error: OSError) -> LogWriteError:
        return LogWriteError(f"{self._folder}: cannot write tables: {error.strerror or error}")


def _ledger_row(entry: LedgerEntry) -> tuple[Any, ...]:
    came = entry.decided_ns != NEVER
    absent = () if came else ("decided_ns", "slack_ns")
    return tuple(None if name in absent else getattr(entry, name) for name in LEDGER)


def _topic_rows(found: Study) -> Iterator[tuple[Any, ...]]:
    for of in found.traffic:
        period = of.period
        yield (
            *(of.topic, of.number, of.rate_hz, period.min_s, period.median_s, period.p95_s),
            *(period.max_s, of.jitter_s, of.median_bytes, of.total_bytes, of.gaps),
        )


def _hop_rows(one: DecisionChain) -> Iterator[tuple[Any, ...]]:
    for number, hop in enumerate(one.chain.hops):
        yield (
            *(one.decision, one.kind, one.slack_ns, number, hop.topic, hop.source, hop.sequence),
            *(hop.process, hop.said_ns, hop.transport_ns, hop.queueing_ns, hop.computing_ns),
        )


def _path_row(of: PathTimes) -> tuple[Any, ...]:
    readings = (getattr(of, reading) for reading in READINGS)
    times = (t for r in readings for t in (r.min_s, r.median_s, r.p95_s, r.max_s))
    return " > ".join(of.topics), of.inputs, of.decisions, *times


def _belief_rows(found: Study) -> Iterator[tuple[Any, ...]]:
    for known in found.knowledge:
        of = known.belief
        true_map = of.true_map if of.sampled else None
        yield (
            *(of.at_s, of.visit, of.entropy, true_map, of.right, of.wrong, of.open),
            *(known.x, known.y, known.true_x, known.true_y),
        )
