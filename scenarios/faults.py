"""Faults that a scenario plans: a process killed at a simulated time."""

from __future__ import annotations

from collections.abc import Callable

import simpy

from scenarios.scenario import Fault


def schedule_faults(
    env: simpy.Environment, faults: tuple[Fault, ...], kill: Callable[[str], None]
) -> None:
    """Have each process killed at its time."""
    for fault in faults:
        alarm = env.timeout(round(fault.at_s * 1e9), value=fault.kill)
        alarm.callbacks.append(lambda event: kill(event.value))
