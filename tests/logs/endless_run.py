"""A run without end, made of small and large messages."""

from __future__ import annotations

import numpy as np

from bus import messages as m
from bus.wire import Sent

S = 10**9
EPOCH_NS = 1_767_225_600 * S


def message(sequence: int, every_ns: int = 7 * S) -> Sent:
    """The message of that number: the sonar's noise does not compress."""
    rng = np.random.default_rng(sequence)
    said_ns = sequence * every_ns
    if sequence % 3:
        x_m, y_m, heading_rad = rng.random(3).tolist()
        pose = m.TruePose(x_m, y_m, heading_rad, sequence)
        return Sent("truth/pose", "world", sequence, sequence - 1, said_ns, (), pose)
    sonar = m.Sonar(sequence, 0, said_ns, rng.random(24))
    parents = (("world", sequence - 1),) if sequence else ()
    return Sent("percept/sonar", "world", sequence, sequence - 3, said_ns, parents, sonar)
