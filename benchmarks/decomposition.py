"""What it costs to split the whole decision problem among modules (paper, section 5).

    python -m benchmarks.decomposition [--worlds N]

On worlds small enough to solve the joint problem exactly, by dynamic programming over all that can
be known: its least expected time, and the exact expected time where some of the decisions are made
by a module's own rule, each under the independence that it assumes. What no rule decides is done at
best. Lengths of corridors are random, 120 to 360 s; numbers repeat on any machine.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from benchmarks.joint_problem import JointProblem, Rules
from benchmarks.modules_rules import ClassifierRule, DeciderRule, stand_aside_unless_long
from benchmarks.tiny_world import Detector, Encounter, TinyWorld
from bus.grid import Grid

TEST_S = 45.0
WORLDS = ("2x2, two tests", "3x2, two tests", "3x2, sees all")

ROWS = (
    "every module by itself",
    "stop rule: a wrong type at 100 000 s",
    "stop rule: a wrong type at 1000 s",
    "stop rule: a wrong type at 300 s",
    "stop rule: 300 s, independent corridors",
    "stop rule: what the decider says",
    "ways: one exploratory step",
    "ways: no future errands",
    "ways: ten times the future errands",
    "ways: independent corridors",
    "reactions by themselves",
    "all, a wrong type at 300 s",
    "all, a wrong type at what the decider says",
)


def rules(row: str) -> Rules:
    """The decisions that one row of the table takes out of the joint problem."""
    react = stand_aside_unless_long
    return {
        ROWS[0]: Rules(ClassifierRule(), DeciderRule(), react),
        ROWS[1]: Rules(sensing=ClassifierRule()),
        ROWS[2]: Rules(sensing=ClassifierRule(1000.0)),
        ROWS[3]: Rules(sensing=ClassifierRule(300.0)),
        ROWS[4]: Rules(sensing=ClassifierRule(300.0, independent=True)),
        ROWS[5]: Rules(sensing=ClassifierRule(heeds_stakes=True)),
        ROWS[6]: Rules(leaving=DeciderRule()),
        ROWS[7]: Rules(leaving=DeciderRule(futures=0.0)),
        ROWS[8]: Rules(leaving=DeciderRule(futures=10.0)),
        ROWS[9]: Rules(leaving=DeciderRule(independent=True)),
        ROWS[10]: Rules(reacting=react),
        ROWS[11]: Rules(ClassifierRule(300.0), DeciderRule(), react),
        ROWS[12]: Rules(ClassifierRule(heeds_stakes=True), DeciderRule(), react),
    }[row]


def world(kind: str, seed: int) -> TinyWorld:
    """A world of one kind with random corridors; people are met where there are few states."""
    rng = np.random.default_rng([6, seed])
    grid = Grid(2, 2) if kind == WORLDS[0] else Grid(3, 2)
    corridor_s = rng.uniform(120.0, 360.0, grid.corridors)
    last = grid.intersections - 1
    people = Encounter(0.2, (10.0, 300.0))
    if kind == WORLDS[0]:
        tests = tuple(Detector(0, d, TEST_S) for d in (0, 1))
        return TinyWorld(grid, corridor_s, 0, (last, 0, last), tests, encounter=people)
    if kind == WORLDS[1]:
        tests = tuple(Detector(1, d, TEST_S) for d in (0, 1))
        return TinyWorld(grid, corridor_s, 1, (last, 0), tests)
    return TinyWorld(grid, corridor_s, 1, (last, 0, last), encounter=people)


def losses(kind: str, seed: int) -> list[float]:
    """The joint problem's cost, then what each row costs more, in seconds."""
    here = world(kind, seed)
    best = JointProblem(here).cost_s()
    return [best] + [JointProblem(here, rules(row)).cost_s() - best for row in ROWS]


def cell(loss: NDArray[np.float64], best: NDArray[np.float64]) -> str:
    """Mean loss in seconds, its share, and the most in any world."""
    return f"{loss.mean():.1f} ({100 * loss.mean() / best.mean():.1f} %), most {loss.max():.0f}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--worlds", type=int, default=4, help="of each kind (default 4)")
    given = parser.parse_args()
    columns = []
    with ProcessPoolExecutor() as pool:
        for kind in WORLDS:
            found = np.array(list(pool.map(partial(losses, kind), range(given.worlds))))
            cells = [cell(loss, found[:, 0]) for loss in found[:, 1:].T]
            columns.append([f"{found[:, 0].mean():.0f} s", *cells])
    table = Table(title=f"{given.worlds} worlds each: mean loss against the joint problem, s")
    for name in ("decided by rule", *WORLDS):
        table.add_column(name)
    for row in zip(["nothing: the joint problem", *ROWS], *columns, strict=True):
        table.add_row(*row)
    Console(width=130).print(table)


if __name__ == "__main__":
    main()
