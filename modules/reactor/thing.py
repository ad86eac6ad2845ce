"""One thing ahead of the robot: what it may be, where, and how fast it comes.

A thing is a false echo, or it stands (speed 0), or it walks towards the robot at one of a few
speeds; unless it is a false echo it is on one of a few lines along the corridor, or it is a pair,
one on either side of the middle: two people abreast, the two sides of a door frame. For each speed
and line its distance is one Gaussian, so the belief is a small table of Kalman filters
with weights (a Rao-Blackwellised grid; Doucet et al., UAI 2000). Echoes are explained as in
probabilistic data association (Bar-Shalom and Tse, Automatica 11, 1975): by the thing, by
something else, or not heard. What an echo does to the table is in
:mod:`modules.reactor.thing_kernels`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from modules.reactor.cone import Floats

SPEEDS_M_S: Floats = np.concatenate([[0.0], np.linspace(0.6, 2.0, 15)])
"""Towards the robot, in the world; the first is a thing that stands."""

_LINE_EDGES_M = np.array([0.05, 0.1, 0.15, 0.2, 0.235, 0.25, 0.3, 0.4, 0.5, 0.6, 0.75, 1.0, 1.5])
LINE_EDGES_M: Floats = np.concatenate([-_LINE_EDGES_M[::-1], _LINE_EDGES_M])
"""Edges of the lines, metres left of the centre line.

Beyond 0.5 a robot on the centre line is passed, beyond 0.6 by a cart too; within 0.25 the three
cones most nearly ahead hear a person (radius 0.25), and just within it two of them a little
further off; within 0.15 it does not matter to which side the robot goes (0.65 - 0.5). In between
the lines are narrow: which cones graze a person is what tells the side. Beyond 0.75 nobody walks;
there are walls, their corners and door frames, and what leans against them.
"""

FARTHEST_LINE_M = 0.75
"""How far from the centre line people's shoulders leave them free to walk."""

LINES_M: Floats = (LINE_EDGES_M[1:] + LINE_EDGES_M[:-1]) / 2
"""Middle of each line."""

PAIR_M = 0.63
PAIR_HALF_M = 0.07
"""How far from the centre line the two of a pair are, one on either side, and how far off that."""

PAIRS_M: Floats = np.array([[0.0, 0.0], [0.15, 0.0], [0.0, 0.15], [0.3, 0.0], [0.0, 0.3]])
"""Pairs, (pairs, 2): how much further ahead than the nearer of them the left and right one are.

Who comes further behind is a thing of his own.
"""

SINGLE = len(LINES_M)
COLUMNS = SINGLE + len(PAIRS_M)
"""Where a thing may be across the corridor: first the lines, then the pairs."""

PAIRED = 0.01
"""Share of pairs among what comes or stands (assumption)."""


def _prior(lines: Floats) -> Floats:
    """By column, given that by line."""
    pairs = np.full(len(PAIRS_M), PAIRED / len(PAIRS_M))
    return np.concatenate([(1.0 - PAIRED) * lines, pairs])


LINE_PRIOR = _prior(
    np.where(np.abs(LINES_M) < FARTHEST_LINE_M, np.diff(LINE_EDGES_M) / (2 * FARTHEST_LINE_M), 0.0)
)
"""People walk anywhere that their shoulders leave free, equally likely: (columns,)."""

STANDS_PRIOR = _prior(np.diff(LINE_EDGES_M) / (LINE_EDGES_M[-1] - LINE_EDGES_M[0]))
"""Things stand anywhere in the corridor and along its walls, equally likely: (columns,)."""

SHAPE = (3, len(SPEEDS_M_S), COLUMNS)
"""Of a belief: (WEIGHT, DISTANCE, VARIANCE) by speed and column."""

WEIGHT, DISTANCE, VARIANCE = 0, 1, 2

RADIUS_M = 0.25
"""Of a person; also taken for things that stand."""


class EchoModel(NamedTuple):
    """How echoes come about; the prior of a thing whose first echo was just heard.

    Assumptions, all: a thing in the cone is heard with ``heard``, and something else in its
    place with ``masked``; where there is no thing an echo comes with ``stray``, uniform in
    range. ``walks`` and ``stands`` are prior to everything: how many unexplained echoes are
    the first of a person, of a wall or box, the rest being cross-talk. ``line_change_hz`` and
    ``leaves_hz`` are how often a person takes another line or leaves the corridor;
    ``speed_step_m_s`` how far a speed is off those of the table.
    """

    heard: float = 0.92
    masked: float = 0.04
    stray: float = 0.2
    walks: float = 0.02
    stands: float = 0.28
    line_change_hz: float = 0.005
    leaves_hz: float = 0.005
    speed_step_m_s: float = 0.06


@dataclass(frozen=True)
class Thing:
    """The belief about one thing.

    ``belief`` (3, speeds, columns): the WEIGHT of each speed and line or pair, and mean DISTANCE
    (m) and VARIANCE (m2) of its centre along the corridor from the robot. The weights and
    ``false``, the probability of a false echo, sum to 1. ``pings`` says how many explained it, the
    first at ``first_s``.
    """

    belief: Floats
    false: float
    pings: int = 1
    first_s: float = 0.0

    @property
    def weight(self) -> Floats:
        """Probability of each speed and line or pair, (speeds, columns)."""
        weight: Floats = self.belief[WEIGHT]
        return weight

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
        """Probabilities that it is left of, on and right of the centre line, given that it is one.

        On the line is within 5 cm.
        """
        lines = self.weight[:, :SINGLE].sum(axis=0)
        lines /= lines.sum()
        middle = len(lines) // 2
        return float(lines[middle + 1 :].sum()), float(lines[middle]), float(lines[:middle].sum())
