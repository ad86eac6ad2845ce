"""A regression as text, as one JSON object and as JUnit."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree

from logs.regress.regression import (
    FAILED,
    GOOD,
    INCONCLUSIVE,
    Regression,
    RunResult,
    wall_outcome,
)
from logs.regress.wall import LEAST_RUNS, TOO_FEW, WallComparison
from logs.regress.words import decision_words, work_words

SHOWN = 8
"""Changes of a kind that the text shows of one run; JSON and JUnit have them all."""


@dataclass(frozen=True)
class Check:
    """One of the three checks of one run. One that does not block is advice."""

    about: str
    outcome: str
    blocks: bool
    summary: str
    changes: tuple[str, ...]


def checks(run: RunResult, *, wall_blocks: bool) -> Iterator[Check]:
    """The checks of a run in their order: the last is advice unless ``wall_blocks``."""
    found = run.comparison
    if run.unsteady and not run.reasons:
        yield Check("repeats itself", FAILED, True, "runs made from the same differ", ())
    ledger = tuple(decision_words(change) for change in found.ledger)
    if found.ended:
        ledger = (f"the run: {found.ended[0]} -> {found.ended[1]}", *ledger)
    late = sum(change.became_late for change in found.ledger)
    told = f"{len(found.ledger)} decisions changed, {late} of them late now"
    yield _exact(run, "simulated time", told, ledger)
    work = tuple(work_words(change) for change in found.work)
    yield _exact(run, "work by handler", f"{len(work)} handlers changed", work)
    wall = run.wall
    if wall_blocks or (wall is not None and wall.verdict != TOO_FEW):
        told = "no wall stamps on both sides" if wall is None else wall_words(wall)
        yield Check("wall time", wall_outcome(wall), wall_blocks, told, ())


def _exact(run: RunResult, about: str, told: str, changes: tuple[str, ...]) -> Check:
    outcome = INCONCLUSIVE if run.reasons else FAILED if changes else GOOD
    if run.reasons:
        return Check(about, outcome, True, "no verdict", ())
    return Check(about, outcome, True, told if changes else "same", changes)


def wall_words(wall: WallComparison) -> str:
    """A comparison of wall time in words."""
    runs = f"{len(wall.base_s)} against {len(wall.new_s)} runs"
    if wall.ratio is None or wall.p is None:
        return f"{wall.verdict}: {runs}, expected at least {LEAST_RUNS} each"
    return f"{wall.verdict}: {100.0 * (wall.ratio - 1.0):+.1f} %, p = {wall.p:.4f}, {runs}"


def text_lines(found: Regression) -> Iterator[str]:
    """The report, a line at a time."""
    for run in found.runs:
        yield f"{run.identity}: {run.outcome}"
        yield from (f"  {reason}" for reason in run.reasons)
        if run.cause:
            yield f"  cause: {run.cause}"
        if run.note:
            yield f"  same decisions, same work, yet: {run.note}"
        for check in checks(run, wall_blocks=found.wall_blocks):
            yield f"  {_mark(check):14}{check.about}: {check.summary}"
            yield from (f"                {change}" for change in check.changes[:SHOWN])
            if len(check.changes) > SHOWN:
                yield f"                and {len(check.changes) - SHOWN} more"
    yield from (f"no verdict on {missing}" for missing in found.missing)


def _mark(check: Check) -> str:
    return check.outcome if check.blocks or check.outcome == GOOD else f"({check.outcome})"


def to_json(found: Regression) -> dict[str, Any]:
    """The report as plain values."""
    return {
        "outcome": found.outcome,
        "missing": list(found.missing),
        "runs": [_run_json(run, found.wall_blocks) for run in found.runs],
    }


def _run_json(run: RunResult, wall_blocks: bool) -> dict[str, Any]:
    of, wall = run.identity, run.wall
    return {
        "scenario": of.scenario,
        "seed": of.seed,
        "profile": of.profile,
        "outcome": run.outcome,
        "cause": run.cause,
        "note": run.note,
        "reasons": list(run.reasons),
        "checks": [
            {
                "about": check.about,
                "outcome": check.outcome,
                "blocks": check.blocks,
                "summary": check.summary,
                "changes": list(check.changes),
            }
            for check in checks(run, wall_blocks=wall_blocks)
        ],
        "wall": None
        if wall is None
        else {
            "verdict": wall.verdict,
            "ratio": wall.ratio,
            "p": wall.p,
            "base_s": list(wall.base_s),
            "new_s": list(wall.new_s),
        },
    }


def junit(found: Regression) -> bytes:
    """The report as JUnit XML: a case for each check of each run; advice never fails."""
    suite = ElementTree.Element("testsuite", name="waywiser regress")
    counts = {FAILED: 0, INCONCLUSIVE: 0, GOOD: 0}
    for run in found.runs:
        for check in checks(run, wall_blocks=found.wall_blocks):
            case = _case(suite, str(run.identity), check.about)
            outcome = check.outcome if check.blocks else GOOD
            counts[outcome] += 1
            _say(case, run, check, outcome)
    for missing in found.missing:
        counts[INCONCLUSIVE] += 1
        case = _case(suite, missing, "both sides have the run")
        ElementTree.SubElement(case, "error", message=f"no verdict: {missing}")
    suite.set("tests", str(sum(counts.values())))
    suite.set("failures", str(counts[FAILED]))
    suite.set("errors", str(counts[INCONCLUSIVE]))
    ElementTree.indent(suite)
    text: bytes = ElementTree.tostring(suite, encoding="utf-8", xml_declaration=True)
    return text


def _case(suite: ElementTree.Element, run: str, about: str) -> ElementTree.Element:
    return ElementTree.SubElement(suite, "testcase", classname=run, name=about)


def _say(case: ElementTree.Element, run: RunResult, check: Check, outcome: str) -> None:
    if outcome == FAILED:
        found = ElementTree.SubElement(case, "failure", message=run.cause or check.summary)
        found.text = "\n".join((check.summary, *check.changes))
    elif outcome == INCONCLUSIVE:
        why = "; ".join(run.reasons) or check.summary
        ElementTree.SubElement(case, "error", message=f"no verdict: {why}")
    else:
        ElementTree.SubElement(case, "system-out").text = "\n".join((check.summary, run.note))
