"""Whole runs of the robot among the echoes of real buildings: whether it learns the true map.

    python -m benchmarks.floor_plans [--maps NAME...] [--robots reacts-to-nothing reacts]
        [--seeds A:B] [--errands N] [--folder DIR]

Surveys each floor plan as ``waywiser map`` does, makes the scenario of it, and runs that with the
plan's own echoes: once with a robot that reacts to nothing, which shows the perception, once with
its reactor among the things that stand about in the building. Nobody walks there. Everything is
simulated time, so the numbers repeat on any machine.
"""

from __future__ import annotations

import argparse
import json
import tomllib
from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from bus.grid import Grid
from bus.messages import LedgerEntry, MapBelief, Reading, RunEnded, TrueBuilding, TrueErrand
from bus.turns import Module
from scenarios.modules import build_module
from scenarios.scenario import check
from scenarios.survey_words import scenario_text
from simworld.floor_plan import read_floor_plan
from simworld.settings import Place
from simworld.survey import survey
from tests.scenarios.outcomes import probability_of_truth, unmoved
from tests.scenarios.runs import everything_said, of_kind

FOLDER = Path("../shared/maps")
MAPS = {"aces": "aces/aces.yaml", "k-wing": "k-wing/k-wing.yaml"}
PATIENCE_S = 60_000
"""A run ends after so long, if the robot has not done its errands before."""


@dataclass(frozen=True)
class Day:
    """How one run ended.

    ``wrong`` are the corridors, by their ends, that the most probable map has and the building
    has not, or the other way round.
    """

    reason: str
    errands: int
    true_map: float
    wrong: tuple[tuple[Place, Place], ...]
    readings: int
    junctions: int
    late: int
    simulated_s: float


def day(text: str, errands: int, build: Callable[..., Module], seed: int) -> Day:
    """Run a surveyed scenario with one seed."""
    table = tomllib.loads(text)
    table["seed"] = seed
    table["random_errands"]["count"] = errands
    table["world"]["until_s"] = PATIENCE_S
    said = everything_said(check(table, "a surveyed plan"), build)
    belief, (building,) = of_kind(said, MapBelief)[-1], of_kind(said, TrueBuilding)
    true_map = probability_of_truth(belief, building)
    grid = Grid(len(table["world"]["columns_m"]), len(table["world"]["rows_m"]))
    differs = belief.maps[belief.log_probability.argmax()] != building.corridors
    ends = [grid.ends(int(corridor)) for corridor in np.flatnonzero(differs)]
    return Day(
        of_kind(said, RunEnded)[-1].reason,
        len(of_kind(said, TrueErrand)),
        true_map,
        tuple((grid.place(a), grid.place(b)) for a, b in ends),
        len(of_kind(said, Reading)),
        len({(b.x, b.y) for b in of_kind(said, MapBelief)}),
        sum(bool(entry.cause) for entry in of_kind(said, LedgerEntry)),
        said[-1].said_ns / 1e9,
    )


def surveyed(path: Path) -> str:
    """The scenario of a plan, with its echoes."""
    text = scenario_text(survey(read_floor_plan(path)), path, path)
    plan = json.dumps(str(path.resolve()))
    return text.replace("[world]\n", f"[world]\nfloor_plan = {plan}\n", 1)


def column(days: Sequence[Day], errands: int) -> list[str]:
    """One column of the table."""
    of = f"of {len(days)}"
    return [
        f"{sum(d.errands == errands for d in days)} {of}",
        f"{sum(not d.wrong for d in days)} {of}",
        f"{sum(d.true_map > 0.99 for d in days)} {of}",
        _wrong(days),
        f"{sum(d.readings for d in days) / sum(d.junctions for d in days):.2f}",
        f"{sum(d.simulated_s for d in days) / len(days):.0f}",
        f"{sum(d.late for d in days)}",
    ]


def _wrong(days: Sequence[Day]) -> str:
    """Each corridor that is wrong in some runs, and in how many."""
    counted = Counter(corridor for d in days for corridor in d.wrong)
    return "; ".join(f"{list(a)}-{list(b)} {n}" for (a, b), n in sorted(counted.items())) or "none"


ROBOTS = {"reacts-to-nothing": unmoved, "reacts": build_module}

ROWS = (
    "all errands done",
    "true map most probable at the end",
    "true map above 0.99 at the end",
    "corridors wrong in the most probable map: runs",
    "sensing actions a junction",
    "simulated seconds, mean",
    "decisions late",
)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--maps", nargs="+", choices=sorted(MAPS), default=list(MAPS))
    parser.add_argument("--seeds", default="1:20", help="first and last, inclusive")
    parser.add_argument("--robots", nargs="+", choices=list(ROBOTS), default=list(ROBOTS))
    parser.add_argument("--errands", type=int, default=20, help="errands of a run")
    parser.add_argument("--folder", type=Path, default=FOLDER, help="where the maps are")
    given = parser.parse_args()
    first, last = (int(text) for text in given.seeds.split(":"))
    table = Table(title=f"seeds {first} to {last}, {given.errands} errands each")
    table.add_column("")
    columns: list[Sequence[str]] = [ROWS]
    with ProcessPoolExecutor() as pool:
        for name in given.maps:
            text = surveyed(given.folder / MAPS[name])
            for how in given.robots:
                table.add_column(f"{name}, {how}")
                run = partial(day, text, given.errands, ROBOTS[how])
                columns.append(column(list(pool.map(run, range(first, last + 1))), given.errands))
    for row in zip(*columns, strict=True):
        table.add_row(*row)
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
