"""Who may run, and when: the coordinator alone, on tables small enough to do by hand."""

from __future__ import annotations

from bus.coordinator import Done, Grant, Handled, Said
from tests.bus.timetable import Stage, actors, lines, scripted


def test_order_is_time_then_priority_then_source_then_sequence() -> None:
    cast = actors("""
        a  1  x  0  -
        b  2  -  0  -
        c  2  -  0  -
        d  0  -  0  -
    """)
    said = [
        Said("x", "c", 7, 5),
        Said("x", "b", 9, 5),
        Said("x", "c", 2, 5),
        Said("x", "d", 1, 5),
        Said("x", "b", 3, 4),
    ]
    coordinator = Stage(cast, []).coordinator
    for one in said:
        coordinator.said(one)
    assert coordinator.next_ns() == 14
    assert coordinator.grants(20) == [
        Grant("a", 20, (("b", 3), ("d", 1), ("b", 9), ("c", 2), ("c", 7)))
    ]


def test_who_is_busy_waits_and_then_gets_all_that_came_meanwhile() -> None:
    cast = actors("""
        a  1  x  100  -
    """)
    script = scripted("""
        0    w  x
        5    w  x
        95   w  x
        106  w  x
    """)
    # Busy 10 to 110; what is heard at 15 and 105 waits; what is heard at 116 waits till 310.
    assert Stage(cast, script).play().table == lines("""
        10   a  w0
        110  a  w1 w2
        310  a  w3
    """)


def test_nothing_is_heard_before_its_handlers_end_and_the_hop() -> None:
    cast = actors("""
        a  1  x  7,40  y
        b  2  y  0     -
    """)
    script = scripted("""
        0  w  x
        0  w  x
    """)
    # a's handlers end at 17 and 57: b hears at 27 and 67, not both at the end of the turn.
    assert Stage(cast, script).play().table == lines("""
        10  a  w0 w1
        27  b  a0
        67  b  a1
    """)


def test_several_processes_are_granted_the_same_time_the_first_in_priority_first() -> None:
    cast = actors("""
        late   3  x  5  y
        early  1  x  5  y
        other  2  y  5  -
    """)
    assert Stage(cast, scripted("0 w x")).play().table == lines("""
        10  early  w0
        10  late   w0
        25  other  early0 late0
    """)


def test_one_processor_the_reactor_first() -> None:
    cast = actors("""
        decider  6  x  50  -
        reactor  1  x  5   -
        sensor   2  x  20  -
    """)
    assert Stage(cast, scripted("0 w x"), processors=1).play().table == lines("""
        10  reactor  w0
        15  sensor   w0
        35  decider  w0
    """)


def test_the_reactor_takes_the_next_free_processor_but_interrupts_nobody() -> None:
    cast = actors("""
        decider  6  p  50  -
        reactor  1  r  5   -
        sensor   2  s  20  -
    """)
    script = scripted("""
        0   w  p
        5   w  s
        45  w  r
    """)
    # The decider runs 10 to 60; the sensor has waited since 15, the reactor since 55.
    assert Stage(cast, script, processors=1).play().table == lines("""
        10  decider  w0
        60  reactor  w2
        65  sensor   w1
    """)


def test_two_processors_run_two_at_once() -> None:
    cast = actors("""
        a  1  x  30  -
        b  2  x  10  -
        c  3  x  10  -
        d  4  x  10  -
    """)
    assert Stage(cast, scripted("0 w x"), processors=2).play().table == lines("""
        10  a  w0
        10  b  w0
        20  c  w0
        30  d  w0
    """)


def test_who_computes_nothing_gives_its_processor_back_within_the_instant() -> None:
    cast = actors("""
        a  1  x  0  -
        b  2  x  9  -
        c  3  x  9  -
    """)
    assert Stage(cast, scripted("0 w x"), processors=1).play().table == lines("""
        10  a  w0
        10  b  w0
        19  c  w0
    """)


def test_the_world_hears_a_decision_though_every_processor_is_busy() -> None:
    table = """
        world    0  d  0   -
        decider  2  p  20  d
        sensor   3  p  90  -
    """
    played = Stage(actors(table), scripted("0 w p"), processors=1, apart=("world",)).play()
    assert played.table == lines("""
        10  decider  w0
        30  sensor   w0
        40  world    decider0
    """)


def test_processors_granted_and_not_yet_given_back_are_not_granted_again() -> None:
    cast = actors("""
        a  1  x  5  -
        b  2  x  5  -
    """)
    coordinator = Stage(cast, [], processors=1).coordinator
    coordinator.said(Said("x", "w", 0, 0))
    assert [g.process for g in coordinator.grants(10)] == ["a"]
    assert coordinator.grants(10) == []


def test_who_waits_for_a_processor_counts_as_computing() -> None:
    cast = actors("""
        a  1  x  50  -
        b  2  x  5   -
        c  3  y  5   -
    """)
    stage = Stage(cast, [], processors=1)
    coordinator = stage.coordinator
    coordinator.said(Said("x", "w", 0, 0))
    for grant in coordinator.grants(10):
        handled = Handled("x", "w", 0, 10, 60, 1)
        coordinator.done(Done(grant.process, 10, (handled,), ()))
    assert coordinator.computing("a", 59)
    assert not coordinator.computing("a", 60)
    assert coordinator.computing("b", 11), "it has had its message since 10 ns"
    assert not coordinator.computing("b", 10), "what comes at this very moment is late input"
    assert not coordinator.computing("c", 11)


def test_a_process_that_dies_is_forgotten_and_the_others_go_on() -> None:
    cast = actors("""
        a  1  x  5  -
        b  2  x  5  -
    """)
    coordinator = Stage(cast, []).coordinator
    coordinator.said(Said("x", "w", 0, 0))
    coordinator.died("a")
    coordinator.said(Said("x", "w", 1, 0))
    assert not coordinator.alive("a")
    assert coordinator.grants(10) == [Grant("b", 10, (("w", 0), ("w", 1)))]
    assert coordinator.waiting_for() == ["b"]


def test_what_would_have_been_said_after_a_death_is_never_heard() -> None:
    cast = actors("""
        a  1  x  100  y
        b  2  y  5    -
    """)
    coordinator = Stage(cast, []).coordinator
    coordinator.said(Said("x", "w", 0, 0))
    coordinator.grants(10)
    late = (Said("y", "a", 0, 110),)
    coordinator.done(Done("a", 10, (Handled("x", "w", 0, 10, 110, 1, 1),), late))
    assert coordinator.next_ns() == 120
    coordinator.died("a", 109)
    assert coordinator.next_ns() is None


def test_who_dies_with_a_grant_open_is_waited_for_no_more() -> None:
    cast = actors("""
        a  1  x  5  -
        b  2  x  5  -
    """)
    coordinator = Stage(cast, [], processors=1).coordinator
    coordinator.said(Said("x", "w", 0, 0))
    coordinator.grants(10)
    coordinator.died("a")
    assert coordinator.waiting_for() == []
    assert coordinator.grants(10) == [Grant("b", 10, (("w", 0),))]


def test_nothing_waits_when_nothing_was_said() -> None:
    coordinator = Stage(actors("a 1 x 0 -"), []).coordinator
    assert coordinator.next_ns() is None
    assert coordinator.grants(5) == []
