"""The world's process: SimPy, the coordinator and the hub of the star.

``python -m scenarios.world_process ORDER``. Writes its progress to standard output as JSON
lines: ``{"state": ...}``, one every fifth of a second while it runs, and the last one with how
it ended.
"""

from __future__ import annotations

import signal
import sys
import time
from pathlib import Path
from typing import Any

import msgspec
import simpy

from bus import link
from bus.coordinator import Done, Grant
from bus.hub import Hub
from bus.protocol import CommitEntry
from bus.topics import MODULES
from bus.wire import RefusedError
from scenarios.draw import draw
from scenarios.faults import schedule_faults
from scenarios.in_process import coordinator_of
from scenarios.order import Order, read_order
from scenarios.parent import end_with_parent
from scenarios.wall_record import WallRecord
from simworld.clock import VirtualClock
from simworld.voice import Outlet
from simworld.world import World

PROGRESS_EVERY_S = 0.2
COMMIT_BATCH = 500


def report(**facts: Any) -> None:
    """One line for the supervisor."""
    sys.stdout.buffer.write(msgspec.json.encode(facts) + b"\n")
    sys.stdout.buffer.flush()


class Run:
    """One run over the bus."""

    def __init__(self, order: Order, hub_session: Any, wall: WallRecord) -> None:
        scenario = order.script.scenario
        self._env = simpy.Environment(initial_time=0)
        self._hub = Hub(
            hub_session,
            link.Keys(order.run),
            MODULES,
            self._lost,
            self._refused,
            scenario.bus.patience_s,
        )
        coordinator = coordinator_of(scenario)
        self._clock = VirtualClock(
            self._env, coordinator, self._carry_out, self._commit, wall.measured
        )
        drawn = draw(scenario, order.script.name)
        self._world = World(
            self._env,
            drawn.plan,
            scenario.seed,
            Outlet(self._hub.put, self._clock.said),
            self._clock.decided_by,
            self._clock.why_late,
        )
        schedule_faults(self._env, scenario.fault, self._kill)
        self._killed: list[str] = []
        self._entries: list[CommitEntry] = []
        self._reported_s = 0.0
        self._stop = False

    def stop(self, *_: Any) -> None:
        """End the run at the next instant: SIGTERM."""
        self._stop = True

    def _kill(self, process: str) -> None:
        self._killed.append(process)
        report(state="kill", process=process)
        self._clock.died(process)

    def _lost(self, process: str, how: str) -> None:
        if process in self._killed:
            return
        if process in MODULES:
            self._clock.died(process)
        self._world.lost(process, how)

    def _refused(self, refusal: RefusedError) -> None:
        self._clock.refused(refusal)

    def _carry_out(self, grants: list[Grant]) -> list[Done]:
        if self._stop:
            self._world.end("stopped")
        return self._hub.carry_out(grants, self._world.take_turn)

    def _commit(self, entries: list[CommitEntry]) -> None:
        self._entries += entries
        if len(self._entries) >= COMMIT_BATCH:
            self._send_commits(last=False)
        if time.monotonic() - self._reported_s > PROGRESS_EVERY_S:
            self._send_commits(last=False)
            self._reported_s = time.monotonic()
            report(state="running", **self._facts())

    def _send_commits(self, *, last: bool) -> None:
        self._hub.commit(self._entries, last=last)
        self._entries = []

    def _facts(self) -> dict[str, Any]:
        deadlines, errands = self._world.deadlines, self._world.errands
        return {
            "simulated_s": self._env.now / 1e9,
            "errands_done": errands.done,
            "errands": errands.done + errands.left,
            "on_time": sum(deadlines.on_time.values()),
            "late": sum(deadlines.late.values()),
            "handlers": self._clock.handlers_run,
        }

    def go(self) -> None:
        """From the first token to the last farewell."""
        self._hub.wait_until_ready(lambda process: report(state="ready", process=process))
        report(state="started")
        self._clock.started()
        self._world.start()
        reason = self._env.run(until=self._world.ended)
        self._clock.ended()
        self._clock.finish()
        self._send_commits(last=True)
        self._hub.farewell()
        report(state="ended", reason=str(reason), **self._facts())


def main(order_path: str) -> None:
    """Open the hub and run the world."""
    end_with_parent()
    order = read_order(order_path)
    with (
        WallRecord(Path(order.log), order.script) as wall,
        link.open_hub(order.endpoint) as session,
    ):
        run = Run(order, session, wall)
        signal.signal(signal.SIGTERM, run.stop)
        run.go()


if __name__ == "__main__":
    main(*sys.argv[1:])
