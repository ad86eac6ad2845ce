"""The virtual clock: one event queue, grants after the world's own events, the log in order."""

from __future__ import annotations

from typing import Any

import simpy

from bus.coordinator import Coordinator, Done, Grant, Handled, Said
from bus.messages import ProcessState, Refused, Span
from bus.protocol import CommitEntry
from bus.wire import RefusedError, Sent
from simworld.clock import VirtualClock
from simworld.instants import DEADLINES, GRANTS, call_at

HOP_NS = 10
COST_NS = {"sensor": 100, "decider": 7}


class Rig:
    """A clock whose processes say one message, of topic ``NAME``, for each that they handle."""

    def __init__(
        self, hearers: dict[str, tuple[str, ...]], costs: dict[str, Any] | None = None
    ) -> None:
        self.env = simpy.Environment(initial_time=0)
        self.costs = COST_NS | (costs or {})
        priority = {"world": 0, "sensor": 1, "decider": 2}
        self.coordinator = Coordinator(priority, hearers, HOP_NS)
        self.log: list[CommitEntry] = []
        self.granted: list[tuple[int, Grant]] = []
        self.clock = VirtualClock(self.env, self.coordinator, self._carry_out, self.log.extend)
        self._sequence = dict.fromkeys(priority, 0)

    def say(self, topic: str, at_ns: int) -> None:
        """The world says something at a time."""

        def go(_: simpy.Event) -> None:
            self.clock.said(Said(topic, "world", self._next("world"), at_ns))

        self.env.timeout(at_ns).callbacks.append(go)

    def _next(self, name: str) -> int:
        self._sequence[name] += 1
        return self._sequence[name] - 1

    def _carry_out(self, grants: list[Grant]) -> list[Done]:
        self.granted += [(int(self.env.now), grant) for grant in grants]
        return [self._run(grant) for grant in grants]

    def _run(self, grant: Grant) -> Done:
        at_ns = grant.time_ns
        handled: list[Handled] = []
        said: list[Said] = []
        for source, sequence in grant.messages:
            end_ns = at_ns + self.costs[grant.process]
            handled.append(Handled("t", source, sequence, at_ns, end_ns, sequence, 1))
            topic = f"decision/{grant.process}"
            said.append(Said(topic, grant.process, self._next(grant.process), end_ns))
            at_ns = end_ns
        return Done(grant.process, grant.time_ns, tuple(handled), tuple(said))


def test_grants_come_at_the_nanosecond() -> None:
    rig = Rig({"x": ("sensor",), "decision/sensor": ("decider",)})
    rig.say("x", 1_000_000_007)
    rig.env.run()
    assert [(at, g.process, g.messages) for at, g in rig.granted] == [
        (1_000_000_017, "sensor", (("world", 0),)),
        (1_000_000_127, "decider", (("sensor", 0),)),
    ]
    assert rig.clock.handlers_run == 2


def test_within_an_instant_the_world_then_grants_then_deadlines() -> None:
    rig = Rig({"x": ("sensor",)})
    order: list[str] = []
    call_at(rig.env, 20, DEADLINES, lambda _: order.append("deadline"), None)
    call_at(rig.env, 20, GRANTS, lambda _: order.append("grants"), None)
    rig.env.timeout(20).callbacks.append(lambda _: order.append("world"))

    def twice() -> simpy.events.ProcessGenerator:
        yield rig.env.timeout(20)
        yield rig.env.timeout(0)
        order.append("world again")

    rig.env.process(twice())
    rig.env.run()
    assert order == ["world", "world again", "grants", "deadline"]


def test_a_time_that_has_passed_is_now() -> None:
    rig = Rig({})
    seen: list[Any] = []
    rig.env.run(until=50)
    call_at(rig.env, 20, GRANTS, lambda event: seen.append(event.value), 7)
    rig.env.run()
    assert (rig.env.now, seen) == (50, [7])


def test_an_earlier_grant_does_not_lose_the_later_one() -> None:
    """A time is armed for 310; one at 210 comes first, and is followed by it."""
    rig = Rig({"x": ("sensor",), "y": ("decider",)})
    rig.say("x", 190)
    rig.say("x", 195)  # heard at 205, waits until 300
    rig.say("y", 210)
    rig.env.run()
    assert [(at, g.process) for at, g in rig.granted] == [
        (200, "sensor"),
        (220, "decider"),
        (300, "sensor"),
    ]


def test_the_log_is_in_the_order_of_what_was_said_when() -> None:
    rig = Rig({"x": ("sensor", "decider")})
    rig.say("x", 0)
    rig.say("x", 50)
    rig.env.run()
    rig.clock.finish()
    names = [(e.source, e.sequence) if isinstance(e, Sent) else e for e in rig.log]
    assert names == [
        ("world", 0),
        ("decider", 0),  # 17
        ("clock", 1),
        ("world", 1),  # 50
        ("decider", 1),  # 67
        ("clock", 2),
        ("sensor", 0),  # 110
        ("clock", 0),
        ("sensor", 1),  # 210
        ("clock", 3),
    ]
    span = rig.log[2]
    assert isinstance(span, Sent)
    assert span.message == Span("decider", "t", "world", 0, 10, 17, 0)
    assert span.parents == (("world", 0),)


def test_nothing_is_written_before_its_time_has_passed() -> None:
    rig = Rig({"x": ("sensor",)})
    rig.say("x", 0)
    rig.say("x", 500)
    rig.env.run(until=400)
    assert rig.log == [("world", 0)]


def test_a_decision_is_of_the_handler_that_said_it() -> None:
    """Two handlers of one turn that end at the same time: each keeps its own decision."""
    rig = Rig({"x": ("decider",)}, {"decider": 0})
    rig.say("x", 0)
    rig.say("x", 0)
    rig.env.run()
    handlers = [rig.clock.decided_by(("decider", k)) for k in range(2)]
    assert [h.sequence if h else None for h in handlers] == [0, 1]
    assert rig.clock.decided_by(("decider", 0)) is None, "asking forgets it"


def test_why_late() -> None:
    rig = Rig({"x": ("sensor",)})
    rig.say("x", 0)
    rig.env.run(until=60)
    assert rig.clock.why_late("sensor") == "overrun"
    assert rig.clock.why_late("decider") == "late input"
    rig.clock.died("decider")
    assert rig.clock.why_late("decider") == "process down"


def test_what_a_process_would_have_said_after_its_death_is_not() -> None:
    rig = Rig({"x": ("sensor", "decider"), "decision/sensor": ("decider",)})
    rig.say("x", 0)
    rig.env.timeout(60).callbacks.append(lambda _: rig.clock.died("sensor"))
    rig.say("x", 70)
    rig.env.run()
    rig.clock.finish()
    assert [(at, g.process, g.messages) for at, g in rig.granted] == [
        (10, "sensor", (("world", 0),)),
        (10, "decider", (("world", 0),)),
        (80, "decider", (("world", 1),)),
    ]
    assert ("sensor", 0) not in rig.log


def refuse(event: simpy.Event) -> None:
    found: Any = event.value
    clock, error = found
    clock.refused(error)


def test_a_refusal_is_written_at_its_time_and_changes_no_other_number() -> None:
    def play(*, hostile: bool) -> list[CommitEntry]:
        rig = Rig({"x": ("sensor",)})
        rig.say("x", 0)
        if hostile:
            for at_ns in (40, 60):
                error = RefusedError("belief/map", "intruder", 9, "FieldError: no")
                call_at(rig.env, at_ns, GRANTS, refuse, (rig.clock, error))
        rig.env.run()
        rig.clock.finish()
        return rig.log

    with_it, without = play(hostile=True), play(hostile=False)
    refusals = [e for e in with_it if isinstance(e, Sent) and e.topic == "health/refused"]
    assert [(s.said_ns, s.source, s.sequence, s.previous, s.message) for s in refusals] == [
        (40, "bus", 0, -1, Refused("belief/map", "intruder", 9, "FieldError: no", 1)),
        (60, "bus", 1, 0, Refused("belief/map", "intruder", 9, "FieldError: no", 2)),
    ]
    assert [e for e in with_it if e not in refusals] == without


def test_processes_say_what_they_do_in_simulated_time() -> None:
    rig = Rig({"x": ("sensor", "decider")})
    rig.clock.started()
    rig.env.run(until=40)
    rig.clock.died("sensor")
    rig.env.run(until=90)
    rig.clock.ended()
    rig.clock.finish()
    states = [
        (e.said_ns, e.message.process, e.message.state)
        for e in rig.log
        if isinstance(e, Sent) and isinstance(e.message, ProcessState)
    ]
    assert ("sensor" in {p for _, p, _ in states}) and ("decider" in {p for _, p, _ in states})
    assert {(t, s) for t, p, s in states if p == "sensor"} == {(0, "running"), (40, "down")}
    assert {(t, s) for t, p, s in states if p == "decider"} == {(0, "running"), (90, "ended")}
