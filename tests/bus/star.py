"""A real star in one process: the hub's session, a client for each toy module and the recorder.

The toy world fires the sonar every simulated second; a toy sensor turns echoes into ranges, a
toy reactor and toy detectors hear them and answer the world.
"""

from __future__ import annotations

import threading
import uuid
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
import simpy
import zenoh

from bus import link
from bus.coordinator import Coordinator, Done, Grant, Handled
from bus.costs import CostModel, Rate
from bus.hub import Hub
from bus.messages import Attention, Motion, Ranges, Scan, Sonar
from bus.process import PAYLOAD_PATIENCE_S, ModuleProcess
from bus.recording import Recording
from bus.topics import DETECTORS, PRIORITY, REACTOR, RECORDER, SENSOR, TOPICS, WORLD
from bus.turns import Handler, Turn, Worker
from bus.wire import MessageId, Sent, unpack
from simworld.clock import VirtualClock
from simworld.voice import Outlet, Speaker

SECOND_NS = 10**9
COSTS = CostModel("toy", {"echo": Rate(1e6, 1e3), "track": Rate(2e6)})
HEARERS = {topic.name: topic.subscribers for topic in TOPICS.values()}


@dataclass
class Toy:
    """A module that is a table."""

    handlers: Mapping[str, Handler]


def _ranges(sonar: Sonar, turn: Turn) -> None:
    turn.work("echo", len(sonar.ranges_m))
    sigma_m, echo = np.full(24, 0.1), np.ones(24)
    mean_m = sonar.ranges_m * 1.01
    turn.say(Ranges(sonar.ping, sonar.fired_ns, mean_m, sigma_m, echo, 0.1))
    turn.say(Scan(sonar.ping, 1, mean_m, sigma_m, echo))


def _attention(ranges: Ranges, turn: Turn) -> None:
    turn.work("track", 1)
    turn.say(Attention(float(ranges.mean_m.sum())))


def _motion(scan: Scan, turn: Turn) -> None:
    turn.say(Motion(scan.ping, 0, 1, 0, np.array([[0.0, scan.mean_m[0]]])))


def toys() -> dict[str, Toy]:
    """The three modules."""
    return {
        SENSOR: Toy({"percept/sonar": _ranges}),
        REACTOR: Toy({"belief/ranges": _attention}),
        DETECTORS: Toy({"belief/scan": _motion}),
    }


@dataclass
class Ran:
    """What came of a run."""

    dones: list[Done] = field(default_factory=list)
    heard: list[Sent] = field(default_factory=list)
    """By the world."""
    written: list[Sent] = field(default_factory=list)
    unwritten: list[MessageId] = field(default_factory=list)
    lost: list[tuple[str, str]] = field(default_factory=list)
    errors: dict[str, Exception] = field(default_factory=dict)
    refusals: int = 0


class Star:
    """One run: ``rounds`` pings, each followed by what it makes the modules say.

    ``disturb(star, round)`` is called before each ping; ``put(star, sent)`` stands in for the
    world's own publishing.
    """

    def __init__(
        self,
        modules: dict[str, Toy] | None = None,
        disturb: Callable[[Star, int], None] = lambda _star, _round: None,
        put: Callable[[Star, Sent], None] = lambda star, sent: star.hub.put(sent),
        hub_patience_s: float = 20.0,
        payload_patience_s: float = PAYLOAD_PATIENCE_S,
    ) -> None:
        self._modules = modules or toys()
        self._disturb = disturb
        self._payload_patience_s = payload_patience_s
        self._hub_patience_s = hub_patience_s
        self._put = put
        self.keys = link.Keys(f"test-{uuid.uuid4().hex}")
        self.at = link.endpoint(0)
        self.ran = Ran()
        self.hub: Hub
        self.session: zenoh.Session
        self._threads: list[threading.Thread] = []

    def play(self, rounds: int = 12) -> Ran:
        """From the first token to the last."""
        with link.open_hub(self.at) as self.session:
            env = simpy.Environment(initial_time=0)
            self.hub = Hub(
                self.session,
                self.keys,
                list(self._modules),
                self._lost,
                lambda refusal: self.clock.refused(refusal),
                self._hub_patience_s,
            )
            coordinator = Coordinator(PRIORITY, HEARERS, 1_000_000)
            for name in PRIORITY:
                if name not in (WORLD, *self._modules):
                    coordinator.died(name)
            self.clock = VirtualClock(env, coordinator, self._carry_out, self.hub.commit)
            self._start_processes()
            self.hub.wait_until_ready(lambda _: None)
            speaker = Speaker(env, Outlet(lambda s: self._put(self, s), self.clock.said), WORLD)
            env.run(until=env.process(self._world(env, speaker, rounds)))
            self.clock.finish()
            self.hub.commit([], last=True)
            self.hub.farewell()
            for thread in self._threads:
                thread.join(20.0)
                assert not thread.is_alive(), f"{thread.name} does not end"
        self.ran.refusals = self.clock.refusals
        return self.ran

    def _world(
        self, env: simpy.Environment, speaker: Speaker, rounds: int
    ) -> simpy.events.ProcessGenerator:
        for ping in range(rounds):
            self._disturb(self, ping)
            ranges_m = np.linspace(0.5, 9.5, 24) + ping
            speaker.say(Sonar(ping, 0, int(env.now), ranges_m))
            yield env.timeout(SECOND_NS)

    def _carry_out(self, grants: list[Grant]) -> list[Done]:
        dones = self.hub.carry_out(grants, self._world_turn)
        self.ran.dones += dones
        return dones

    def _world_turn(self, grant: Grant, heard: tuple[Sent, ...]) -> Done:
        self.ran.heard += heard
        at_ns = grant.time_ns
        handled = tuple(Handled(s.topic, s.source, s.sequence, at_ns, at_ns, 0) for s in heard)
        return Done(WORLD, at_ns, handled, ())

    def _lost(self, process: str, how: str) -> None:
        self.ran.lost.append((process, how))
        if process in self._modules:
            self.clock.died(process)

    def _start_processes(self) -> None:
        for name, toy in self._modules.items():
            self._start(name, partial(self._run_module, Worker(name, toy, COSTS)))
        self._start(RECORDER, self._run_recorder)

    def _run_recorder(self, session: zenoh.Session) -> None:
        written = self.ran.written.extend
        recording = Recording(session, self.keys, unpack, written, self._payload_patience_s)
        recording.run()
        self.ran.unwritten += recording.lost

    def _run_module(self, worker: Worker, session: zenoh.Session) -> None:
        ModuleProcess(session, self.keys, worker, self._payload_patience_s).run()

    def _start(self, name: str, run: Callable[[Any], None]) -> None:
        def go() -> None:
            try:
                with link.open_client(self.at) as session:
                    run(session)
            except Exception as error:
                self.ran.errors[name] = error

        thread = threading.Thread(target=go, name=name, daemon=True)
        self._threads.append(thread)
        thread.start()
