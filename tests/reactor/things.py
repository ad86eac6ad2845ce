"""One thing at a time, for tests: the kernels of the reactor without their in-place ways."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from modules.reactor.cone import USUAL, Cones, heard_in_cone
from modules.reactor.thing import (
    LINES_M,
    SHAPE,
    SPEEDS_M_S,
    WEIGHT,
    EchoModel,
    Thing,
)
from modules.reactor.thing_kernels import bear, listen, move
from modules.reactor.track import Tracker
from modules.reactor.track_kernels import NOTES, PINGS

NAN = float("nan")


def born(
    cone: int, echo_m: float, sigma_m: float, lateral_m: float, time_s: float, model: EchoModel
) -> Thing:
    """A thing of which one cone heard one echo."""
    belief = np.empty(SHAPE)
    false = bear(belief, USUAL, cone, echo_m, sigma_m, lateral_m, model)
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
    false, share = listen(belief, thing.false, USUAL, cone, echo_m, sigma_m, lateral_m, model)
    return Thing(belief, false, thing.pings, thing.first_s), share


def reweighed(thing: Thing, weight: NDArray[np.float64], pings: int = 1) -> Thing:
    """A thing with other weights; what they lack to 1 is the probability of a false echo."""
    belief = thing.belief.copy()
    belief[WEIGHT] = weight
    return Thing(belief, 1.0 - float(weight.sum()), pings, thing.first_s)


def walker(ahead_m: float, speed_m_s: float, left_m: float, p: float, pings: int = 2) -> Thing:
    """A person of whom all is known, but for a probability of 1 - p that nobody is there."""
    thing = born(0, ahead_m, 0.04, 0.0, 1.0, EchoModel())
    weight = np.zeros_like(thing.weight)
    weight[int(np.abs(SPEEDS_M_S - speed_m_s).argmin()), line_at(left_m)] = p
    return reweighed(thing, weight, pings)


def line_at(left_m: float) -> int:
    """The line nearest to so far left of the centre line."""
    return int(np.abs(LINES_M - left_m).argmin())


def tracker_with(thing: Thing, time_s: float = 1.0, stands_at_m: float = np.inf) -> Tracker:
    """A tracker that knows of one thing."""
    note = np.zeros((1, NOTES))
    note[0] = thing.false, thing.pings, thing.first_s, thing.approaching, stands_at_m
    assert note[0, PINGS] == thing.pings
    return Tracker(
        time_s=time_s,
        beliefs=thing.belief[None],
        notes=note,
        last_alert_s=time_s,
        approaching=thing.approaching,
    )


def echoes_of_disc(ahead_m: float, left_m: float, cones: Cones = USUAL) -> list[float]:
    """What the forward cones hear of a disc of a person's size, NaN for nothing."""
    indices = range(len(cones.numbers))
    heard = [heard_in_cone(ahead_m, left_m, 0.25, cones.edges, cone) for cone in indices]
    return [range_m if h and range_m < cones.farthest_m else NAN for range_m, h in heard]


def echoes_of_discs(*discs: tuple[float, float], cones: Cones = USUAL) -> list[float]:
    """What they hear of several, so far ahead and left each."""
    each = np.array([echoes_of_disc(ahead_m, left_m, cones) for ahead_m, left_m in discs])
    nearest = np.where(np.isnan(each), np.inf, each).min(axis=0)
    return [range_m if np.isfinite(range_m) else NAN for range_m in nearest.tolist()]
