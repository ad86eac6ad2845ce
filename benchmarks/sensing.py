"""Which detector next: look-ahead beside exhaustive testing, plain orders and the optimal policy.

    python -m benchmarks.sensing [--wrong-type-s SECONDS] [--runs SEEDS]

A visit to a junction of each of the 8 types that can be entered, all as probable, by detectors
that are right with a given probability whatever they look for (two evidence classes; a detector
errs once for all, so it is used once). Every expectation is exact, over all sequences of readings:
nothing is drawn but the 100 random orders. The optimal policy is found by dynamic programming over
the 3^12 states of the twelve detectors that can tell types apart; orders that do not choose stop
where the optimal policy would stop. Then whole runs of ``aces``: conclusions against true types.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from bus.features import DETECTORS
from bus.grid import NORTH, Grid, type_name
from bus.messages import (
    Arrival,
    DeadlineMissed,
    Reading,
    SensingDecision,
    TrueBuilding,
    TruePose,
)
from modules.classifier.choose import STOP, WRONG_TYPE_S
from modules.classifier.geometry import enterable, presence_table
from modules.classifier.sensor_model import load_sensor_model
from modules.classifier.worth import Detectors, best_test, worth
from tests.scenarios.runs import everything_said, of_kind, shipped

ACCURACIES = (0.6, 0.7, 0.8, 0.9, 0.95, 0.99)
SHOWN_BY_TYPE = 0.9
ORDERS = 100
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
    features = presence_table()[0, enterable(NORTH)].reshape(-1, DETECTORS)
    present = features[:, codes].T
    says_present = np.where(present, accuracy, 1.0 - accuracy)
    told = np.ascontiguousarray(np.stack([1.0 - says_present, says_present], axis=1))
    return Problem(Detectors(told, model.duration_by_detector_s[codes]), present, wrong_s)


@njit(cache=True)
def _optimal(told: Floats, seconds: Floats, wrong_s: float) -> NDArray[np.int64]:
    """The best test in each state, STOP where there is none: from the last states backwards."""
    rows, _, types = told.shape
    power = 3 ** np.arange(rows)
    value_s = np.empty(3**rows)
    best = np.full(3**rows, -1)
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
    return best


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


def in_order(order: NDArray[np.int64], best: NDArray[np.int64]) -> Policy:
    """The free detector that comes first, for as long as the optimal policy would test."""

    def policy(state: State) -> int:
        if best[state.code] == STOP:
            return STOP
        return int(next(d for d in order if _free(state, d)))

    return policy


def most_likely_first(given: Problem, best: NDArray[np.int64]) -> Policy:
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
    best = _optimal(given.detectors.class_given_type, given.detectors.seconds, given.wrong_s)
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


def of_accuracy(accuracy: float, wrong_s: float) -> list[tuple[str, Visits]]:
    """All policies with detectors of one accuracy."""
    return list(policies(problem(accuracy, wrong_s)))


@dataclass(frozen=True)
class Run:
    """Conclusions of a whole run, and how many were right."""

    visits: int
    right: int
    tests: int
    late: int


def run(seed: int) -> Run:
    """One run of ``aces``: what was concluded at each visit against the true type."""
    said = everything_said(shipped("aces", seed=seed).scenario)
    (building,) = of_kind(said, TrueBuilding)
    grid = Grid(len(building.columns_m), len(building.rows_m))
    types = grid.junction_types(building.corridors[None, :])[0]
    evidence = {read.action: read.evidence for read in of_kind(said, Reading)}
    concluded = {}
    for decision in of_kind(said, SensingDecision):
        outcome = evidence.get(decision.action, 0)
        if decision.next_detector[outcome] == STOP:
            concluded[decision.visit] = int(decision.concluded[outcome])
    arrived = [arrival.visit for arrival in of_kind(said, Arrival)]
    places = [pose.place for pose in of_kind(said, TruePose)]
    right = sum(concluded.get(v) == types[at] for v, at in zip(arrived, places, strict=True))
    late = len(of_kind(said, DeadlineMissed))
    return Run(len(arrived), right, len(evidence), late)


def show_accuracies(
    console: Console, found: list[list[tuple[str, Visits]]], wrong_s: float
) -> None:
    """A row for each policy, a column for each accuracy."""
    table = Table(
        title="share of right conclusions / tests / seconds a visit / cost against the optimal"
    )
    table.add_column("policy")
    for accuracy in ACCURACIES:
        table.add_column(f"{accuracy:g}", no_wrap=True)
    for k, (name, _) in enumerate(found[0]):
        cells = []
        for column in found:
            this, least_s = column[k][1], column[0][1].cost_s(wrong_s)
            cells.append(
                f"{this.right.mean():.4f} / {this.tests.mean():.1f} / {this.seconds.mean():.0f}"
                f" / {this.cost_s(wrong_s) / least_s:.3f}"
            )
        table.add_row(name, *cells)
    console.print(table)


def show_types(console: Console, found: list[tuple[str, Visits]]) -> None:
    """A row for each true type: the optimal policy and the longest look-ahead."""
    table = Table(title=f"by true type, accuracy {SHOWN_BY_TYPE:g}: right / tests / seconds")
    for name in ("entered northward", *(name for name, _ in found[:2]), found[-1][0]):
        table.add_column(name)
    for row, junction_type in enumerate(np.flatnonzero(enterable(NORTH)).tolist()):
        shown = [found[0][1], found[1][1], found[-1][1]]
        cells = [f"{v.right[row]:.4f} / {v.tests[row]:.1f} / {v.seconds[row]:.0f}" for v in shown]
        table.add_row(type_name(junction_type), *cells)
    console.print(table)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--wrong-type-s", type=float, default=WRONG_TYPE_S)
    parser.add_argument("--runs", type=int, default=5, help="seeds of whole runs, 0 for none")
    given = parser.parse_args()
    console = Console(width=200)
    with ProcessPoolExecutor() as pool:
        found = list(pool.map(partial(of_accuracy, wrong_s=given.wrong_type_s), ACCURACIES))
        show_accuracies(console, found, given.wrong_type_s)
        show_types(console, found[ACCURACIES.index(SHOWN_BY_TYPE)])
        runs = list(pool.map(run, range(1, given.runs + 1)))
    if runs:
        visited = sum(r.visits for r in runs)
        console.print(
            f"aces, {len(runs)} runs: {sum(r.right for r in runs)} of {visited} visits concluded "
            f"right, {sum(r.tests for r in runs) / visited:.2f} tests a visit, "
            f"{sum(r.late for r in runs)} decisions late"
        )


if __name__ == "__main__":
    main()
