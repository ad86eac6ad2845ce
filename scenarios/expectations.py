"""The ``[[expect]]`` tables of a scenario, held against what the log says."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from logs.analysis import Analysis
from scenarios.scenario import Expect


@dataclass(frozen=True)
class Verdict:
    """One expectation: what was expected, what was found, whether it holds."""

    expected: str
    found: str
    holds: bool


def judge(expects: Sequence[Expect], analysis: Analysis, errands: int) -> list[Verdict]:
    """Every expectation's verdict. ``errands`` is how many the scenario has."""
    verdicts: list[Verdict] = []
    for expect in expects:
        verdicts += _of_decisions(expect, analysis)
        verdicts += _of_run(expect, analysis, errands)
    return verdicts


def _of_decisions(expect: Expect, analysis: Analysis) -> list[Verdict]:
    which = "all" if expect.decision is None else expect.decision
    rows = [row for row in analysis.decisions if expect.decision in (None, row.kind)]
    verdicts: list[Verdict] = []
    if expect.late is not None:
        late = sum(row.late for row in rows)
        verdicts.append(
            Verdict(
                f"{which} decisions late: at most {expect.late}", f"{late}", late <= expect.late
            )
        )
    if expect.slack_at_least_s is not None:
        slacks = [row.slack_min_s for row in rows if row.slack_min_s is not None]
        least = min(slacks, default=math.inf)
        verdicts.append(
            Verdict(
                f"{which} decisions' slack: at least {expect.slack_at_least_s:g} s",
                f"{least:.3f} s" if slacks else "no decision",
                least >= expect.slack_at_least_s,
            )
        )
    return verdicts


def _of_run(expect: Expect, analysis: Analysis, errands: int) -> list[Verdict]:
    belief = analysis.belief
    probability = 0.0 if belief is None else belief.true_map or 0.0
    done = analysis.errands.number
    wanted = errands if expect.errands_done == "all" else expect.errands_done
    collisions = analysis.encounters.collisions
    checks: list[tuple[object, str, str, Callable[[], bool]]] = [
        (wanted, f"errands done: {wanted}", f"{done}", lambda: done >= (wanted or 0)),
        (
            expect.true_map_at_least,
            f"probability of the true map: at least {expect.true_map_at_least}",
            f"{probability:.4f}" if belief else "no belief",
            lambda: probability >= (expect.true_map_at_least or 0.0),
        ),
        (
            expect.collisions,
            f"collisions: at most {expect.collisions}",
            f"{collisions}",
            lambda: collisions <= (expect.collisions or 0),
        ),
    ]
    return [
        Verdict(text, found, holds()) for given, text, found, holds in checks if given is not None
    ]
