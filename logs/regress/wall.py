"""Wall time: one number a run, an exact test of whole runs, and a floor under the effect.

Samples of one run are not independent: pooled, identical programs differ at p < 0.05 most of
the time. A run therefore counts as one number, and two sides are compared by the exact
Mann-Whitney test (H. B. Mann and D. R. Whitney, Annals of Mathematical Statistics 18, 1947).
A side is worse where p is below 0.01 *and* it is at least a tenth slower.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bus.messages import WallSpan
from logs.reader import read_run
from logs.wall import wall_path

LEAST_RUNS = 8
"""Runs a side: with fewer, p cannot fall far enough below the level to be believed."""

LEVEL, UNCLEAR = 0.01, 0.1
EFFECT = 0.10

SAME, FASTER, SLOWER, CANNOT_SAY, TOO_FEW = (
    "no slower",
    "faster",
    "slower",
    "unclear: more runs are needed",
    "too few runs",
)


@dataclass(frozen=True)
class WallComparison:
    """The wall time of two sides' runs, each its typical work in seconds.

    ``ratio`` is the new median over the base's, ``p`` that of the exact two-sided test; both
    are None where there are too few runs.
    """

    base_s: tuple[float, ...]
    new_s: tuple[float, ...]
    ratio: float | None
    p: float | None
    verdict: str


def typical_work_s(log: Path) -> float | None:
    """A run's one number: for each handler its median wall time as often as it ran, added up.

    Medians, since a first call compiles and the machine interrupts; times their number, since a
    rare but long handler matters too. None where there are no wall stamps beside the log.
    Raises LogReadError.
    """
    path = wall_path(log)
    if not path.is_file():
        return None
    took_ns: dict[tuple[str, str], list[int]] = {}
    with read_run(path, ("wall/span",)) as reader:
        for sent in reader:
            if isinstance(sent.message, WallSpan):
                span = sent.message
                took_ns.setdefault((span.process, span.topic), []).append(span.took_ns)
    if reader.truncated or not took_ns:
        return None
    return sum(len(each) * float(np.median(each)) for each in took_ns.values()) / 1e9


def compare_wall(
    base_s: Sequence[float], new_s: Sequence[float], level: float = LEVEL
) -> WallComparison:
    """Hold two sides' runs against each other; one number a run, in seconds."""
    base, new = tuple(base_s), tuple(new_s)
    if min(len(base), len(new)) < LEAST_RUNS:
        return WallComparison(base, new, None, None, TOO_FEW)
    from scipy.stats import mannwhitneyu  # here, since it takes a second

    ratio = float(np.median(new) / np.median(base))
    p = float(mannwhitneyu(base, new, alternative="two-sided", method="exact").pvalue)
    return WallComparison(base, new, ratio, p, _verdict(ratio, p, level))


def _verdict(ratio: float, p: float, level: float) -> str:
    if 1.0 / (1.0 + EFFECT) < ratio < 1.0 + EFFECT or p >= UNCLEAR:
        return SAME
    if p >= level:
        return CANNOT_SAY
    return SLOWER if ratio > 1.0 else FASTER
