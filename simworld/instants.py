"""The order within one instant of simulated time.

SimPy has two priorities, for its own urgent events (0) and for all others (1). Two more follow
them: first the world's own events, then whoever may run, last the deadlines, so that a decision
heard at its very deadline is in time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import simpy

GRANTS = simpy.events.EventPriority(2)
DEADLINES = simpy.events.EventPriority(3)


def call_at(
    env: simpy.Environment,
    at_ns: int,
    priority: simpy.events.EventPriority,
    call: Callable[[simpy.Event], None],
    value: Any,
) -> None:
    """Have ``call`` called at a time, at once if it has passed, with an event of this value."""
    event = simpy.Event(env)
    event._ok, event._value = True, value  # succeeded, as simpy.Timeout does it
    event.callbacks.append(call)
    env.schedule(event, priority=priority, delay=max(0, at_ns - int(env.now)))
