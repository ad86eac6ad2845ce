"""All that one log says about time and belief, in one pass that decodes only what it needs."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from bus import messages as m
from bus.topics import TOPICS
from bus.wire import Sent
from logs import scan_kernels as k
from logs.analysis import HEARD, Analysis, Tally, finite
from logs.ancestry import Node, ancestors
from logs.calibration import Calibration, Calibrations
from logs.chains import Chains, DecisionChain
from logs.knowledge import Knowledge, Known, Registration, registration
from logs.loads import ProcessTimes, SpanRow
from logs.log_index import LogIndex
from logs.paths import Paths, PathTimes
from logs.reader import LogReadError, RunReader, read_run
from logs.scan import NAMES, SPAN, TOPIC_NAMES, Block
from logs.schema import SchemaError, decode
from logs.slack import Slack, slack_of
from logs.spread import NS_PER_S
from logs.traffic import Traffic, all_traffic, new_counts
from logs.truth import Truth
from logs.wall import CostCheck, cost_checks

HOP = "hop_ns"
"""Metadata of a log: how long a message takes on the bus."""

_ABOUT_TRUTH = ("percept/arrival", "percept/blocked", "truth/building", "truth/pose")
_BELIEFS = ("reading/feature", "prior/junction", "belief/map")
_DECISION = "decision/"
_DECODED = np.array(
    [
        topic in {*HEARD, *_ABOUT_TRUTH, *_BELIEFS} - {SPAN} or topic.startswith(_DECISION)
        for topic in TOPICS
    ]
)
"""Which topics are decoded, by their place in the table; the others are only counted."""


OnSpan: TypeAlias = Callable[[SpanRow], None]


@dataclass(frozen=True)
class Study:
    """All that one log says.

    ``unknown_parents`` is how many of the messages that decisions were made from, at any remove,
    were not found; a chain that goes through one is cut short there. ``costs`` is empty where
    the log has no wall stamps beside it.
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
    costs: tuple[CostCheck, ...]
    ledger: tuple[m.LedgerEntry, ...]


class _Listener:
    """Takes a log in, block by block."""

    def __init__(self, path: Path, epoch_ns: int, hop_ns: int, on_span: OnSpan | None) -> None:
        self.path = path
        self.hop_ns = hop_ns
        self.epoch_ns = epoch_ns
        self.tally = Tally()
        self.counts = new_counts()
        self.index = LogIndex(epoch_ns)
        self.chains = Chains(self.index, hop_ns)
        self.paths = Paths()
        self.unknown = 0
        self.truth = Truth()
        self.calibrations = Calibrations(self.truth)
        self.known = Known(self.truth)
        self._on_span = on_span

    def hear(self, block: Block) -> None:
        """Take a block into account."""
        self.index.take(block)
        for topic, of in block.by_topic:
            said_ns = of.stamp_ns - self.epoch_ns
            self.counts[topic].add_block(said_ns, of.end - of.begin, of.sequence, of.previous)
        self._spans(block.spans)
        for row in np.flatnonzero(_DECODED[block.topics]).tolist():
            topic = TOPIC_NAMES[block.topics[row]]
            sent = decode(topic, block.message(row))
            if topic.startswith(_DECISION):
                self._decision(sent)
            else:
                self._message(sent)
        self.chains.catch_up()

    def _spans(self, spans: NDArray[np.int64]) -> None:
        known, said_ns = self._said_ns(spans)
        start_ns, end_ns = spans[:, k.START_NS], spans[:, k.END_NS]
        waited_ns = start_ns - said_ns
        waited_ns -= np.minimum(waited_ns, self.hop_ns)  # the transport
        pairs = spans[:, k.PROCESS] * len(NAMES) + spans[:, k.TOPIC]
        for pair in np.unique(pairs).tolist():
            of = pairs == pair
            process, topic = divmod(pair, len(NAMES))
            self.tally.loads.add_block(
                NAMES[process],
                NAMES[topic],
                (end_ns - start_ns)[of],
                int(spans[of, k.CELLS].sum()),
                waited_ns[of & known],
            )
        if self._on_span is not None:
            for row, its_known, its_said_ns in zip(spans, known, said_ns, strict=True):
                process, topic, source, *numbers = row[k.PROCESS :].tolist()
                sequence, start, end, cells = numbers
                names = (NAMES[process], NAMES[topic], NAMES[source])
                said = int(its_said_ns) if its_known else None
                self._on_span(SpanRow(*names, sequence, said, start, end, cells))

    def _said_ns(self, spans: NDArray[np.int64]) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
        """When the messages of spans were said: which are known, and their times."""
        known = np.zeros(len(spans), np.bool_)
        said_ns = np.zeros(len(spans), np.int64)
        for source in np.unique(spans[:, k.SOURCE]).tolist():
            of = spans[:, k.SOURCE] == source
            known[of], said_ns[of] = self.index.said_ns(NAMES[source], spans[of, k.ABOUT])
        return known, said_ns

    def _decision(self, sent: Sent) -> None:
        node = Node(sent.topic, sent.source, sent.sequence, sent.said_ns, sent.parents)
        made = ancestors(self.index, node)
        self.unknown += made.unknown
        self.paths.decided(made)
        self.chains.decided(made, getattr(sent.message, "decision", None))

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
        self.chains.catch_up(last=True)
        knowledge = self.known.each()
        return Study(
            analysis=self.tally.analysis(reader),
            hop_ns=self.hop_ns,
            slack=slack_of(self.tally.ledger),
            chains=self.chains.settled(self.tally.ledger),
            unknown_parents=self.unknown,
            paths=self.paths.times(),
            processes=self.tally.loads.times(),
            traffic=all_traffic(self.counts),
            calibration=self.calibrations.all(),
            knowledge=knowledge,
            registration=registration(knowledge),
            costs=cost_checks(self.path),
            ledger=tuple(self.tally.ledger),
        )


def study(path: str | Path, on_span: OnSpan | None = None) -> Study:
    """Study a log in one pass. Raises LogReadError if it is not the log of a run.

    ``on_span`` gets every span's record, with the message it is about where that is known. A log
    that does not say how long a hop takes has all time before a handler counted as queueing.
    """
    with read_run(path) as reader:
        listener = _Listener(Path(path), reader.epoch_ns, _hop_ns(reader), on_span)
        for block in reader.blocks():
            try:
                listener.hear(block)
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
