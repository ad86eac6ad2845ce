"""Whoever breaks the rules of virtual time is told how."""

from __future__ import annotations

import pytest

from bus.coordinator import CoordinationError, Coordinator, Done, Handled, Said
from tests.bus.timetable import Stage, actors


def granted() -> Coordinator:
    """A process with one grant open: message w0 at 10 ns."""
    coordinator = Stage(actors("a 1 x,y 0 y"), []).coordinator
    coordinator.said(Said("x", "w", 0, 0))
    coordinator.said(Said("x", "w", 1, 0))
    coordinator.grants(10)
    return coordinator


def handled(sequence: int, start_ns: int, end_ns: int, said: int = 0) -> Handled:
    return Handled("x", "w", sequence, start_ns, end_ns, 1, said)


GOOD = (handled(0, 10, 15), handled(1, 15, 15))


def said_at(*times_ns: int, source: str = "a") -> tuple[Said, ...]:
    return tuple(Said("y", source, k, at_ns) for k, at_ns in enumerate(times_ns))


@pytest.mark.parametrize(
    ("done", "text"),
    [
        (Done("b", 10, GOOD, ()), "b is done with something it was not granted"),
        (Done("a", 11, GOOD, ()), "a answers the grant of 11 ns, expected that of 10 ns"),
        (
            Done("a", 10, (handled(1, 10, 15), handled(0, 15, 15)), ()),
            "a at 10 ns was granted [('w', 0), ('w', 1)], handled [('w', 1), ('w', 0)]",
        ),
        (
            Done("a", 10, (handled(0, 10, 15),), ()),
            "a at 10 ns was granted [('w', 0), ('w', 1)], handled [('w', 0)]",
        ),
        (
            Done("a", 10, (handled(0, 10, 15), handled(1, 14, 20)), ()),
            "a: a handler from 14 to 20 ns, expected it to begin at 15 ns",
        ),
        (
            Done("a", 10, (handled(0, 10, 9), handled(1, 9, 20)), ()),
            "a: a handler from 10 to 9 ns, expected it to begin at 10 ns",
        ),
        (
            Done("a", 10, GOOD, said_at(15)),
            "a at 10 ns says 1 message(s), its handlers 0",
        ),
        (
            Done("a", 10, (handled(0, 10, 15), handled(1, 15, 20, 1)), said_at(15)),
            "a: message 0 of a said at 15 ns by a handler that ends at 20 ns, "
            "expected its own, said then",
        ),
        (
            Done("a", 10, (handled(0, 10, 15, 1), handled(1, 15, 20)), said_at(15, source="b")),
            "a: message 0 of b said at 15 ns by a handler that ends at 15 ns, "
            "expected its own, said then",
        ),
    ],
)
def test_a_done_that_breaks_the_rules(done: Done, text: str) -> None:
    with pytest.raises(CoordinationError) as error:
        granted().done(done)
    assert str(error.value) == text


def test_a_second_answer_to_a_grant() -> None:
    coordinator = granted()
    coordinator.done(Done("a", 10, GOOD, ()))
    with pytest.raises(CoordinationError, match=r"^a is done with something it was not granted$"):
        coordinator.done(Done("a", 10, GOOD, ()))


def test_time_does_not_go_back() -> None:
    with pytest.raises(CoordinationError, match=r"^time went back from 10 to 9 ns$"):
        granted().grants(9)


def test_nothing_is_said_in_the_past() -> None:
    with pytest.raises(CoordinationError) as error:
        granted().said(Said("x", "w", 2, 9))
    assert str(error.value) == "w said message 2 on x at 9 ns, before now (10 ns)"


def test_a_hop_takes_time() -> None:
    with pytest.raises(CoordinationError, match=r"^hop_ns is 0, expected at least 1$"):
        Coordinator({}, {}, 0)
