"""A run as a trace that the Perfetto UI (https://ui.perfetto.dev) and chrome://tracing open.

The Trace Event Format (JSON): a process of the run is a track; a handler is a complete event
(``X``) with its topic and cells; a chain is a flow (``s``, ``t``, ``f``) through the handlers
that led to a decision; deadlines and misses are instant events (``i``). Times are microseconds
since the run began; fractions keep the nanoseconds.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any, TypeAlias

from bus.messages import LedgerEntry
from bus.topics import PRIORITY, TOPICS
from logs.chains import DecisionChain
from logs.decisions import NEVER, on_time
from logs.loads import SpanRow
from logs.run_log import LogWriteError

Event: TypeAlias = dict[str, Any]

THREAD = 1


def microseconds(time_ns: int) -> float:
    """A time of the trace."""
    return time_ns / 1000


class PerfettoFile:
    """Writes one trace, slice by slice, so that its size is no matter. Raises LogWriteError."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._pids: dict[str, int] = {}
        self._first = True
        try:
            self._file: IO[str] = path.open("w", encoding="utf-8")
        except OSError as error:
            raise self._cannot(error) from error
        self._put('{"displayTimeUnit": "ms", "traceEvents": [\n')

    def span(self, span: SpanRow) -> None:
        """A handler ran."""
        begins = microseconds(span.start_ns)
        self._event(
            {
                "ph": "X",
                "name": span.topic,
                "cat": "handler",
                "ts": begins,
                "dur": microseconds(span.end_ns - span.start_ns),
                "pid": self._pid(span.process),
                "tid": THREAD,
                "args": {
                    "topic": span.topic,
                    "message": f"{span.source} {span.sequence}",
                    "cells": span.cells,
                },
            }
        )

    def close(
        self, chains: tuple[DecisionChain, ...] = (), ledger: tuple[LedgerEntry, ...] = ()
    ) -> None:
        """End the trace with its flows and deadlines."""
        for number, one in enumerate(chains, start=1):
            for event in self._flow(number, one):
                self._event(event)
        for entry in ledger:
            for event in self._deadline(entry):
                self._event(event)
        self._put("\n]}\n")
        try:
            self._file.close()
        except OSError as error:
            raise self._cannot(error) from error

    def _flow(self, number: int, one: DecisionChain) -> Iterator[Event]:
        hops = one.chain.hops
        if len(hops) < 2:  # an arrow needs two ends
            return
        for k, hop in enumerate(hops):
            last = k == len(hops) - 1
            event: Event = {
                "ph": "s" if k == 0 else "f" if last else "t",
                "id": number,
                "name": f"{one.kind} {one.decision}",
                "cat": "chain",
                "ts": microseconds(hop.said_ns + hop.transport_ns + hop.queueing_ns),
                "pid": self._pid(hop.process),
                "tid": THREAD,
            }
            if last:
                event["bp"] = "e"  # it ends in the handler that encloses this moment
            yield event

    def _deadline(self, entry: LedgerEntry) -> Iterator[Event]:
        decides = TOPICS.get(f"decision/{entry.kind}")
        event: Event = {
            "ph": "i",
            "name": f"deadline {entry.kind} {entry.decision}",
            "cat": "deadline",
            "ts": microseconds(entry.until_ns),
            "pid": self._pid(decides.publisher if decides else entry.kind),
            "tid": THREAD,
            "s": "t",
        }
        yield event
        if not on_time(entry):
            slack_ns = None if entry.decided_ns == NEVER else entry.slack_ns
            args = {"slack_ns": slack_ns, "cause": entry.cause, "idle_ns": entry.idle_ns}
            name = f"missed {entry.kind} {entry.decision}"
            yield {**event, "name": name, "cat": "miss", "s": "g", "args": args}

    def _pid(self, process: str) -> int:
        """The track of a process, announced when it is first needed."""
        pid = self._pids.get(process)
        if pid is None:
            pid = self._pids[process] = len(self._pids) + 1
            order = PRIORITY.get(process, len(PRIORITY))
            for name, args in (
                ("process_name", {"name": process}),
                ("process_sort_index", {"sort_index": order}),
                ("thread_name", {"name": "handlers"}),
            ):
                self._event({"ph": "M", "name": name, "pid": pid, "tid": THREAD, "args": args})
        return pid

    def _event(self, event: Event) -> None:
        self._put(("" if self._first else ",\n") + json.dumps(event))
        self._first = False

    def _put(self, text: str) -> None:
        try:
            self._file.write(text)
        except OSError as error:
            raise self._cannot(error) from error

    def _cannot(self, error: OSError) -> LogWriteError:
        return LogWriteError(f"{self._path}: cannot write the trace: {error.strerror or error}")
