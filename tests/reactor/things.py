"""One thing at a time, for tests: the kernels of the reactor without their in-place ways."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from modules.reactor.cone import heard_in_cone
from modules.reactor.thing import FARTHEST_M, SHAPE, WEIGHT, EchoModel, Thing
from modules.reactor.thing_kernels import bear, listen, move
from modules.reactor.track import Tracker
from modules.reactor.track_kernels import NOTES, PINGS

NAN = float("nan")


def born(
    cone: int, echo_m: float, sigma_m: float, lateral_m: float, time_s: float, model: EchoModel
) -> Thing:
    """A thing of which one cone heard one echo."""
    belief = np.empty(SHAPE)
    false = bear(belief, cone, echo_m, sigma_m, lateral_m, model)
    return Thing(belief, false, first_s=time_s)


def moved(thing: Thing, driven_m: float, elapsed_s: float, model: EchoModel) -> Thing:
    """A thing after a while."""
    belief = thing.belief.copy()
    return Thing(belief, move(belief, driven_m, elapsed_s, model), thing.pings, thing.first_s)


def listened(
    thing: Thing, cone: int, echo_m: float, sigma_m: float, lateral_m: float, model: EchoModel
) -> tuple[Thing, float]:
    """A thing after an echo, and how likely the echo was its own."""
    belief = thing.belief.copy()
    false, share = listen(belief, thing.false, cone, echo_m, sigma_m, lateral_m, model)
    return Thing(belief, false, thing.pings, thing.first_s), share


def reweighed(thing: Thing, weight: NDArray[np.float64], pings: int = 1) -> Thing:
    """A thing with other weights; what they lack to 1 is the probability of a false echo."""
    belief = thing.belief.copy()
    belief[WEIGHT] = weight
    return Thing(belief, 1.0 - float(weight.sum()), pings, thing.first_s)


def tracker_with(thing: Thing, time_s: float = 1.0) -> Tracker:
    """A tracker that knows of one thing."""
    note = np.zeros((1, NOTES))
    note[0] = thing.false, thing.pings, thing.first_s, thing.approaching, np.inf
    assert note[0, PINGS] == thing.pings
    return Tracker(
        time_s=time_s,
        beliefs=thing.belief[None],
        notes=note,
        last_alert_s=time_s,
        approaching=thing.approaching,
    )


def echoes_of_disc(ahead_m: float, left_m: float) -> list[float]:
    """What the three forward cones hear of a disc of a person's size, NaN for nothing."""
    heard = [heard_in_cone(ahead_m, left_m, 0.25, cone) for cone in range(3)]
    return [range_m if h and range_m < FARTHEST_M else NAN for range_m, h in heard]
