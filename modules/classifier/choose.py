"""Which feature to test next, decided while the current detector runs (paper, section 5).

A sensing action takes thirty seconds to a minute, and its outcome is not known yet, so the
choice is contingent: one next detector for every evidence class the running one may find.
Each is the detector that the best plan of a few tests begins with, in expected seconds: the
time of the tests and what a wrong conclusion costs (:mod:`modules.classifier.worth`). Where no
plan saves anything, sensing stops with the conclusion of least expected cost.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.features import Wedges
from bus.grid import DIRECTIONS, JUNCTION_TYPES
from modules.classifier.geometry import enterable, heading_number, layouts, members
from modules.classifier.likelihood import (
    STATES,
    Reading,
    ReadingError,
    by_type,
    check_detector,
    check_readings,
    visit_likelihood,
)
from modules.classifier.sensor_model import EVIDENCE_CLASSES, SensorModel
from modules.classifier.worth import (
    DECIMALS,
    LOOK_AHEAD,
    Best,
    Detectors,
    best_test,
    most_cells,
)

STOP = -1
"""In place of a next detector: conclude, no detector is worth its time."""

WRONG_TYPE_S = 100_000.0
"""What concluding a wrong type costs, in seconds (assumption): a conclusion stays in the map and
is not tested again, so it costs two corridors of four minutes, to a wall and back, in each of some
two hundred later errands. Where the robot meets surfaces unlike those of its calibration, this is
also what makes it test a surprising reading once more."""


class PriorError(ValueError):
    """A prior that is no distribution over the 16 types, or that the readings contradict."""


class CostError(ValueError):
    """Costs of conclusions that no decision can be made by."""


@dataclass(frozen=True, eq=False)
class Choice:
    """What to do next, by the evidence class of the running detector (one row if none runs).

    ``next_detector`` is a code or STOP; ``concluded_type`` the conclusion of least expected cost
    given that outcome; ``worth_s`` the expected seconds saved by testing on (0 for STOP);
    ``belief`` is P(J|prior, readings, outcome), (outcomes, 16); plans held at most
    ``look_ahead`` tests; ``cells`` counts the table entries touched.
    """

    next_detector: NDArray[np.int64]
    concluded_type: NDArray[np.int64]
    worth_s: NDArray[np.float64]
    belief: NDArray[np.float64]
    look_ahead: int
    cells: int


def flat_cost_s(wrong_type_s: float = WRONG_TYPE_S) -> NDArray[np.float64]:
    """The same cost for every wrong conclusion: (concluded types, true types)."""
    return wrong_type_s * (1.0 - np.eye(JUNCTION_TYPES))


def choose(
    prior: NDArray[np.float64],
    readings: Sequence[Reading],
    running: int | None,
    heading: int,
    model: SensorModel,
    cost_s: NDArray[np.float64],
    look_ahead: int,
) -> Choice:
    """The best next detector for every outcome of the running one.

    ``prior`` is pi(J), (16,), any positive scale. ``cost_s``, (concluded types, true types), is
    what a conclusion costs the decisions made by it; only differences for the same true type
    matter. A plan holds at most ``look_ahead`` tests, each detector at most once a visit.
    Raises PriorError, CostError, HeadingError, and ReadingError where a detector is used twice.
    """
    _check_look_ahead(look_ahead)
    problem = problem_of(prior, readings, running, heading, model, cost_s)
    found = [problem.best(outcome, look_ahead) for outcome in range(len(problem.belief))]
    return problem.choice(found, look_ahead)


@dataclass(frozen=True, eq=False)
class Problem:
    """What a choice rests on, made once for all outcomes of the running detector.

    ``belief`` as in :class:`Choice` and ``chance``, (outcomes,), the probability of each outcome;
    ``entered`` (16,) the types with the corridor behind. ``states``, (outcomes, types + 1), are the
    probabilities of those with the visit as it should be, and last of a visit gone astray, which
    says nothing of the type; ``regret_s``, (types, types + 1), what a conclusion costs more than
    the best in each of these states. ``codes`` names the rows of ``detectors``, which are one for
    each outcome: what readings tell depends on the doorways that are likely by then. ``barred`` has
    a bit for each detector that is used up; ``readings`` is how many there are.
    """

    belief: NDArray[np.float64]
    states: NDArray[np.float64]
    chance: NDArray[np.float64]
    entered: NDArray[np.bool_]
    regret_s: NDArray[np.float64]
    codes: NDArray[np.int64]
    detectors: tuple[Detectors, ...]
    barred: int
    readings: int

    def best(self, outcome: int, look_ahead: int) -> Best:
        """The best next test after an outcome, by plans of at most so many tests."""
        return best_test(
            self.states[outcome], self.regret_s, self.detectors[outcome], self.barred, look_ahead
        )

    @property
    def expected_s(self) -> NDArray[np.float64]:
        """What each conclusion costs after each outcome: (outcomes, conclusions)."""
        found: NDArray[np.float64] = (self.states[:, None, :] * self.regret_s).sum(axis=2)
        return found

    def choice(self, found: Sequence[Best], look_ahead: int) -> Choice:
        """What was found for each outcome, told by detector codes and types."""
        concluded = np.round(self.expected_s, DECIMALS).argmin(axis=1)
        return Choice(
            next_detector=np.append(self.codes, STOP)[[best.row for best in found]],
            concluded_type=np.flatnonzero(self.entered)[concluded],
            worth_s=np.array([best.saved_s for best in found]),
            belief=self.belief,
            look_ahead=look_ahead,
            cells=self.cells_of_beliefs + sum(best.cells for best in found),
        )

    @property
    def cells_of_beliefs(self) -> int:
        """Table entries touched to find the beliefs after each outcome, and what is told then."""
        return _cells_of_beliefs(self.readings, len(self.belief), len(self.codes))

    def cells_of_plans(self, look_ahead: int) -> int:
        """The most table entries that one outcome's plans of so many tests can touch."""
        return _cells_of_plans(int(self.free.sum()), look_ahead, int(self.entered.sum()))

    @property
    def free(self) -> NDArray[np.bool_]:
        """Which detectors may still be used, by row."""
        return np.array([not self.barred >> k & 1 for k in range(len(self.codes))], dtype=np.bool_)


def problem_of(
    prior: NDArray[np.float64],
    readings: Sequence[Reading],
    running: int | None,
    heading: int,
    model: SensorModel,
    cost_s: NDArray[np.float64],
) -> Problem:
    """The problem of a choice; arguments and errors as for :func:`choose`."""
    used = _used(readings, running, model.wedges)
    joint = _joint(prior, readings, running, heading, model)
    chance = joint.sum(axis=1)
    if not (chance > 0).all():
        raise PriorError(
            f"the prior {prior.tolist()} gives no weight to any type that can be entered "
            f"with heading {heading}"
        )
    _check_cost(cost_s)
    entered = enterable(heading)
    before = prior * entered / prior[entered].sum()
    states = joint / chance[:, None]
    types, astray = by_type(states[:, :-1], heading), states[:, -1:]
    codes, searched = model.informative[heading_number(heading)]
    given = model.class_given_state[heading_number(heading), codes]
    return Problem(
        belief=types + astray * before,
        states=np.column_stack([types[:, entered], astray]),
        chance=chance / chance.sum(),
        entered=entered,
        regret_s=_regret_s(cost_s[np.ix_(entered, entered)], before[entered]),
        codes=codes,
        detectors=tuple(
            _told(given, searched.seconds, weights, heading) for weights in states[:, :-1]
        ),
        barred=sum(1 << k for k, code in enumerate(codes.tolist()) if code in used),
        readings=len(readings),
    )


def _regret_s(cost_s: NDArray[np.float64], before: NDArray[np.float64]) -> NDArray[np.float64]:
    """What a conclusion costs more than the best for a type, and for nothing but its prior."""
    regret_s = cost_s - cost_s.min(axis=0)
    astray_s = regret_s @ before
    return np.column_stack([regret_s, astray_s - astray_s.min()])


def cells_before(
    readings: Sequence[Reading], running: int | None, heading: int, model: SensorModel, ahead: int
) -> int:
    """The most table entries that a choice with this look-ahead touches, known before it starts.

    One for each type and reading to find the belief, and for each outcome those of its plans.
    Raises HeadingError.
    """
    used = [reading.detector for reading in readings] + [running]
    codes, _ = model.informative[heading_number(heading)]
    free = sum(code not in used for code in codes.tolist())
    outcomes = 1 if running is None else EVIDENCE_CLASSES
    types = int(enterable(heading).sum())
    plans = _cells_of_plans(free, ahead, types)
    return _cells_of_beliefs(len(readings), outcomes, len(codes)) + outcomes * plans


def look_ahead_within(
    cells: int,
    most: int,
    readings: Sequence[Reading],
    running: int | None,
    heading: int,
    model: SensorModel,
) -> int:
    """The longest look-ahead, up to ``most``, whose cells are within a number; 1 if none is.

    Raises HeadingError.
    """
    fitting = [
        ahead
        for ahead in LOOK_AHEAD
        if ahead <= most and cells_before(readings, running, heading, model, ahead) <= cells
    ]
    return max(fitting, default=LOOK_AHEAD[0])


def rehearse(model: SensorModel) -> None:
    """A first choice, so that everything is compiled before anybody waits for a real one."""
    uniform = np.full(JUNCTION_TYPES, 1 / JUNCTION_TYPES)
    choose(uniform, [], None, DIRECTIONS[0], model, flat_cost_s(), LOOK_AHEAD[0])


def _cells_of_plans(free: int, ahead: int, types: int) -> int:
    """The most that one outcome's plans touch: over the types, and a visit gone astray."""
    return most_cells(free, ahead, EVIDENCE_CLASSES, types + 1, types)


def _cells_of_beliefs(readings: int, outcomes: int, searched: int) -> int:
    """One for each layout, of each reading and outcome, and of what is told after each."""
    return STATES * (readings + outcomes + outcomes * searched * EVIDENCE_CLASSES)


def _used(readings: Sequence[Reading], running: int | None, wedges: Wedges) -> list[int]:
    check_readings(readings, wedges)
    used = [reading.detector for reading in readings]
    if running is not None:
        check_detector(running, wedges)
        if running in used:
            raise ReadingError(f"detector {running} runs again in one visit")
        used.append(running)
    return used


def _check_cost(cost_s: NDArray[np.float64]) -> None:
    if cost_s.shape != (JUNCTION_TYPES, JUNCTION_TYPES) or not np.isfinite(cost_s).all():
        raise CostError(
            f"costs are finite seconds for {JUNCTION_TYPES} conclusions by {JUNCTION_TYPES} "
            f"types, got {cost_s!r}"
        )


def _check_look_ahead(look_ahead: int) -> None:
    if look_ahead not in LOOK_AHEAD:
        raise CostError(f"plans hold one of {LOOK_AHEAD} tests at most, got {look_ahead}")


def _joint(
    prior: NDArray[np.float64],
    readings: Sequence[Reading],
    running: int | None,
    heading: int,
    model: SensorModel,
) -> NDArray[np.float64]:
    """P(layout or astray, readings, outcome) for every outcome of the running detector.

    (outcomes, layouts + 1), times the prior's scale.
    """
    if prior.shape != (JUNCTION_TYPES,) or not (prior >= 0).all() or not np.isfinite(prior).all():
        raise PriorError(f"a prior is {JUNCTION_TYPES} finite numbers >= 0, got {prior!r}")
    before = [prior[layout.type] for layout in layouts(heading)]
    weights = np.append(before, prior[enterable(heading)].sum())
    joint = (weights * visit_likelihood(readings, heading, model))[None, :]
    if running is not None:
        joint = joint * model.class_given_state[heading_number(heading), running].T
    return joint


def _told(
    given: NDArray[np.float64],
    seconds: NDArray[np.float64],
    weights: NDArray[np.float64],
    heading: int,
) -> Detectors:
    """What readings tell of the type, doorways being as likely as by now.

    ``given`` is P(class|layout or astray), (detectors, layouts + 1, classes), ``weights``,
    (layouts,), what the layouts weigh. So the next reading is reckoned exactly; those that follow
    it in a plan are taken to be independent of it given the type.
    """
    types = members(heading)
    of_type = types * weights[:, None]
    sums = of_type.sum(axis=0)
    # What is told of a type that cannot be does not matter.
    shares = np.divide(of_type, sums, out=types / types.sum(axis=0), where=sums > 0)
    told = np.einsum("dkc,kj->dcj", given[:, :-1], shares)
    table = np.concatenate([told, given[:, -1, :, None]], axis=2)
    return Detectors(np.ascontiguousarray(table), seconds)
