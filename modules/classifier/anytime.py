"""Which feature next, refined until stopped: an anytime procedure (Dean and Boddy, AAAI 1988).

The answer to begin with is to conclude at once after every outcome. Then plans of one test are
weighed for one outcome after the other, the most probable first, then plans of two, and so on.
Stopped anywhere, it has an answer for every outcome, the best where it matters most.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bus.costs import WhyStopped
from modules.classifier.choose import Choice, Problem
from modules.classifier.worth import LOOK_AHEAD, STOP_ROW, Best


@dataclass(frozen=True, eq=False)
class Refined:
    """The choice as far as it went, and why it went no further.

    ``look_ahead``, (outcomes,), says how many tests the plans of each outcome hold at most, 0 for
    the answer to begin with. ``settled`` means that not even the truth is worth the time of a
    test, whatever the outcome.
    """

    choice: Choice
    look_ahead: NDArray[np.int64]
    stopped: WhyStopped


def refine(problem: Problem, cells: int, most: int = LOOK_AHEAD[-1]) -> Refined:
    """The best next detectors that can be found with so many cells, plans of up to ``most`` tests.

    It takes no step that might touch more cells than are left, so ``choice.cells`` is at most
    ``cells``, or that of the answer to begin with.
    """
    open_outcomes = _open(problem)
    steps = [(ahead, k) for ahead in LOOK_AHEAD if ahead <= most for k in open_outcomes]
    found = [Best(STOP_ROW, 0.0, 0)] * len(problem.belief)
    look_ahead = np.zeros(len(problem.belief), dtype=np.int64)
    used, stopped = problem.cells_of_beliefs, _finished(steps)
    for ahead, outcome in steps:
        if used + problem.cells_of_plans(ahead) > cells:
            stopped = "out of cells"
            break
        better = problem.best(outcome, ahead)
        used += better.cells
        found[outcome] = better._replace(cells=found[outcome].cells + better.cells)
        look_ahead[outcome] = ahead
    return Refined(problem.choice(found, int(look_ahead.max())), look_ahead, stopped)


def _open(problem: Problem) -> list[int]:
    """The outcomes after which a test may be worth its time, the most probable first."""
    seconds = problem.detectors[0].seconds[problem.free]
    if not len(seconds):
        return []
    wrong_s = problem.expected_s.min(axis=1)
    order = np.argsort(-problem.chance, kind="stable").tolist()
    return [outcome for outcome in order if wrong_s[outcome] > seconds.min()]


def _finished(steps: list[tuple[int, int]]) -> WhyStopped:
    """Why it stops once all steps are done."""
    return "nothing left" if steps else "settled"
