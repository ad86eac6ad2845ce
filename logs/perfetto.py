"""A run as a trace that the Perfetto UI (https://ui.perfetto.dev) and its trace processor open.

The run is a track with one for each process below it, in the order of their priority. A handler
is a slice with its message and cells. A chain is a flow: arrows through the handlers that led to
a decision. Each kind of decision has a track too, with deadlines and misses as instants. Times
are nanoseconds since the run began.

The format is Perfetto's own: protobuf TrackEvents, as its page "Writing TrackEvent Protos
Synthetically" describes them (https://perfetto.dev/docs/reference/synthetic-track-event).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

from bus.messages import LedgerEntry
from bus.topics import PRIORITY
from logs import scan_kernels as k
from logs.chains import DecisionChain
from logs.decisions import KINDS, NEVER, cause_of, on_time
from logs.perfetto_schema import EXPLICIT, INSTANT, SLICE_BEGIN, SLICE_END, trace_type
from logs.reader import read_run
from logs.report import title
from logs.run_log import LogWriteError
from logs.scan import NAMES
from logs.study import Study

Handler: TypeAlias = tuple[str, str, int]
"""Process, source and sequence of the message that it handled: there is one slice of it."""

_SEQUENCE = 1
"""All packets are one sequence of packets, so their order in the file counts."""

_RUN_TRACK = 1


class _Span(NamedTuple):
    process: str
    topic: str
    source: str
    sequence: int
    start_ns: int
    end_ns: int
    cells: int


def write_trace(found: Study, path: Path) -> None:
    """Write the trace of the log that was studied, slice by slice, so that its size is no matter.

    Raises LogReadError if the log is not there any more, LogWriteError if ``path`` cannot be
    written.
    """
    try:
        with path.open("wb") as file:
            for packet in _packets(found):
                file.write(trace_type()(packet=[packet]).SerializeToString())
    except OSError as error:
        reason = error.strerror or error
        raise LogWriteError(f"{path}: cannot write the trace: {reason}") from error


def _packets(found: Study) -> Iterator[dict[str, Any]]:
    """All packets: a reader sorts them by time, those of one time stay as they are here."""
    processes = sorted(
        (load.process for load in found.analysis.loads),
        key=lambda name: PRIORITY.get(name, len(PRIORITY)),
    )
    kinds = list(dict.fromkeys((*KINDS, *(entry.kind for entry in found.ledger))))
    tracks = {name: number for number, name in enumerate(processes, start=_RUN_TRACK + 1)}
    below = {kind: number for number, kind in enumerate(kinds, start=_RUN_TRACK + 1 + len(tracks))}
    run = {"uuid": _RUN_TRACK, "name": title(found.analysis), "child_ordering": EXPLICIT}
    yield _track(run)
    for name, number in (*tracks.items(), *((f"{kind} deadlines", below[kind]) for kind in kinds)):
        yield _track({"uuid": number, "name": name, "parent_uuid": _RUN_TRACK})
    flows = _flows(found.chains)
    for span in _spans(found.analysis.path):
        yield from _slice(span, tracks[span.process], flows)
    for entry in found.ledger:
        yield from _deadline(entry, below[entry.kind])


def _track(described: dict[str, Any]) -> dict[str, Any]:
    described["sibling_order_rank"] = described["uuid"]
    return {"trusted_packet_sequence_id": _SEQUENCE, "track_descriptor": described}


def _event(time_ns: int, **event: Any) -> dict[str, Any]:
    return {
        "timestamp": time_ns,
        "trusted_packet_sequence_id": _SEQUENCE,
        "track_event": event,
    }


def _flows(chains: Sequence[DecisionChain]) -> dict[Handler, dict[str, list[int]]]:
    """The flows through each handler: those that go on from there and those that end there."""
    flows: dict[Handler, dict[str, list[int]]] = {}
    for number, one in enumerate(chains, start=1):
        hops = one.chain.hops
        if len(hops) < 2:  # an arrow needs two ends
            continue
        for hop in hops:
            how = "terminating_flow_ids" if hop is hops[-1] else "flow_ids"
            through = flows.setdefault((hop.process, hop.source, hop.sequence), {})
            through.setdefault(how, []).append(number)
    return flows


def _spans(path: str) -> Iterator[_Span]:
    with read_run(path) as reader:
        for block in reader.blocks():
            for row in block.spans[:, k.PROCESS :].tolist():
                process, topic, source, *numbers = row
                yield _Span(NAMES[process], NAMES[topic], NAMES[source], *numbers)


def _slice(
    span: _Span, track: int, flows: dict[Handler, dict[str, list[int]]]
) -> Iterator[dict[str, Any]]:
    yield _event(
        span.start_ns,
        type=SLICE_BEGIN,
        track_uuid=track,
        name=span.topic,
        categories=["handler"],
        debug_annotations=[
            {"name": "message", "string_value": f"{span.source} {span.sequence}"},
            {"name": "cells", "int_value": span.cells},
        ],
        **flows.get((span.process, span.source, span.sequence), {}),
    )
    yield _event(span.end_ns, type=SLICE_END, track_uuid=track)


def _deadline(entry: LedgerEntry, track: int) -> Iterator[dict[str, Any]]:
    named = f"{entry.kind} {entry.decision}"
    at: dict[str, Any] = {"type": INSTANT, "track_uuid": track}
    yield _event(entry.until_ns, **at, name=f"deadline {named}", categories=["deadline"])
    if on_time(entry):
        return
    notes: list[dict[str, Any]] = [
        {"name": "cause", "string_value": cause_of(entry)},
        {"name": "idle_ns", "int_value": entry.idle_ns},
    ]
    if entry.decided_ns != NEVER:
        notes.append({"name": "slack_ns", "int_value": entry.slack_ns})
    yield _event(
        entry.until_ns, **at, name=f"missed {named}", categories=["miss"], debug_annotations=notes
    )
