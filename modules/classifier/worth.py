"""What testing on is worth, in seconds: compiled look-ahead over plans of a few tests.

The cost of a visit is the time of its tests plus what the conclusion costs if it is wrong. A
plan tests one detector after another, each chosen by what the ones before it found, at most
``look_ahead`` of them, and then concludes at the least expected cost. What the best plan saves
against concluding at once is never negative, for it may conclude at once, too; and what a test
saves before its time is paid for is never negative, for the conclusion may ignore it (paper,
section 3, where plans follow the most probable map this need not hold).

Weights of types are not normalised: a branch's weights sum to its probability.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

LOOK_AHEAD = (1, 2, 3)
"""How many tests a plan may hold."""

STOP_ROW = -1
"""In place of a row: conclude."""

DECIMALS = 9
"""Seconds saved are rounded to so many decimals: what differs only by the order of additions is
a tie."""


class Detectors(NamedTuple):
    """The detectors that may be used: a row of each array for each of them.

    - ``class_given_type``: P(S=class|J), (detectors, classes, types);
    - ``seconds``: how long each takes, (detectors,).
    """

    class_given_type: NDArray[np.float64]
    seconds: NDArray[np.float64]


class Worth(NamedTuple):
    """What the plans that begin with each detector are worth at one belief.

    - ``saved_s``: expected cost of concluding at once less that of the plan, its time included,
      (detectors,);
    - ``time_s``: expected time of the plan, (detectors,);
    - ``cells``: table entries touched.
    """

    saved_s: NDArray[np.float64]
    time_s: NDArray[np.float64]
    cells: int


class Best(NamedTuple):
    """The row to test next, STOP_ROW for none, and the seconds it saves."""

    row: int
    saved_s: float
    cells: int


def worth(
    belief: NDArray[np.float64],
    regret_s: NDArray[np.float64],
    detectors: Detectors,
    used: int,
    look_ahead: int,
) -> Worth:
    """What each detector saves when it is tested next.

    ``belief`` is P(J), (types,); ``regret_s`` (conclusions, types) what a conclusion costs more
    than the best one for that type; ``used`` has a bit for each row that may not be used, whose
    entries come back as -inf saved and no time.
    """
    saved_s, time_s, cells = _worth(
        belief, regret_s, detectors.class_given_type, detectors.seconds, used, look_ahead
    )
    return Worth(saved_s, time_s, cells)


def most_cells(free: int, look_ahead: int, classes: int, types: int, conclusions: int) -> int:
    """The most cells that :func:`worth` touches with so many free detectors, known before.

    For each belief that a plan can come to: its types, and what each conclusion costs by type.
    """
    beliefs, reached = 1, 1
    for step in range(look_ahead):
        reached *= max(0, free - step) * classes
        beliefs += reached
    return beliefs * types * (1 + conclusions)


def best_test(
    belief: NDArray[np.float64],
    regret_s: NDArray[np.float64],
    detectors: Detectors,
    used: int,
    look_ahead: int,
) -> Best:
    """The first test of the plan that saves the most, arguments as for :func:`worth`.

    The lowest row of equals, whatever the machine: savings are rounded first.
    """
    found = worth(belief, regret_s, detectors, used, look_ahead)
    saved_s = np.round(found.saved_s, DECIMALS)
    if not len(saved_s) or saved_s.max() <= 0.0:
        return Best(STOP_ROW, 0.0, found.cells)
    row = int(saved_s.argmax())
    return Best(row, float(saved_s[row]), found.cells)


@njit(cache=True)
def _concluding_s(weights: NDArray[np.float64], regret_s: NDArray[np.float64]) -> float:
    """Expected cost of the best conclusion, times the weights' sum."""
    least = np.inf
    for a in range(len(regret_s)):
        cost = 0.0
        for j in range(len(weights)):
            cost += regret_s[a, j] * weights[j]
        least = min(least, cost)
    return least


@njit(
    "UniTuple(f8, 2)(f8[:, ::1], i8, f8[:, ::1], f8[:, :, ::1], f8[::1], i8, i8[::1])", cache=True
)
def _least_s(
    stack: NDArray[np.float64],
    level: int,
    regret_s: NDArray[np.float64],
    class_given_type: NDArray[np.float64],
    seconds: NDArray[np.float64],
    used: int,
    cells: NDArray[np.int64],
) -> tuple[float, float]:
    """Least expected cost from the weights in ``stack[level]``, and the time that is in it.

    Both times the weights' sum. As many tests may follow as the stack has rows left.
    """
    weights = stack[level]
    cells[0] += weights.size * (1 + len(regret_s))
    least_s, time_s = _concluding_s(weights, regret_s), 0.0
    if level + 1 == len(stack):
        return least_s, time_s
    mass = weights.sum()
    for d in range(len(seconds)):
        # Not even the truth would be worth the time of such a test.
        if used >> d & 1 or seconds[d] * mass >= least_s:
            continue
        plan_s = plan_time_s = seconds[d] * mass
        for c in range(class_given_type.shape[1]):
            for j in range(len(weights)):
                stack[level + 1, j] = weights[j] * class_given_type[d, c, j]
            after_s, after_time_s = _least_s(
                stack, level + 1, regret_s, class_given_type, seconds, used | 1 << d, cells
            )
            plan_s += after_s
            plan_time_s += after_time_s
        if plan_s < least_s:
            least_s, time_s = plan_s, plan_time_s
    return least_s, time_s


@njit(cache=True)
def _worth(
    belief: NDArray[np.float64],
    regret_s: NDArray[np.float64],
    class_given_type: NDArray[np.float64],
    seconds: NDArray[np.float64],
    used: int,
    look_ahead: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
    detectors, classes, types = class_given_type.shape
    saved_s, time_s = np.full(detectors, -np.inf), np.zeros(detectors)
    stack = np.empty((look_ahead, types))
    cells = np.full(1, types * (1 + len(regret_s)))
    now_s = _concluding_s(belief, regret_s)
    for d in range(detectors):
        if used >> d & 1:
            continue
        plan_s = plan_time_s = seconds[d] * belief.sum()
        for c in range(classes):
            for j in range(types):
                stack[0, j] = belief[j] * class_given_type[d, c, j]
            after_s, after_time_s = _least_s(
                stack, 0, regret_s, class_given_type, seconds, used | 1 << d, cells
            )
            plan_s += after_s
            plan_time_s += after_time_s
        saved_s[d], time_s[d] = now_s - plan_s, plan_time_s
    return saved_s, time_s, cells[0]
