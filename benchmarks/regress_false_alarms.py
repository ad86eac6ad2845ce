"""How often a test of a regression calls a change where there is none, on this machine.

Runs of one and the same installation, base and new in turn, a process each; a comparison is as
many rounds as ``waywiser regress --measure`` makes. Beside the three checks of regress stand the
tests that one would otherwise use, on the very same runs: on the pooled wall times of the most
frequent handler (the reactor's belief/ranges).
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.stats import mannwhitneyu

from bus.messages import WallSpan
from logs.reader import read_run
from logs.wall import wall_path
from scenarios.rounds import Measure
from scenarios.self_test import AlarmRate, alarm_rate, self_test

ROUNDS, MOST_ROUNDS = 8, 24
HANDLER = ("reactor", "belief/ranges")


class Otherwise:
    """The tests that one would otherwise use, comparison by comparison."""

    def __init__(self) -> None:
        self.alarms: dict[str, list[bool]] = {
            "pooled samples, Mann-Whitney p < 0.05": [],
            "pooled samples, Mann-Whitney p < 0.01": [],
            "99th percentile over 20 % worse": [],
            "median over 10 % worse": [],
        }

    def look(self, base: list[Path], new: list[Path]) -> None:
        """Judge one comparison."""
        old, now = pooled(base), pooled(new)
        p = float(mannwhitneyu(old, now).pvalue)
        verdicts = (
            p < 0.05,
            p < 0.01,
            float(np.quantile(now, 0.99)) > 1.2 * float(np.quantile(old, 0.99)),
            float(np.median(now)) > 1.1 * float(np.median(old)),
        )
        for alarms, verdict in zip(self.alarms.values(), verdicts, strict=True):
            alarms.append(verdict)


def pooled(logs: list[Path]) -> NDArray[np.float64]:
    """What the handler took, in all runs, in ns."""
    took_ns: list[int] = []
    for log in logs:
        with read_run(wall_path(log), ("wall/span",)) as reader:
            spans = [sent.message for sent in reader]
        took_ns += [
            s.took_ns for s in spans if isinstance(s, WallSpan) and (s.process, s.topic) == HANDLER
        ]
    return np.array(took_ns, dtype=np.float64)


def show(rate: AlarmRate) -> None:
    print(
        f"| {rate.about} | {rate.alarms} of {rate.comparisons} | {100 * rate.rate:.1f} % "
        f"({100 * rate.low:.1f} - {100 * rate.high:.1f} %) |"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--comparisons", type=int, default=13, help="each of 8 rounds or more")
    parser.add_argument("--scenario", default="aces")
    parser.add_argument("--until", type=float, default=400.0, help="simulated seconds of a run")
    arguments = parser.parse_args()
    measure = Measure(
        arguments.scenario, (f"world.until_s={arguments.until:g}",), ROUNDS, MOST_ROUNDS
    )
    otherwise = Otherwise()
    with tempfile.TemporaryDirectory(prefix="waywiser-alarms-") as folder:
        found = self_test(
            measure,
            arguments.comparisons,
            Path(folder),
            lambda text: print(text, file=sys.stderr, flush=True),
            otherwise.look,
        )
    print("| check | false alarms | rate (95 % interval) |\n| --- | --- | --- |")
    for rate in found.rates:
        show(rate)
    for about, alarms in otherwise.alarms.items():
        show(alarm_rate(about, alarms))
    ratios = sorted(one.ratio for one in found.wall if one.ratio is not None)
    print(f"wall time of new over base: {ratios[0]:.3f} - {ratios[-1]:.3f}")


if __name__ == "__main__":
    main()
