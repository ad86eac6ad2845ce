"""The regress command: two sides' runs held against each other, or this machine against itself."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

from rich.console import Console

from logs.reader import LogReadError
from logs.regress import regression
from logs.regress.baseline import BaselineError, write_baseline
from logs.regress.matching import MismatchError, read_side
from logs.regress.regression import Regression, regress
from logs.regress.report import junit, text_lines, to_json
from scenarios.commands import BAD_INPUT, FAILED, GOOD, INCONCLUSIVE
from scenarios.rounds import BASE, NEW, Measure, RoundError, installation, run_rounds
from scenarios.say import refuse
from scenarios.self_test import SelfTest, self_test

_STATUS = {
    regression.GOOD: GOOD,
    regression.FAILED: FAILED,
    regression.INCONCLUSIVE: INCONCLUSIVE,
}
SHORT = ("world.until_s=400",)
"""What the self-test runs where nothing else is asked for: the first corridors of aces."""


class ArgumentError(ValueError):
    """Arguments that do not go together: which, and what was expected."""


@dataclass(frozen=True)
class Asked:
    """The command's arguments."""

    sides: tuple[Path, ...]
    tolerance: float
    wall: bool
    measure: str | None
    changes: tuple[str, ...]
    rounds: int
    most_rounds: int
    self_test: bool
    comparisons: int
    junit: Path | None
    write_baseline: Path | None
    as_json: bool


def regress_command(asked: Asked) -> int:
    """Carry out ``waywiser regress``; returns the exit status."""
    try:
        with tempfile.TemporaryDirectory(prefix="waywiser-regress-") as scratch:
            return _carry_out(asked, Path(scratch))
    except (ArgumentError, LogReadError, BaselineError, MismatchError) as error:
        return refuse(error, BAD_INPUT, as_json=asked.as_json)
    except RoundError as error:
        return refuse(error, BAD_INPUT, as_json=asked.as_json)
    except OSError as error:
        return refuse(error, BAD_INPUT, as_json=asked.as_json)
    except KeyboardInterrupt:
        return refuse("ended before its time, as asked", INCONCLUSIVE, as_json=asked.as_json)


def _carry_out(asked: Asked, scratch: Path) -> int:
    if asked.self_test:
        return _self_test(asked, scratch)
    if asked.write_baseline is not None:
        return _write_baseline(asked)
    if len(asked.sides) != 2:
        raise ArgumentError(f"found {len(asked.sides)} of BASE and NEW, expected both")
    base, new = asked.sides
    if asked.measure is not None:
        sides = installation(base, scratch), installation(new, scratch)
        run_rounds(sides, _measure(asked, asked.measure), scratch, _show(asked))
        base, new = scratch / BASE, scratch / NEW
    return _conclude(
        asked, regress(read_side(base), read_side(new), asked.tolerance, wall=asked.wall)
    )


def _measure(asked: Asked, scenario: str) -> Measure:
    return Measure(scenario, asked.changes, asked.rounds, max(asked.rounds, asked.most_rounds))


def _show(asked: Asked) -> Callable[[str], None]:
    console = Console(stderr=True, quiet=asked.as_json, highlight=False)
    if not console.is_terminal:
        return lambda text: console.print(text, soft_wrap=True)
    return lambda text: console.print(f"\r{text:<70}", end="", soft_wrap=True)


def _conclude(asked: Asked, found: Regression) -> int:
    status = _STATUS[found.outcome]
    if asked.junit is not None:
        asked.junit.write_bytes(junit(found))
    if asked.as_json:
        print(json.dumps({"status": status, **to_json(found)}))
    else:
        console = Console(highlight=False, soft_wrap=True, markup=False)
        for line in text_lines(found):
            console.print(line)
    return status


def _write_baseline(asked: Asked) -> int:
    """The one side given becomes a baseline. Runs without a verdict are not written."""
    if len(asked.sides) != 1 or asked.write_baseline is None:
        raise ArgumentError(f"--write-baseline: found {len(asked.sides)} sides, expected one")
    runs = read_side(asked.sides[0])
    for run in runs:
        if run.reasons:
            return refuse(f"{run.where}: {run.reasons[0]}", INCONCLUSIVE, as_json=asked.as_json)
    once = {run.identity: run for run in runs}
    write_baseline(asked.write_baseline, once.values())
    facts = {"status": GOOD, "baseline": str(asked.write_baseline), "runs": len(once)}
    print(json.dumps(facts) if asked.as_json else f"{len(once)} runs: {asked.write_baseline}")
    return GOOD


def _self_test(asked: Asked, scratch: Path) -> int:
    if asked.sides:
        raise ArgumentError("--self-test: found BASE beside it, expected neither BASE nor NEW")
    changes = asked.changes if asked.measure or asked.changes else SHORT
    measure = Measure(
        asked.measure or "aces", changes, asked.rounds, max(asked.rounds, asked.most_rounds)
    )
    found = self_test(measure, asked.comparisons, scratch, _show(asked))
    sound = not any(rate.alarms for rate in found.rates[:2])
    status = GOOD if sound else FAILED
    if asked.as_json:
        print(json.dumps({"status": status, **asdict(found)}))
    else:
        _say_self_test(found, measure)
    return status


def _say_self_test(found: SelfTest, measure: Measure) -> None:
    console = Console(highlight=False, soft_wrap=True, markup=False)
    what = " ".join((measure.scenario, *measure.changes))
    console.print(f"\nbase against base, {what}: false alarms on this machine, 95 % interval")
    for rate in found.rates:
        console.print(
            f"  {rate.about:17}{rate.alarms} of {rate.comparisons} "
            f"({100 * rate.rate:.1f} %, {100 * rate.low:.1f} - {100 * rate.high:.1f} %)"
        )
    ratios = sorted(one.ratio for one in found.wall if one.ratio is not None)
    if ratios:
        console.print(f"  wall time of new over base: {ratios[0]:.3f} - {ratios[-1]:.3f}")
