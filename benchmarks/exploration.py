"""What exploring costs and brings: errand times against the shortest possible, over many seeds.

    python -m benchmarks.exploration [--scenario NAME] [--seeds A:B] [--plan MAP.yaml]

Runs a scenario with each seed by a robot as shipped, which plans for least expected cost and whose
classifier is told what a wrong type costs; by one whose classifier takes a flat price; by the
paper's model; and by a robot of that model that sees no value in knowing the building later
(``[modules.decider] explores = false``; it still tries a shorter way that may exist). On ``aces``,
with its floor plan, also by one that hears the echoes of the real building, where nobody walks and
it reacts to nothing that stands about.
Everything is simulated time, so the numbers repeat on any machine.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from bus.messages import (
    LedgerEntry,
    MapBelief,
    PathDecision,
    Reading,
    TrueBuilding,
    TrueErrand,
)
from bus.turns import Module
from scenarios.draw import draw
from scenarios.modules import build_module
from tests.scenarios.outcomes import probability_of_truth, unmoved
from tests.scenarios.runs import everything_said, of_kind, shipped

PLAN = Path("../shared/maps/aces/aces.yaml")


@dataclass(frozen=True)
class Trip:
    """One run: seconds of each errand done, and of its shortest way; what was sensed."""

    seconds: tuple[float, ...]
    shortest_s: tuple[float, ...]
    readings: int
    junctions: int
    visits: int
    explored: int
    true_map: float
    late: int

    @property
    def ratio(self) -> float:
        """All errands' time over that of their shortest ways."""
        return sum(self.seconds) / sum(self.shortest_s) if self.seconds else float("nan")


@dataclass(frozen=True)
class Variant:
    """A way to run the scenario."""

    name: str
    changes: tuple[str, ...]
    build: Callable[..., Module] = build_module


def trip(scenario: str, variant: Variant, seed: int) -> Trip:
    """Run a scenario and sum up what was said."""
    said = everything_said(shipped(scenario, *variant.changes, seed=seed).scenario, variant.build)
    errands, decided = of_kind(said, TrueErrand), of_kind(said, PathDecision)
    beliefs, (building,) = of_kind(said, MapBelief), of_kind(said, TrueBuilding)
    readings = len(of_kind(said, Reading))
    return Trip(
        tuple((e.ended_ns - e.began_ns) / 1e9 for e in errands),
        tuple(e.shortest_s for e in errands),
        readings,
        len({(b.x, b.y) for b in beliefs}),
        len(decided),
        _explored(decided, beliefs),
        probability_of_truth(beliefs[-1], building),
        sum(bool(entry.cause) for entry in of_kind(said, LedgerEntry)),
    )


def _explored(decided: Sequence[PathDecision], beliefs: Sequence[MapBelief]) -> int:
    """How often P_U was chosen for the type that was the most probable in the end."""
    last = beliefs[-1].junctions
    at = {b.visit: last[b.y, b.x].argmax() for b in beliefs}
    return sum(bool(d.explores[at[d.visit]]) for d in decided if d.visit in at)


def variants(scenario: str, plan: Path) -> list[Variant]:
    """The ways to run, the last only where the floor plan is at hand."""
    paper, hopeful = "modules.decider.model=paper", "modules.decider.explores=false"
    ways = [
        Variant("as shipped", ()),
        Variant("a wrong type at 100,000 s", ("modules.classifier.heeds_stakes=false",)),
        Variant("paper, explores", (paper,)),
        Variant("paper, explores = false", (paper, hopeful)),
    ]
    if scenario == "aces" and plan.is_file():
        real = (f"world.floor_plan={plan.resolve()}", "world.person=[]", "world.until_s=20000")
        ways.append(Variant("as shipped, real echoes", real, unmoved))
    return ways


def mean(values: Iterable[float]) -> str:
    """Mean and range."""
    array = np.array(list(values))
    return f"{array.mean():.2f} ({array.min():.2f} - {array.max():.2f})"


def summary(variant: Variant, trips: Sequence[Trip], errands: int) -> list[str]:
    """One column of the table."""
    whole = [t for t in trips if len(t.seconds) == errands]
    each = [mean(t.seconds[k] / t.shortest_s[k] for t in whole) for k in range(errands)]
    return [
        variant.name,
        f"{len(whole)} of {len(trips)}",
        mean(sum(t.seconds) for t in whole),
        mean(sum(t.shortest_s) for t in whole),
        mean(t.ratio for t in whole),
        *each,
        mean(t.readings for t in trips),
        mean(t.readings / t.junctions for t in trips),
        mean(t.readings / t.visits for t in trips),
        mean(t.explored for t in trips),
        f"{sum(t.true_map > 0.99 for t in trips)} of {len(trips)}",
        f"{sum(t.late for t in trips)}",
    ]


def rows(errands: int) -> list[str]:
    """What the rows of the table are."""
    return [
        "",
        "runs with all errands done",
        "time for all errands, s",
        "their shortest ways, s",
        "ratio",
        *(f"ratio of errand {k + 1}" for k in range(errands)),
        "sensing actions",
        "sensing actions a junction",
        "sensing actions a visit",
        "exploratory steps decided",
        "true map above 0.99 at the end",
        "decisions late",
    ]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scenario", default="aces")
    parser.add_argument("--seeds", default="1:20", help="first and last, inclusive")
    parser.add_argument("--plan", type=Path, default=PLAN)
    given = parser.parse_args()
    first, last = (int(text) for text in given.seeds.split(":"))
    seeds = range(first, last + 1)
    drawn = draw(shipped(given.scenario, seed=first).scenario, given.scenario)
    errands = len(drawn.plan.errands)
    columns = [rows(errands)]
    with ProcessPoolExecutor() as pool:
        for variant in variants(given.scenario, given.plan):
            trips = list(pool.map(partial(trip, given.scenario, variant), seeds))
            columns.append(summary(variant, trips, errands))
    table = Table(title=f"{given.scenario}, seeds {first} to {last}: mean (least - most)")
    for column in columns:
        table.add_column(column[0])
    for row in zip(*(column[1:] for column in columns), strict=True):
        table.add_row(*row)
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
