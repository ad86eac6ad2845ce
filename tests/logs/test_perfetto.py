"""A trace must keep to the Trace Event Format."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from logs.perfetto import PerfettoFile
from logs.run_log import LogWriteError
from logs.study import Study, study

NEEDED = {
    "X": {"name", "cat", "ts", "dur", "pid", "tid"},
    "M": {"name", "pid", "args"},
    "i": {"name", "ts", "pid", "tid", "s"},
    "s": {"name", "cat", "id", "ts", "pid", "tid"},
    "t": {"name", "cat", "id", "ts", "pid", "tid"},
    "f": {"name", "cat", "id", "ts", "pid", "tid", "bp"},
}


@pytest.fixture(scope="module")
def traced(
    late_run: Path, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Study, list[dict[str, Any]]]:
    path = tmp_path_factory.mktemp("trace") / "trace.json"
    trace = PerfettoFile(path)
    found = study(late_run, trace.span)
    trace.close(found.chains, found.ledger)
    return found, json.loads(path.read_text())["traceEvents"]


def test_every_event_has_what_its_phase_needs(
    traced: tuple[Study, list[dict[str, Any]]],
) -> None:
    _, events = traced
    for event in events:
        assert NEEDED[event["ph"]] <= set(event), event
        if "ts" in event:
            assert event["ts"] >= 0
        assert event.get("dur", 0) >= 0
        assert event.get("s", "t") in ("g", "p", "t")
    assert {event["ph"] for event in events} == set(NEEDED)


def test_each_process_is_a_track_with_a_name(
    traced: tuple[Study, list[dict[str, Any]]],
) -> None:
    _, events = traced
    names = [e["args"]["name"] for e in events if e["name"] == "process_name"]
    assert len(set(names)) == len(names)
    assert {"world", "classifier", "decider"} <= set(names)
    named = {e["pid"] for e in events if e["name"] == "process_name"}
    assert {e["pid"] for e in events} == named


def test_every_handler_is_a_slice_in_microseconds(
    traced: tuple[Study, list[dict[str, Any]]],
) -> None:
    found, events = traced
    slices = [event for event in events if event["ph"] == "X"]
    assert len(slices) == sum(load.handlers for load in found.analysis.loads)
    assert max(event["dur"] for event in slices) == 45e6
    assert all({"topic", "cells"} <= set(event["args"]) for event in slices)


def test_flows_begin_once_end_once_and_touch_handlers(
    traced: tuple[Study, list[dict[str, Any]]],
) -> None:
    found, events = traced
    slices = {(e["pid"], e["ts"]) for e in events if e["ph"] == "X"}
    flows: dict[int, list[dict[str, Any]]] = {}
    for event in events:
        if event["ph"] in "stf":
            flows.setdefault(event["id"], []).append(event)
            assert (event["pid"], event["ts"]) in slices
    assert len(flows) == sum(len(one.chain.hops) > 1 for one in found.chains)
    for flow in flows.values():
        assert "".join(e["ph"] for e in flow) == "s" + "t" * (len(flow) - 2) + "f"
        assert len({(e["name"], e["cat"]) for e in flow}) == 1  # what Perfetto matches beside ids
        assert [e["ts"] for e in flow] == sorted(e["ts"] for e in flow)


def test_deadlines_and_misses_are_instants(
    traced: tuple[Study, list[dict[str, Any]]],
) -> None:
    found, events = traced
    deadlines = [e for e in events if e.get("cat") == "deadline"]
    misses = [e for e in events if e.get("cat") == "miss"]
    assert [e["ts"] for e in deadlines] == [entry.until_ns / 1000 for entry in found.ledger]
    assert len(misses) == len(found.analysis.late) > 0
    assert all(e["args"]["slack_ns"] < 0 and e["args"]["cause"] for e in misses)


def test_a_trace_that_cannot_be_written_says_so(tmp_path: Path) -> None:
    with pytest.raises(LogWriteError, match="no/where: cannot write the trace"):
        PerfettoFile(tmp_path / "no/where")
