"""Whatever is changed in a log, the change is found where it is, from both sides."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.messages import Odometry, Ranges, Span
from bus.topics import CLOCK, MODULES, PRIORITY
from bus.wire import Sent
from logs.diff.contents import field_differences
from logs.first_difference import Comparison, compare_logs
from logs.run_log import RunLog
from tests.scenarios.runs import LITTLE, everything_said, scenario_of

MESSAGES = 750
"""The beginning of a run: driving, sensing, all that is decided for a first junction."""

LAST = 50
"""Of the last ones it is not known whether they would have come yet."""

MIRRORED = {"missing": "extra", "extra": "missing"}


@cache
def run() -> tuple[Sent, ...]:
    return everything_said(scenario_of(LITTLE))[:MESSAGES]


def in_order(said: Sequence[Sent]) -> list[Sent]:
    return sorted(
        said, key=lambda s: (s.said_ns, PRIORITY.get(s.source, len(PRIORITY)), s.source, s.sequence)
    )


def process_of(sent: Sent) -> str:
    of_clock = sent.source == CLOCK
    return str(getattr(sent.message, "process", CLOCK)) if of_clock else sent.source


def compared(base: Sequence[Sent], new: Sequence[Sent]) -> tuple[Comparison, Comparison]:
    """The comparison of two logs, both ways."""
    with tempfile.TemporaryDirectory() as folder:
        paths = [Path(folder) / name for name in ("base.mcap", "new.mcap")]
        for path, said in zip(paths, (base, new), strict=True):
            with RunLog(path, 0, {}, {}) as log:
                for sent in said:
                    log.write(sent)
        return compare_logs(*paths), compare_logs(*reversed(paths))


@settings(max_examples=25)
@given(st.integers(0, MESSAGES - LAST), st.booleans())
def test_a_message_that_is_gone_is_missed_at_its_place(at: int, renumber: bool) -> None:
    gone = run()[at]
    after = [
        replace(s, sequence=s.sequence - 1) if renumber and s.source == gone.source else s
        for s in run()[at + 1 :]
    ]
    found, mirrored = compared(run(), [*run()[:at], *after])
    first, other = found.first, mirrored.first
    assert first is not None and other is not None
    assert (first.at_ns, first.source) == (gone.said_ns, process_of(gone))
    assert (first.topic, first.sequence) == (gone.topic, gone.sequence)
    assert (first.kind, other.kind) == ("missing", "extra")
    assert (other.at_ns, other.source, other.sequence) == (
        first.at_ns,
        first.source,
        first.sequence,
    )
    assert found.equal == at


def test_an_echo_less_is_not_taken_for_the_next_one() -> None:
    at = next(k for k, s in enumerate(run()) if k > 100 and s.topic == "percept/sonar")
    after = [
        replace(s, sequence=s.sequence - 1) if s.source == "world" else s for s in run()[at + 1 :]
    ]
    found, _ = compared(run(), [*run()[:at], *after])
    assert found.first is not None
    assert found.first.kind == "missing"
    assert found.first.what.endswith("was said in base only")


@settings(max_examples=25)
@given(st.integers(0, MESSAGES - LAST), st.integers(1, 10**9))
def test_a_message_at_another_time_is_the_first_difference(at: int, later_ns: int) -> None:
    moved = replace(run()[at], said_ns=run()[at].said_ns + later_ns)
    found, mirrored = compared(run(), in_order([*run()[:at], moved, *run()[at + 1 :]]))
    first, other = found.first, mirrored.first
    assert first is not None and other is not None
    assert (first.at_ns, first.source) == (run()[at].said_ns, process_of(moved))
    assert (other.at_ns, other.source, other.topic, other.sequence) == (
        first.at_ns,
        first.source,
        first.topic,
        first.sequence,
    )
    assert other.kind == MIRRORED.get(first.kind, first.kind)


@settings(max_examples=15)
@given(st.integers(0, 10**6), st.floats(allow_nan=True, allow_infinity=True))
def test_a_field_that_is_another_is_named_bit_for_bit(pick: int, value: float) -> None:
    places = [k for k, sent in enumerate(run()) if isinstance(sent.message, Odometry)]
    at = places[pick % len(places)]
    sent = run()[at]
    changed = replace(sent, message=msgspec.structs.replace(sent.message, distance_m=value))
    found, _ = compared(run(), [*run()[:at], changed, *run()[at + 1 :]])
    same = np.float64(value).tobytes() == np.float64(sent.message.distance_m).tobytes()  # type: ignore[attr-defined]
    assert (found.first is None) is same
    if found.first is not None:
        assert (found.first.kind, found.first.source) == ("content", "world")
        assert [field.field for field in found.first.fields] == ["distance_m"]


def test_numbers_of_the_clock_alone_are_told_last() -> None:
    def renumbered(sent: Sent) -> Sent:
        return replace(sent, sequence=sent.sequence + 1) if sent.source == CLOCK else sent

    new = [*run()[:100], *map(renumbered, run()[100:])]
    found, _ = compared(run(), new)
    assert found.first is not None and found.first.kind == "order"
    assert "another number of the clock" in found.first.what
    dearer = next(k for k, s in enumerate(run()) if k > 300 and isinstance(s.message, Span))
    span = new[dearer]
    new[dearer] = replace(span, message=msgspec.structs.replace(span.message, cells=10**6))
    found, _ = compared(run(), new)
    assert found.first is not None and found.first.kind == "cost"
    assert found.first.at_ns == span.said_ns


def test_elements_of_arrays_are_compared_bit_for_bit() -> None:
    sent = next(s for s in run() if isinstance(s.message, Ranges))
    assert isinstance(sent.message, Ranges)
    means = sent.message.mean_m.copy()
    means[2], means[5] = -0.0, np.nan
    one = replace(sent, message=msgspec.structs.replace(sent.message, mean_m=means))
    assert field_differences(one, one) == ()
    zero = means.copy()
    zero[2] = 0.0
    other = replace(sent, message=msgspec.structs.replace(sent.message, mean_m=zero))
    (found,) = field_differences(one, other)
    assert (found.field, found.base, found.new, found.others) == ("mean_m[2]", "-0.0", "0.0", 0)
    short = replace(sent, message=msgspec.structs.replace(sent.message, mean_m=means[:3]))
    (found,) = field_differences(one, short)
    assert found.field == "mean_m: shape"


@pytest.mark.parametrize("module", MODULES)
def test_the_run_has_something_of_every_module(module: str) -> None:
    assert any(sent.source == module for sent in run())
