"""The order in which a run is written down."""

from __future__ import annotations

import random

from hypothesis import given
from hypothesis import strategies as st

from bus.coordinator import Said
from bus.journal import Journal
from bus.topics import PRIORITY

sources = st.sampled_from([*PRIORITY, "clock", "bus", "nobody"])
everything_said = st.lists(
    st.tuples(st.integers(0, 50), sources, st.integers(0, 99)),
    unique_by=lambda said: said[1:],
    max_size=30,
)


def key(said: Said) -> tuple[int, int, str, int]:
    return said.said_ns, PRIORITY.get(said.source, len(PRIORITY)), said.source, said.sequence


@given(everything_said, st.integers(0, 60), st.randoms(use_true_random=False))
def test_order_depends_on_what_was_said_alone(
    rows: list[tuple[int, str, int]], now_ns: int, rng: random.Random
) -> None:
    said = [Said("t", source, sequence, at_ns) for at_ns, source, sequence in rows]
    journal: Journal[Said] = Journal()
    for one in rng.sample(said, len(said)):
        journal.note(one, one)
    early, late = journal.before(now_ns), journal.before(None)
    assert early + late == sorted(said, key=key)
    assert all(one.said_ns < now_ns for one in early)
    assert all(one.said_ns >= now_ns for one in late)


@given(everything_said)
def test_taken_out_as_time_goes_on_the_order_is_the_same(
    rows: list[tuple[int, str, int]],
) -> None:
    """A handler announces at its beginning what it will have said at its end."""
    said = [Said("t", source, sequence, at_ns) for at_ns, source, sequence in rows]
    journal: Journal[Said] = Journal()
    written: list[Said] = []
    for now_ns in range(60):
        written += journal.before(now_ns)
        for one in said:
            if max(0, one.said_ns - 7) == now_ns:
                journal.note(one, one)
    assert written + journal.before(None) == sorted(said, key=key)


def test_what_is_dropped_is_what_one_source_says_after_a_time() -> None:
    journal: Journal[tuple[str, int]] = Journal()
    for source in ("sensor", "decider"):
        for at_ns in (4, 5, 6):
            journal.note(Said("t", source, at_ns, at_ns), (source, at_ns))
    journal.drop("decider", 5)
    assert journal.before(None) == [
        ("sensor", 4),
        ("decider", 4),
        ("sensor", 5),
        ("decider", 5),
        ("sensor", 6),
    ]


def test_of_one_moment_the_world_is_first_the_clock_and_the_bus_last() -> None:
    journal: Journal[str] = Journal()
    for source in ("clock", "decider", "bus", "reactor", "world"):
        journal.note(Said("t", source, 0, 5), source)
    assert journal.before(None) == ["world", "reactor", "decider", "bus", "clock"]
