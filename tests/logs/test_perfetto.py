"""A trace must be what Perfetto's format says, read by hand and by Perfetto's own classes.

The numbers of fields are those of https://perfetto.dev/docs/reference/trace-packet-proto.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from logs.decisions import on_time
from logs.perfetto import write_trace
from logs.reader import LogReadError
from logs.run_log import LogWriteError
from logs.study import Study, study
from tests.logs.conftest import MakeLog
from tests.logs.wire_format import Value, fields, signed, text

BEGIN, END, INSTANT = 1, 2, 3


@dataclass(frozen=True)
class Event:
    at_ns: int
    kind: int
    track: int
    name: str = ""
    category: str = ""
    notes: dict[str, str | int] = field(default_factory=dict)
    flows: tuple[int, ...] = ()
    ends: tuple[int, ...] = ()


@dataclass(frozen=True)
class Trace:
    """``tracks``: name and parent by uuid, in the order of their ranks."""

    tracks: dict[int, tuple[str, int]]
    events: list[Event]


def _message(value: Value) -> dict[int, list[Value]]:
    assert isinstance(value, bytes)
    return fields(value)


def _note(note: dict[int, list[Value]]) -> str | int:
    return text(note[6][0]) if 6 in note else signed(note[4][0])


def _event(at_ns: Any, of: dict[int, Any]) -> Event:
    notes = [_message(note) for note in of.get(4, [])]
    return Event(
        at_ns,
        of[9][0],
        of[11][0],
        text(of.get(23, [b""])[0]),
        text(of.get(22, [b""])[0]),
        {text(note[10][0]): _note(note) for note in notes},
        tuple(of.get(47, ())),
        tuple(of.get(48, ())),
    )


def by_hand(data: bytes) -> Trace:
    """A trace as the wire format alone gives it."""
    trace = fields(data)
    assert set(trace) == {1}
    ranked: list[tuple[int, int, str, int]] = []
    events: list[Event] = []
    for packet in map(_message, trace[1]):
        assert packet[10] == [1]  # one sequence of packets
        if 60 in packet:
            of: dict[int, Any] = _message(packet[60][0])
            ranked.append((of[12][0], of[1][0], text(of[2][0]), of.get(5, [0])[0]))
        else:
            events.append(_event(packet[8][0], _message(packet[11][0])))
    return Trace({uuid: (name, parent) for _, uuid, name, parent in sorted(ranked)}, events)


def by_perfetto(data: bytes) -> Trace:
    """The same, as Perfetto's own classes give it."""
    pb2 = importlib.import_module("perfetto.protos.perfetto.trace.perfetto_trace_pb2")
    tracks = [p.track_descriptor for p in pb2.Trace.FromString(data).packet if not p.timestamp]
    tracks = sorted((t for t in tracks if t.uuid), key=lambda track: track.sibling_order_rank)
    events = [
        Event(
            packet.timestamp,
            packet.track_event.type,
            packet.track_event.track_uuid,
            packet.track_event.name,
            "".join(packet.track_event.categories),
            {
                note.name: getattr(note, note.WhichOneof("value"))
                for note in packet.track_event.debug_annotations
            },
            tuple(packet.track_event.flow_ids),
            tuple(packet.track_event.terminating_flow_ids),
        )
        for packet in pb2.Trace.FromString(data).packet
        if packet.HasField("track_event")
    ]
    return Trace({t.uuid: (t.name, t.parent_uuid) for t in tracks}, events)


@pytest.fixture(scope="module")
def written(late_run: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Study, bytes]:
    path = tmp_path_factory.mktemp("trace") / "late.pftrace"
    found = study(late_run)
    write_trace(found, path)
    return found, path.read_bytes()


@pytest.fixture(scope="module")
def traced(written: tuple[Study, bytes]) -> tuple[Study, Trace]:
    return written[0], by_hand(written[1])


def test_perfettos_own_classes_read_the_same(written: tuple[Study, bytes]) -> None:
    pytest.importorskip(
        "perfetto.protos.perfetto.trace.perfetto_trace_pb2",
        reason="perfetto (pip install perfetto) is not here",
    )
    assert by_perfetto(written[1]) == by_hand(written[1])


def test_processes_and_kinds_of_decisions_are_tracks_of_the_run(
    traced: tuple[Study, Trace],
) -> None:
    found, trace = traced
    (run, *others) = trace.tracks.items()
    assert run[1][0].startswith("aces, seed 1: ")
    assert {parent for _, (_, parent) in others} == {run[0]}
    names = [name for _, (name, _) in others]
    assert names == [
        *("world", "reactor", "sensor", "detectors", "classifier", "geographer", "decider"),
        *("sensing deadlines", "path deadlines", "reaction deadlines"),
    ]
    assert {event.track for event in trace.events} <= {uuid for uuid, _ in others}
    assert found.ledger


def test_every_handler_is_a_slice_in_nanoseconds(traced: tuple[Study, Trace]) -> None:
    found, trace = traced
    opened: dict[int, Event] = {}
    took_ns: list[int] = []
    for event in sorted(trace.events, key=lambda event: event.at_ns):  # stable, as Perfetto does
        if event.kind == BEGIN:
            assert event.track not in opened  # a process does one thing at a time
            opened[event.track] = event
            assert (event.category, set(event.notes)) == ("handler", {"message", "cells"})
        elif event.kind == END:
            took_ns.append(event.at_ns - opened.pop(event.track).at_ns)
    assert not opened
    assert len(took_ns) == sum(load.handlers for load in found.analysis.loads)
    assert max(took_ns) == 45 * 10**9
    cells = sum(int(e.notes["cells"]) for e in trace.events if e.kind == BEGIN)
    assert cells == sum(load.cells for load in found.analysis.loads)


def test_a_flow_goes_through_the_handlers_of_its_chain(traced: tuple[Study, Trace]) -> None:
    found, trace = traced
    through: dict[int, list[tuple[str, str]]] = {}
    for event in sorted(trace.events, key=lambda event: event.at_ns):
        for flow in event.flows + event.ends:
            assert event.kind == BEGIN
            handler = (trace.tracks[event.track][0], str(event.notes["message"]))
            through.setdefault(flow, []).append(handler)
    chains = [one.chain for one in found.chains]
    assert through == {
        number: [(hop.process, f"{hop.source} {hop.sequence}") for hop in chain.hops]
        for number, chain in enumerate(chains, start=1)
    }
    ends = {flow: str(e.notes["message"]) for e in trace.events for flow in e.ends}
    assert ends == {
        number: f"{chain.hops[-1].source} {chain.hops[-1].sequence}"
        for number, chain in enumerate(chains, start=1)
    }


def test_deadlines_and_misses_are_instants(traced: tuple[Study, Trace]) -> None:
    found, trace = traced
    instants = [event for event in trace.events if event.kind == INSTANT]
    assert [(e.at_ns, e.name) for e in instants if e.category == "deadline"] == [
        (of.until_ns, f"deadline {of.kind} {of.decision}") for of in found.ledger
    ]
    late = [of for of in found.ledger if not on_time(of)]
    assert late
    assert [(e.at_ns, e.name, e.notes) for e in instants if e.category == "miss"] == [
        (
            of.until_ns,
            f"missed {of.kind} {of.decision}",
            {"cause": of.cause, "idle_ns": of.idle_ns, "slack_ns": of.slack_ns},
        )
        for of in late
    ]
    assert all(of.slack_ns < 0 for of in late)


def test_a_decision_that_never_came_has_no_slack(run_path: Path, tmp_path: Path) -> None:
    out = tmp_path / "run.pftrace"
    write_trace(study(run_path), out)
    notes = {e.name: e.notes for e in by_hand(out.read_bytes()).events if e.category == "miss"}
    assert notes == {
        "missed path 4": {"cause": "overrun", "idle_ns": 20 * 10**9, "slack_ns": -20 * 10**9},
        "missed path 6": {"cause": "message lost", "idle_ns": 10 * 10**9},
    }


def test_a_trace_that_cannot_be_made_says_so(make_log: MakeLog, tmp_path: Path) -> None:
    log = make_log([])
    found = study(log)
    write_trace(found, tmp_path / "empty.pftrace")
    assert by_hand((tmp_path / "empty.pftrace").read_bytes()).events == []
    with pytest.raises(LogWriteError, match="no/where: cannot write the trace: No such file"):
        write_trace(found, tmp_path / "no/where")
    log.unlink()
    with pytest.raises(LogReadError, match=r"RUN\.mcap"):
        write_trace(found, tmp_path / "late.pftrace")
