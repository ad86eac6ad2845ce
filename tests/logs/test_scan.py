"""What a scan of bytes finds must be what decoding each message finds."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus import messages as m
from bus.topics import CLOCK
from bus.wire import Sent
from logs.log_index import LogIndex
from logs.reader import LogReadError, read_run
from logs.run_log import RunLog
from logs.scan import NAMES, ScanError, Scanner
from logs.scan_kernels import PROCESS, SOURCE, TOPIC
from logs.traffic import TopicCount
from tests.logs.conftest import EPOCH_NS

MakeLog: TypeAlias = Callable[[list[Sent]], Path]
INT64 = st.integers(-(2**63), 2**63 - 1)


def _scanned(path: Path) -> list[tuple[object, ...]]:
    """Every message of a log as the scan has it."""
    with read_run(path) as reader:
        return [
            (topic, sequence, previous, stamp_ns - reader.epoch_ns)
            for block in reader.blocks()
            for topic, of in block.by_topic
            for sequence, previous, stamp_ns in zip(
                of.sequence.tolist(), of.previous.tolist(), of.stamp_ns.tolist(), strict=True
            )
        ]


def _spans(path: Path) -> list[m.Span]:
    with read_run(path) as reader:
        rows = np.concatenate([block.spans for block in reader.blocks()]).tolist()
    return [
        m.Span(NAMES[row[PROCESS]], NAMES[row[TOPIC]], NAMES[row[SOURCE]], *row[SOURCE + 1 :])
        for row in rows
    ]


def test_a_real_log_scans_as_it_decodes(late_run: Path) -> None:
    with read_run(late_run) as reader:
        decoded = list(reader)
    said = [(s.topic, s.sequence, s.previous, s.said_ns) for s in decoded]
    assert sorted(_scanned(late_run), key=repr) == sorted(said, key=repr)
    spans = [s.message for s in decoded if isinstance(s.message, m.Span)]
    assert [msgspec.structs.astuple(s) for s in _spans(late_run)] == [
        msgspec.structs.astuple(s) for s in spans
    ]


def test_a_scan_counts_as_decoding_does(late_run: Path) -> None:
    with read_run(late_run) as decoding, read_run(late_run) as scanning:
        list(decoding)
        list(scanning.blocks())
    assert scanning.counts == decoding.counts
    assert (scanning.missing, scanning.truncated) == (decoding.missing, decoding.truncated)
    assert scanning.last_said_ns == decoding.last_said_ns


@given(st.lists(st.tuples(INT64, INT64, INT64, st.integers(0, 2**62)), min_size=1, max_size=20))
def test_numbers_of_any_size_are_read_as_they_were_written(
    tmp_path_factory: pytest.TempPathFactory, numbers: list[tuple[int, int, int, int]]
) -> None:
    path = tmp_path_factory.mktemp("scan") / "numbers.mcap"
    spans = [
        m.Span("sensor", "percept/sonar", "world", sequence, start_ns, end_ns, cells)
        for start_ns, end_ns, cells, sequence in numbers
    ]
    with RunLog(path, EPOCH_NS, {}, {}) as log:
        for number, span in enumerate(spans):
            log.write(Sent("clock/span", CLOCK, number, number - 1, number, (("world", 0),), span))
    assert [msgspec.structs.astuple(s) for s in _spans(path)] == [
        msgspec.structs.astuple(s) for s in spans
    ]


def test_a_cut_log_is_scanned_as_far_as_it_goes(late_run: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(late_run.read_bytes()[: late_run.stat().st_size // 2])
    with read_run(cut) as reader, read_run(cut) as decoding:
        blocks = list(reader.blocks())
        decoded = list(decoding)
    assert sum(len(block.messages) for block in blocks) == len(decoded) > 1000
    assert reader.truncated
    assert reader.problem == decoding.problem


def test_a_span_of_a_process_that_there_is_not_is_an_error(make_log: MakeLog) -> None:
    span = m.Span("nobody", "ledger", "world", 0, 0, 0, 0)
    path = make_log([Sent("clock/span", CLOCK, 0, -1, 0, (), span)])
    with read_run(path) as reader, pytest.raises(LogReadError, match="process or topic that there"):
        list(reader.blocks())


@given(st.binary(max_size=200))
def test_bytes_that_are_no_records_are_refused_or_passed_over(data: bytes) -> None:
    try:
        block = Scanner(lambda _: None, {}).block(data)
    except ScanError as error:
        assert "of a chunk" in str(error)
    else:
        assert len(block.messages) == 0


def test_the_index_forgets_what_is_too_long_ago(late_run: Path) -> None:
    with read_run(late_run) as reader:
        whole, small = LogIndex(reader.epoch_ns), LogIndex(reader.epoch_ns, window=64)
        for block in reader.blocks():
            whole.take(block)
            small.take(block)
    first = ("world", 0)
    heard = (("sensor", number) for number in range(2000, 2010))  # not each is for the reactor
    last = next(said for said in heard if whole.span("reactor", said) is not None)
    node = whole.find(first)
    assert node is not None
    assert (node.topic, node.said_ns) == ("truth/building", 0)
    assert small.find(first) is None
    assert small.span("reactor", last) is None
    assert whole.find(("world", 10**9)) is None
    assert whole.find(("intruder", 0)) is None


def _count(links: list[tuple[int, int]]) -> TopicCount:
    count = TopicCount()
    for previous, sequence in links:
        count.add(0, 1, sequence, previous)
    return count


@given(st.permutations(range(8)), st.sets(st.integers(1, 6)))
def test_gaps_are_what_is_named_and_not_there_in_whatever_order(
    order: list[int], lost: set[int]
) -> None:
    links = [(k - 1, k) for k in order if k not in lost]
    named = {previous for previous, _ in links} - {-1}
    gaps = len(named & lost)
    assert _count(links).gaps == gaps
    block = TopicCount()
    column = np.array(links)
    block.add_block(column[:, 0] * 0, column[:, 0] * 0, column[:, 1], column[:, 0])
    assert block.gaps == gaps
