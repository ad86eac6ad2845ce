"""Policies of testing that :mod:`benchmarks.sensing` holds side by side, and what each does.

Detectors are right with a given probability whatever they look for (two evidence classes; a
detector errs once for all, so it is used once). Every expectation is exact, over all sequences of
readings.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

from bus.grid import NORTH
from modules.classifier.choose import STOP
from modules.classifier.geometry import enterable, presence_table
from modules.classifier.sensor_model import load_sensor_model
from modules.classifier.worth import Detectors, best_test, worth

ORDERS = 100
LESS = 0.01
"""How much less of the conclusions may be right than with exhaustive testing."""

Floats: TypeAlias = NDArray[np.float64]
Policy: TypeAlias = Callable[["State"], int]
"""The row to test next, or STOP."""


@dataclass(frozen=True, eq=False)
class State:
    """What was read so far: its code in base 3, the rows used, and P(readings, J)."""

    code: int
    used: int
    weights: Floats


@dataclass(frozen=True, eq=False)
class Visits:
    """What a policy does, by true type: (types,) each, given that type."""

    tests: Floats
    seconds: Floats
    right: Floats

    def cost_s(self, wrong_s: float) -> float:
        """Expected cost of a visit, all types as probable."""
        return float((self.seconds + wrong_s * (1.0 - self.right)).mean())


@dataclass(frozen=True, eq=False)
class Problem:
    """Detectors of one accuracy, and what a wrong conclusion costs."""

    detectors: Detectors
    present: NDArray[np.bool_]
    wrong_s: float

    @property
    def regret_s(self) -> Floats:
        """What each conclusion costs by type."""
        return self.wrong_s * (1.0 - np.eye(self.present.shape[1]))


def problem(accuracy: float, wrong_s: float) -> Problem:
    """The informative detectors, each right with this probability; times as calibrated."""
    model = load_sensor_model()
    codes, _ = model.informative[0]
    present = presence_table()[0, enterable(NORTH)].reshape(8, -1)[:, codes].T == 1.0
    says_present = np.where(present, accuracy, 1.0 - accuracy)
    told = np.ascontiguousarray(np.stack([1.0 - says_present, says_present], axis=1))
    return Problem(Detectors(told, model.duration_by_detector_s[codes]), present, wrong_s)


@njit(cache=True)
def _optimal(told: Floats, seconds: Floats, wrong_s: float) -> tuple[NDArray[np.int8], float]:
    """The best test in each state, STOP where there is none, and the cost of a visit.

    From the last states backwards.
    """
    rows, _, types = told.shape
    power = 3 ** np.arange(rows)
    value_s = np.empty(3**rows)
    best = np.full(3**rows, -1, np.int8)
    weights = np.empty(types)
    for code in range(3**rows - 1, -1, -1):
        weights[:] = 1.0 / types
        for d in range(rows):
            read = code // power[d] % 3
            if read:
                weights *= told[d, read - 1]
        least_s = wrong_s * (weights.sum() - weights.max())
        for d in range(rows):
            if code // power[d] % 3 == 0:
                after_s = value_s[code + power[d]] + value_s[code + 2 * power[d]]
                plan_s = seconds[d] * weights.sum() + after_s
                if plan_s < least_s:
                    least_s, best[code] = plan_s, d
        value_s[code] = least_s
    return best, value_s[0]


def visits(policy: Policy, given: Problem) -> Visits:
    """What a policy does, exactly: states that can be reached, test by test."""
    told, seconds = given.detectors
    types = told.shape[2]
    tests, spent_s, right = np.zeros(types), np.zeros(types), np.zeros(types)
    reached = {0: State(0, 0, np.full(types, 1.0 / types))}
    while reached:
        following: dict[int, State] = {}
        for state in reached.values():
            row = policy(state)
            if row == STOP:
                right[state.weights.argmax()] += state.weights.max()
                continue
            tests += state.weights
            spent_s += state.weights * seconds[row]
            for after in _after(state, row, told):
                known = following.get(after.code)
                same = known.weights if known else 0.0
                following[after.code] = State(after.code, after.used, after.weights + same)
        reached = following
    return Visits(types * tests, types * spent_s, types * right)


def _after(state: State, row: int, told: Floats) -> Iterator[State]:
    for read in (0, 1):
        code = state.code + (read + 1) * 3**row
        yield State(code, state.used | 1 << row, state.weights * told[row, read])


def exhaustive(given: Problem) -> Policy:
    """Every detector that can tell anything."""
    return lambda state: next((d for d in range(len(given.present)) if _free(state, d)), STOP)


def in_order(order: NDArray[np.int64], best: NDArray[np.int8]) -> Policy:
    """The free detector that comes first, for as long as the optimal policy would test."""

    def policy(state: State) -> int:
        if best[state.code] == STOP:
            return STOP
        return int(next(d for d in order if _free(state, d)))

    return policy


def most_likely_first(given: Problem, best: NDArray[np.int8]) -> Policy:
    """The feature that is there most probably, of those not certain; stops as above."""

    def policy(state: State) -> int:
        if best[state.code] == STOP:
            return STOP
        share = given.present @ state.weights / state.weights.sum()
        free = [d for d in range(len(share)) if _free(state, d)]
        return max(free, key=lambda d: share[d] if share[d] < 1.0 - 1e-9 else -1.0)

    return policy


def looking(given: Problem, ahead: int) -> Policy:
    """The classifier's own choice."""

    def policy(state: State) -> int:
        belief = state.weights / state.weights.sum()
        return best_test(belief, given.regret_s, given.detectors, state.used, ahead).row

    return policy


def most_a_second(given: Problem, ahead: int) -> Policy:
    """The plan that saves the most for each second it takes, instead of the most."""

    def policy(state: State) -> int:
        belief = state.weights / state.weights.sum()
        found = worth(belief, given.regret_s, given.detectors, state.used, ahead)
        rate = np.where(found.saved_s > 1e-9, found.saved_s / np.maximum(found.time_s, 1e-9), 0.0)
        return int(rate.argmax()) if rate.max() > 0.0 else STOP

    return policy


def _free(state: State, row: int) -> bool:
    return not state.used >> row & 1


def policies(given: Problem) -> Iterator[tuple[str, Visits]]:
    """Every policy's visits, the optimal one first."""
    best, _ = _optimal(given.detectors.class_given_type, given.detectors.seconds, given.wrong_s)
    yield "optimal", visits(lambda state: int(best[state.code]), given)
    for ahead in (3, 2, 1):
        yield f"look-ahead {ahead}", visits(looking(given, ahead), given)
    yield "look-ahead 3, most a second", visits(most_a_second(given, 3), given)
    yield "most likely first", visits(most_likely_first(given, best), given)
    rng = np.random.default_rng(1)
    orders = [rng.permutation(len(given.present)) for _ in range(ORDERS)]
    each = [visits(in_order(order, best), given) for order in orders]
    fields = ("tests", "seconds", "right")
    yield "random order", Visits(*(np.mean([getattr(v, f) for v in each], axis=0) for f in fields))
    yield "exhaustive", visits(exhaustive(given), given)


def least_tests(given: Problem, right: float) -> float:
    """The fewest tests a visit with which any policy is right in this share of the visits.

    A price of mu tests for a wrong conclusion has a least cost V(mu) over all policies, by dynamic
    programming; every policy that errs with probability e or less takes V(mu) - mu e tests or
    more. The most that any mu yields is reached by mixing two policies (linear programming).
    """
    told = given.detectors.class_given_type
    a_test = np.ones(len(told))

    def bound(log_mu: float) -> float:
        mu = float(np.exp(log_mu))
        return _optimal(told, a_test, mu)[1] - mu * (1.0 - right)

    low, high = np.log(1.0), np.log(1e6)
    # V is concave in mu, so the bound has one summit: golden section.
    ratio = (np.sqrt(5.0) - 1.0) / 2.0
    left, right_of = high - ratio * (high - low), low + ratio * (high - low)
    at_left, at_right = bound(left), bound(right_of)
    while high - low > 0.01:
        if at_left < at_right:
            low, left, at_left = left, right_of, at_right
            right_of = low + ratio * (high - low)
            at_right = bound(right_of)
        else:
            high, right_of, at_right = right_of, left, at_left
            left = high - ratio * (high - low)
            at_left = bound(left)
    return max(at_left, at_right, 0.0)
