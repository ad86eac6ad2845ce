"""Methods for finding places in unknown territory: cost, information, and the choice by estimates.

    python -m benchmarks.methods [--trials N]
    python -m benchmarks.methods --train [--trials N] [--out FILE]

Worlds of 3x3 to 6x6 lines are drawn from the exact belief over all connected maps, some corridors
known; each method drives the same errand, and afterwards one later errand is driven with what was
learnt. The first form judges the shipped estimates on worlds they were not fitted on. The second
fits them. All numbers are simulated and repeat anywhere.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from benchmarks.methods_worlds import Trial, trial
from modules.decider.methods import FEATURES, METHODS, shipped_estimates

OUT = Path("modules/decider/methods/estimates.json")
HELD_OUT = 1_000_000
"""First seed of the worlds that estimates are judged on; fitting starts at 0."""

RIDGE = 1.0
"""Weight of a squared coefficient against squared errors, on standardised features."""

LATER = (0.0, 1.0, 3.0, 10.0)
TARGETS = ("corridors", "nats", "later_corridors")


def trials(first: int, count: int) -> list[Trial]:
    """The worlds of ``count`` seeds."""
    with ProcessPoolExecutor() as pool:
        return list(pool.map(trial, range(first, first + count), chunksize=32))


def of(found: Sequence[Trial], target: str) -> NDArray[np.float64]:
    """One target of every trial and method: (trials, methods)."""
    return np.array([getattr(t, target) for t in found])


def fit(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Ridge regression of y (trials,) on features (trials, features), the first of which is 1."""
    mean, spread = x[:, 1:].mean(axis=0), x[:, 1:].std(axis=0)
    z = (x[:, 1:] - mean) / np.where(spread > 0, spread, 1.0)
    slope = np.linalg.solve(z.T @ z + RIDGE * np.eye(z.shape[1]), z.T @ (y - y.mean()))
    slope = slope / np.where(spread > 0, spread, 1.0)
    return np.concatenate([[y.mean() - mean @ slope], slope])


def fitted(found: Sequence[Trial]) -> dict[str, object]:
    """The contents of the file of estimates."""
    x = np.array([t.features for t in found])
    methods = {
        method: {
            target: [float(f"{c:.6g}") for c in fit(x, of(found, target)[:, k])]
            for target in TARGETS
        }
        for k, method in enumerate(METHODS)
    }
    about = f"python -m benchmarks.methods --train --trials {len(found)}"
    return {"version": 1, "about": about, "features": list(FEATURES), "methods": methods}


def estimated(found: Sequence[Trial], target: str) -> NDArray[np.float64]:
    """The shipped estimate of one target: (trials, methods)."""
    given = shipped_estimates().methods
    coefficients = np.array([getattr(given[m], target) for m in METHODS])
    x = np.array([t.features for t in found])
    least = x[:, 1:2] if target == "corridors" else 0.0
    guess: NDArray[np.float64] = np.maximum(least, x @ coefficients.T)
    return guess


def costs(found: Sequence[Trial]) -> Table:
    """Mean cost and gain of each method, and how much of their variance the estimates explain."""
    table = Table(title=f"{len(found)} worlds: mean, share of variance explained (R2)")
    for name in ("method", "errand, corridors", "R2", "nats", "R2", "a later errand", "R2"):
        table.add_column(name)
    for k, method in enumerate(METHODS):
        row: list[str] = [method]
        for target in TARGETS:
            true, guess = of(found, target)[:, k], estimated(found, target)[:, k]
            r2 = 1 - ((true - guess) ** 2).mean() / true.var()
            row += [f"{true.mean():.2f}", f"{r2:.2f}"]
        table.add_row(*row)
    return table


def calibration(found: Sequence[Trial]) -> Table:
    """Mean estimate against mean cost, by fifths of the estimate."""
    table = Table(title="calibration: estimated / true mean corridors, by fifths of the estimate")
    table.add_column("method")
    for fifth in range(5):
        table.add_column(f"{fifth + 1}")
    for k, method in enumerate(METHODS):
        true, guess = of(found, "corridors")[:, k], estimated(found, "corridors")[:, k]
        parts = np.array_split(np.argsort(guess, kind="stable"), 5)
        table.add_row(method, *(f"{guess[p].mean():.2f} / {true[p].mean():.2f}" for p in parts))
    return table


def regrets(found: Sequence[Trial]) -> Table:
    """What one method for all, and the choice by estimates, cost more than the best in hindsight.

    Mean over the worlds, in corridors, with the standard error.
    """
    true = [of(found, t) for t in TARGETS]
    guess = [estimated(found, t) for t in TARGETS]
    table = Table(title="regret in corridors, by later errands expected")
    for name in ("always", *(f"{n:g} later" for n in LATER)):
        table.add_column(name)
    columns = []
    for later in LATER:
        total = true[0] + later * true[2]
        chosen = (guess[0] + later * guess[2]).argmin(axis=1)
        regret = total - total.min(axis=1, keepdims=True)
        taken = regret[np.arange(len(found)), chosen]
        columns.append([mean(r) for r in regret.T] + [mean(taken), shares(chosen)])
    for row in zip([*METHODS, "by estimates", "chosen, %"], *columns, strict=True):
        table.add_row(*row)
    return table


def mean(values: NDArray[np.float64]) -> str:
    """Mean and standard error."""
    return f"{values.mean():.2f} +- {values.std(ddof=1) / len(values) ** 0.5:.2f}"


def shares(chosen: NDArray[np.int64]) -> str:
    """How often each method was chosen, in percent, in the order of METHODS."""
    counts = np.bincount(chosen, minlength=len(METHODS))
    return " ".join(f"{100 * c / len(chosen):.0f}" for c in counts)


def main() -> None:
    """Fit or judge."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--trials", type=int, default=None, help="6000 to fit, 3000 to judge")
    parser.add_argument("--train", action="store_true")
    parser.add_argument("--out", type=Path, default=OUT)
    given = parser.parse_args()
    if given.train:
        text = msgspec.json.encode(fitted(trials(0, given.trials or 6000)))
        given.out.write_bytes(msgspec.json.format(text, indent=1) + b"\n")
        return
    found = trials(HELD_OUT, given.trials or 3000)
    console = Console(width=110)
    for table in (costs(found), calibration(found), regrets(found)):
        console.print(table)


if __name__ == "__main__":
    main()
