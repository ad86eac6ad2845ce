"""Base against base: how often each check calls a change where there is none, on this machine."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from logs.binomial import interval
from logs.regress.compare import compare
from logs.regress.matching import logs_in
from logs.regress.summary import summarise
from logs.regress.wall import SLOWER, WallComparison, compare_wall, typical_work_s
from scenarios.rounds import BASE, NEW, Measure, run_rounds, this_installation

CONFIDENCE = 0.95


@dataclass(frozen=True)
class AlarmRate:
    """False alarms of one check: ``low`` and ``high`` are the Clopper-Pearson interval at 95 %."""

    about: str
    comparisons: int
    alarms: int
    rate: float
    low: float
    high: float


@dataclass(frozen=True)
class SelfTest:
    """The rates of the three checks, and the wall comparisons that one of them is made of."""

    rates: tuple[AlarmRate, ...]
    wall: tuple[WallComparison, ...]


def alarm_rate(about: str, alarms: list[bool]) -> AlarmRate:
    """The rate of alarms among comparisons in which nothing had changed."""
    number, of = sum(alarms), len(alarms)
    low, high = interval(number, of, CONFIDENCE)
    return AlarmRate(about, of, number, number / of, low, high)


def self_test(
    measure: Measure,
    comparisons: int,
    folder: Path,
    show: Callable[[str], None],
    look: Callable[[list[Path], list[Path]], None] = lambda _base, _new: None,
) -> SelfTest:
    """Compare this installation with itself, so many times. Raises RoundError, LogReadError.

    ``look`` gets both sides' logs of each comparison before they are removed.
    """
    time_alarms: list[bool] = []
    work_alarms: list[bool] = []
    wall: list[WallComparison] = []
    for number in range(comparisons):
        place = folder / "rounds"
        place.mkdir()
        show(f"comparison {number + 1} of {comparisons}")
        side = this_installation(folder)
        run_rounds((side, side), measure, place, show)
        base, new = logs_in(place / BASE), logs_in(place / NEW)
        for pair in zip(base, new, strict=True):
            found = compare(summarise(pair[0]), summarise(pair[1]))
            time_alarms.append(not found.same_time)
            work_alarms.append(bool(found.work))
        wall.append(compare_wall(_typical(base), _typical(new)))
        look(base, new)
        shutil.rmtree(place)
    rates = (
        alarm_rate("simulated time", time_alarms),
        alarm_rate("work by handler", work_alarms),
        alarm_rate("wall time", [one.verdict == SLOWER for one in wall]),
    )
    return SelfTest(rates, tuple(wall))


def _typical(logs: list[Path]) -> list[float]:
    return [took_s for log in logs if (took_s := typical_work_s(log)) is not None]
