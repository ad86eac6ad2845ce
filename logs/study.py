"""All that one log says about time and belief, in one pass that decodes only what it needs."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, TypeAlias

from bus import messages as m
from bus.topics import WORLD
from bus.wire import Sent
from logs.analysis import HEARD, Analysis, Tally, finite
from logs.ancestry import Ancestry, Node
from logs.calibration import Calibration, Calibrations
from logs.chains import Chains, DecisionChain, transport_ns
from logs.knowledge import Knowledge, Known, Registration, registration
from logs.loads import ProcessTimes
from logs.paths import Paths, PathTimes
from logs.reader import LogReadError, RunReader, read_run
from logs.schema import Record, SchemaError, parse, sent_of
from logs.slack import Slack, slack_of
from logs.spread import NS_PER_S
from logs.traffic import Traffic, all_traffic, new_counts
from logs.truth import Truth

SPAN = "clock/span"
HOP = "hop_ns"
"""Metadata of a log: how long a message takes on the bus."""

_ABOUT_TRUTH = ("percept/arrival", "percept/blocked", "truth/building", "truth/pose")
_BELIEFS = ("reading/feature", "prior/junction", "belief/map")
_DECODED = frozenset((*HEARD, *_ABOUT_TRUTH, *_BELIEFS)) - {SPAN}
_NUMBERED = ("decision/sensing", "decision/path")
_DECISION = "decision/"

OnSpan: TypeAlias = Callable[[Record, Node | None], None]


@dataclass(frozen=True)
class Study:
    """All that one log says.

    ``unknown_parents`` is how many parents of messages were not found; chains that go through
    one are cut short there.
    """

    analysis: Analysis
    hop_ns: int
    slack: tuple[Slack, ...]
    chains: tuple[DecisionChain, ...]
    unknown_parents: int
    paths: tuple[PathTimes, ...]
    processes: tuple[ProcessTimes, ...]
    traffic: tuple[Traffic, ...]
    calibration: tuple[Calibration, ...]
    knowledge: tuple[Knowledge, ...]
    registration: Registration
    ledger: tuple[m.LedgerEntry, ...]


class _Listener:
    """Takes a log in, message by message."""

    def __init__(self, hop_ns: int, on_span: OnSpan | None) -> None:
        self.hop_ns = hop_ns
        self.tally = Tally()
        self.counts = new_counts()
        self.ancestry = Ancestry()
        self.chains = Chains(hop_ns)
        self.paths = Paths()
        self.truth = Truth()
        self.calibrations = Calibrations(self.truth)
        self.known = Known(self.truth)
        self._on_span = on_span

    def hear(self, topic: str, said_ns: int, data: bytes) -> None:
        """Take one message into account."""
        record = parse(topic, data)
        sequence = record.sequence
        self.counts[topic].add(said_ns, len(data), sequence, record.previous)
        if topic == SPAN:
            self._span(record)
            return
        parents = [(parent.source, parent.sequence) for parent in record.parents]
        node = self.ancestry.hear(topic, record.source, sequence, said_ns, parents)
        if topic.startswith(_DECISION):
            self.chains.decided(node, record.decision if topic in _NUMBERED else None)
            self.paths.decided(node)
        if topic in _DECODED:
            self._message(sent_of(topic, record))

    def _span(self, span: Record) -> None:
        process, topic = span.process, span.topic
        source, sequence = span.about_source, span.about_sequence
        start_ns, end_ns = span.start_ns, span.end_ns
        node = self.ancestry.find((source, sequence))
        waited_ns = None
        if node is not None:
            node.spans.append((process, start_ns, end_ns))
            waited_ns = start_ns - node.said_ns
            waited_ns -= transport_ns(node.said_ns, start_ns, self.hop_ns)
            if process == WORLD and topic.startswith(_DECISION):
                self.chains.heard(source, sequence)
        self.tally.loads.add(process, topic, end_ns - start_ns, span.cells, waited_ns)
        if self._on_span is not None:
            self._on_span(span, node)

    def _message(self, sent: Sent) -> None:
        if sent.topic in HEARD:
            self.tally.hear(sent)
        visit = self.truth.hear(sent.message)
        if visit is not None:
            self.calibrations.arrived(visit)
        match sent.message:
            case m.Reading() as reading:
                self.calibrations.read(reading)
            case m.JunctionPrior() as prior:
                self.calibrations.expected(prior)
            case m.MapBelief() as belief:
                if self.known.believed(belief, sent.said_ns / NS_PER_S):
                    self.calibrations.believed(belief)

    def study(self, reader: RunReader) -> Study:
        """Sum up; the reader must have come to its end."""
        self.chains.finish()
        knowledge = self.known.each()
        return Study(
            analysis=self.tally.analysis(reader),
            hop_ns=self.hop_ns,
            slack=slack_of(self.tally.ledger),
            chains=self.chains.settled(self.tally.ledger),
            unknown_parents=self.ancestry.unknown,
            paths=self.paths.times(),
            processes=self.tally.loads.times(),
            traffic=all_traffic(self.counts),
            calibration=self.calibrations.all(),
            knowledge=knowledge,
            registration=registration(knowledge),
            ledger=tuple(self.tally.ledger),
        )


def study(path: str | Path, on_span: OnSpan | None = None) -> Study:
    """Study a log in one pass. Raises LogReadError if it is not the log of a run.

    ``on_span`` gets every span's record, with the message it is about where that is known. A log
    that does not say how long a hop takes has all time before a handler counted as queueing.
    """
    with read_run(path) as reader:
        listener = _Listener(_hop_ns(reader), on_span)
        for topic, said_ns, data in reader.raw():
            try:
                listener.hear(topic, said_ns, data)
            except SchemaError as error:
                raise LogReadError(f"{reader.path}: {error}") from error
    return listener.study(reader)


def _hop_ns(reader: RunReader) -> int:
    text = reader.metadata.get(HOP, "0")
    if not text.isdecimal():
        raise LogReadError(f"{reader.path}: metadata {HOP}: found {text!r}, expected nanoseconds")
    return int(text)


def study_to_json(found: Study) -> dict[str, Any]:
    """A plain dict of a study: the analysis's fields, then the others; times say their unit.

    It is strict JSON: a number that is not finite becomes None.
    """
    plain = {key: value for key, value in asdict_of(found).items() if key != "analysis"}
    return finite({**asdict(found.analysis), **plain})


def asdict_of(found: Study) -> dict[str, Any]:
    """The fields of a study as plain values, what its chains come to added to each."""
    plain = {
        name: json.loads(json.dumps(getattr(found, name), default=_plain))
        for name in found.__dataclass_fields__
        if name not in ("analysis", "ledger")
    }
    for row, one in zip(plain["chains"], found.chains, strict=True):
        row["chain"] |= {"response_ns": one.chain.response_ns, "topics": one.chain.topics}
    for row, known in zip(plain["knowledge"], found.knowledge, strict=True):
        row["registered"] = known.registered
    plain["ledger"] = [{f: getattr(e, f) for f in e.__struct_fields__} for e in found.ledger]
    return plain


def _plain(value: Any) -> Any:
    return asdict(value)
