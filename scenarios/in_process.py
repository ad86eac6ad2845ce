"""A whole run in one process: the same coordinator, the same modules, no bus in between."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import simpy

from bus.coordinator import Coordinator, Done, Grant
from bus.inbox import Inbox
from bus.protocol import CommitEntry
from bus.topics import MODULES, PRIORITY, TOPICS, WORLD
from bus.turns import Module, Worker
from bus.wire import MessageId, Sent
from scenarios.costs import cost_model
from scenarios.draw import Drawn
from scenarios.faults import schedule_faults
from scenarios.modules import build_module
from scenarios.scenario import Scenario
from simworld.clock import Measured, VirtualClock
from simworld.voice import Outlet
from simworld.world import World

HEARERS = {topic.name: topic.subscribers for topic in TOPICS.values()}


def coordinator_of(scenario: Scenario) -> Coordinator:
    """The coordinator that a scenario asks for."""
    processors = scenario.compute.processors
    return Coordinator(
        PRIORITY,
        HEARERS,
        round(scenario.bus.hop_s * 1e9),
        None if processors == "one each" else processors,
        apart=(WORLD,),
    )


class _Carrier:
    """Delivers messages and carries out grants, all within this process."""

    def __init__(
        self,
        workers: dict[str, Worker],
        write: Callable[[Sent], None],
        stop: Callable[[], bool],
    ) -> None:
        self._workers = workers
        self._inboxes = {name: Inbox() for name in (WORLD, *workers)}
        self._unwritten: dict[MessageId, Sent] = {}
        self._write = write
        self._stop = stop
        self.world: World | None = None

    def put(self, sent: Sent) -> None:
        self._unwritten[sent.id] = sent
        for name in HEARERS[sent.topic]:
            inbox = self._inboxes.get(name)
            if inbox is not None:
                inbox.put(sent)

    def carry_out(self, grants: list[Grant]) -> list[Done]:
        if self._stop():
            assert self.world is not None
            self.world.end("stopped")
        return [self._run(grant) for grant in grants]

    def _run(self, grant: Grant) -> Done:
        heard = self._inboxes[grant.process].take(grant.messages)
        if grant.process == WORLD:
            assert self.world is not None
            return self.world.take_turn(grant, heard)
        done, said = self._workers[grant.process].run(grant, heard)
        for sent in said:
            self.put(sent)
        return done

    def commit(self, entries: list[CommitEntry]) -> None:
        for entry in entries:
            self._write(entry if isinstance(entry, Sent) else self._unwritten.pop(entry))


@dataclass(frozen=True)
class Ended:
    """How a run ended, and how much was done in it."""

    reason: str
    simulated_s: float
    handlers_run: int
    world: World


def run_in_process(
    scenario: Scenario,
    drawn: Drawn,
    write: Callable[[Sent], None],
    build: Callable[..., Module] = build_module,
    stop: Callable[[], bool] = lambda: False,
    measured: Measured = lambda _process, _handled: None,
) -> Ended:
    """Run a scenario from beginning to end; ``write`` gets the log, message by message.

    ``build`` makes the modules; a test or a tool may put its own in their place. ``stop`` is
    asked before every round of grants whether the run shall end now; ``measured`` gets what
    every handler took by the wall clock.
    """
    costs = cost_model(scenario.compute)
    workers = {
        name: Worker(
            name,
            build(name, drawn.facts, scenario.modules.get(name, {}), scenario.seed),
            costs,
        )
        for name in MODULES
    }
    env = simpy.Environment(initial_time=0)
    carrier = _Carrier(workers, write, stop)
    clock = VirtualClock(env, coordinator_of(scenario), carrier.carry_out, carrier.commit, measured)
    world = World(
        env,
        drawn.plan,
        scenario.seed,
        Outlet(carrier.put, clock.said),
        clock.decided_by,
        clock.why_late,
    )
    carrier.world = world
    schedule_faults(env, scenario.fault, clock.died)
    clock.started()
    world.start()
    reason = env.run(until=world.ended)
    clock.ended()
    clock.finish()
    return Ended(str(reason), env.now / 1e9, clock.handlers_run, world)
