"""One thing ahead of the robot: what it may be, where, and how fast it comes.

A thing is a false echo, or it stands (speed 0), or it walks towards the robot at one of a few
speeds; unless it is a false echo it is on one of a few lines along the corridor. For each
speed and line its distance is one Gaussian, so the belief is a small table of Kalman filters
with weights (a Rao-Blackwellised grid; Doucet et al., UAI 2000). Echoes are explained as in
probabilistic data association (Bar-Shalom and Tse, Automatica 11, 1975): by the thing, by
something else, or not heard.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from modules.reactor.cone import Flags, Floats, heard_in_cone

Table: TypeAlias = NDArray[np.float64]
"""One number for each speed and line: shape (speeds, lines)."""

SPEEDS_M_S: Floats = np.concatenate([[0.0], np.arange(0.6, 2.01, 0.2)])
"""Towards the robot, in the world; the first is a thing that stands."""

LINE_EDGES_M: Floats = np.array([-0.75, -0.55, -0.25, -0.15, -0.05, 0.05, 0.15, 0.25, 0.55, 0.75])
"""Edges of the lines, metres left of the centre line.

Beyond 0.55 a robot on the centre line is passed; within 0.25 all three forward cones hear a
person (radius 0.25); within 0.05 it does not matter to which side the robot goes (0.6 - 0.55).
"""

LINES_M: Floats = (LINE_EDGES_M[1:] + LINE_EDGES_M[:-1]) / 2
"""Middle of each line."""

RADIUS_M = 0.25
"""Of a person; also taken for things that stand."""

AXES_RAD: Floats = np.deg2rad([0.0, 15.0, -15.0])
HALF_ANGLE_RAD = float(np.deg2rad(15.0))
FARTHEST_M = 10.7


@dataclass(frozen=True)
class EchoModel:
    """How echoes come about; the prior of a thing whose first echo was just heard.

    Assumptions, all: a thing in the cone is heard with ``heard``, and something else in its
    place with ``masked``; where there is no thing an echo comes with ``stray``, uniform in
    range. ``walks`` and ``stands`` are prior to everything: how many unexplained echoes are
    the first of a person, of a wall or box, the rest being cross-talk. ``line_change_hz`` and
    ``leaves_hz`` are how often a person takes another line or leaves the corridor.
    """

    heard: float = 0.92
    masked: float = 0.04
    stray: float = 0.2
    walks: float = 0.02
    stands: float = 0.28
    line_change_hz: float = 0.02
    leaves_hz: float = 0.02
    speed_step_m_s: float = 0.06

    @property
    def missed(self) -> float:
        """Probability that a thing in the cone gives no echo."""
        return 1.0 - self.heard - self.masked

    @property
    def unexplained(self) -> float:
        """Likelihood ratio of a missing echo: a thing in the cone against none."""
        return self.missed / (1.0 - self.stray)


@dataclass(frozen=True)
class Thing:
    """The belief about one thing.

    ``weight`` (speeds, lines) and ``false`` sum to 1; ``distance_m`` and ``variance_m2`` are of
    its centre along the corridor from the robot; ``pings`` says how many explained it.
    """

    weight: Table
    false: float
    distance_m: Table
    variance_m2: Table
    pings: int = 1
    first_s: float = 0.0
    heard_s: float = 0.0

    @property
    def approaching(self) -> float:
        """Probability that it walks towards the robot."""
        return float(self.weight[1:].sum())

    @property
    def standing(self) -> float:
        """Probability that it is real and stands."""
        return float(self.weight[0].sum())

    @property
    def sides(self) -> tuple[float, float, float]:
        """Probabilities that it is left of, on and right of the centre line, given that it is real.

        On the line is within 5 cm: where the robot may pull aside to either side.
        """
        lines = self.weight.sum(axis=0) / self.weight.sum()
        middle = len(lines) // 2
        return float(lines[middle + 1 :].sum()), float(lines[middle]), float(lines[:middle].sum())

    @property
    def stands_at_m(self) -> float:
        """Expected distance of its centre if it stands; nan where it certainly does not."""
        return float(self.weight[0] @ self.distance_m[0] / self.standing)


def line_prior() -> Floats:
    """People walk anywhere that their shoulders leave free, equally likely."""
    width: Floats = np.diff(LINE_EDGES_M) / (LINE_EDGES_M[-1] - LINE_EDGES_M[0])
    return width


def born(
    cone: int, echo_m: float, sigma_m: float, lateral_m: float, time_s: float, model: EchoModel
) -> Thing:
    """A thing of which one forward cone heard one echo."""
    left = np.broadcast_to(LINES_M - lateral_m, (len(SPEEDS_M_S), len(LINES_M)))
    distance = np.sqrt(np.maximum((echo_m + RADIUS_M) ** 2 - left**2, 0.01))
    walking = np.full(len(SPEEDS_M_S) - 1, model.walks / (len(SPEEDS_M_S) - 1))
    thing = Thing(
        weight=np.concatenate([[model.stands], walking])[:, None] * line_prior(),
        false=1.0 - model.stands - model.walks,
        distance_m=distance,
        # Which part was heard is not known: up to a radius further off than the nearest.
        variance_m2=np.full_like(distance, sigma_m**2 + (RADIUS_M / 4) ** 2),
        first_s=time_s,
        heard_s=time_s,
    )
    _, heard, _ = _expected(thing, cone, lateral_m)
    return _weighed(thing, np.where(heard, thing.weight, 0.0), thing.false)


def moved(thing: Thing, driven_m: float, elapsed_s: float, model: EchoModel) -> Thing:
    """The thing after ``elapsed_s`` in which the robot drove ``driven_m`` forward."""
    distance = thing.distance_m - driven_m - SPEEDS_M_S[:, None] * elapsed_s
    walks = SPEEDS_M_S[:, None] > 0
    step = np.where(walks, model.speed_step_m_s * elapsed_s, 0.02 * min(elapsed_s, 1.0))
    changes = 1.0 - np.exp(-model.line_change_hz * elapsed_s)
    mixed = thing.weight.sum(axis=1, keepdims=True) * line_prior()
    weight = np.where(walks, (1.0 - changes) * thing.weight + changes * mixed, thing.weight)
    # Who has walked past is nowhere ahead any more.
    leaves = 1.0 - np.exp(-model.leaves_hz * elapsed_s)
    weight = np.where(distance < -RADIUS_M, 0.0, weight * (1.0 - leaves))
    return replace(
        thing,
        weight=weight,
        false=1.0 - float(weight.sum()),
        distance_m=distance,
        variance_m2=thing.variance_m2 + step**2,
    )


def listened(
    thing: Thing,
    cone: int,
    echo_m: float,
    sigma_m: float,
    lateral_m: float,
    model: EchoModel,
) -> tuple[Thing, float]:
    """The thing after one transducer's echo (nan for none), and how likely it was its echo."""
    range_m, heard, slope = _expected(thing, cone, lateral_m)
    if np.isnan(echo_m):
        weight = thing.weight * np.where(heard, model.missed, 1.0 - model.stray)
        return _weighed(thing, weight, thing.false * (1.0 - model.stray)), 0.0
    variance = slope**2 * thing.variance_m2 + sigma_m**2
    off = echo_m - range_m
    density = np.exp(-0.5 * off**2 / variance) / np.sqrt(2.0 * np.pi * variance)
    own = np.where(heard, model.heard * density, 0.0)
    likelihood = np.where(heard, own + model.masked / FARTHEST_M, model.stray / FARTHEST_M)
    share = own / likelihood
    gain = share * slope * thing.variance_m2 / variance
    weight = thing.weight * likelihood
    after = _weighed(
        replace(
            thing,
            distance_m=thing.distance_m + gain * off,
            variance_m2=thing.variance_m2 * (1.0 - gain * slope),
        ),
        weight,
        thing.false * model.stray / FARTHEST_M,
    )
    return after, float((after.weight * share).sum())


def hidden(
    thing: Thing, cone: int, echo_m: float, sigma_m: float, lateral_m: float, model: EchoModel
) -> Thing:
    """The thing after a transducer heard something else that is known to stand at ``echo_m``.

    What is behind it cannot be heard; what is before it should have been.
    """
    range_m, heard, _ = _expected(thing, cone, lateral_m)
    before = heard & (range_m < echo_m - 3.0 * np.sqrt(sigma_m**2 + thing.variance_m2))
    return _weighed(thing, thing.weight * np.where(before, model.unexplained, 1.0), thing.false)


def _expected(thing: Thing, cone: int, lateral_m: float) -> tuple[Table, Flags, Table]:
    """Range, whether heard, and change of range with distance, for each speed and line."""
    left = np.broadcast_to(LINES_M - lateral_m, thing.distance_m.shape)
    ahead = thing.distance_m
    range_m, heard = heard_in_cone(ahead, left, RADIUS_M, float(AXES_RAD[cone]), HALF_ANGLE_RAD)
    heard &= (range_m < FARTHEST_M) & (ahead > 0.0)
    slope = np.clip(ahead / np.maximum(np.hypot(ahead, left), 1e-6), 0.0, 1.0)
    return range_m, heard, slope


def _weighed(thing: Thing, weight: Table, false: float) -> Thing:
    """The thing with weights that sum to 1."""
    total = float(weight.sum()) + false
    return replace(thing, weight=weight / total, false=false / total)
