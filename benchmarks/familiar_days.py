"""Whole runs of a robot that has lost its place: decide to look, never look, or always look.

    python -m benchmarks.familiar_days [--days N] [--settings NAME ...]

Each day is a run of the scenario ``familiar-place`` through all modules: the true place is drawn
from what the robot thinks of it beforehand, the building from the exact belief over all connected
maps given what it recalls, and a day counts where a robot can begin it (the corridor behind it and
the errand's end are there). Three robots live the same days. The cost of a day is the errand's time
and the price of its lateness. First, a table of what the first decision is by the time that the
errand has. Everything is simulated time, so the numbers repeat on any machine.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial

import numpy as np
from msgspec.structs import replace
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from benchmarks.days import Progress
from bus.facts import Recall
from bus.grid import EAST, OPPOSITE, SOUTH, WEST, Grid
from bus.messages import PathDecision, RegistrationDecision, TrueErrand
from modules.geographer import ConnectedMaps
from modules.geographer.record import recalled
from scenarios.ground import draw_ground, generator
from scenarios.scenario import Scenario, find, load
from simworld.settings import Start
from tests.scenarios.runs import everything_said, of_kind

NAME = "familiar-place"
RULES = ("least expected cost", "act", "look")
SEED = 7

SETTINGS = {
    "no hurry": (1900.0, 0.0),
    "time for a look, not for a mistake": (1900.0, 10.0),
    "no time for a look": (1100.0, 10.0),
}
"""When the errand is due after the run's beginning, in seconds, and what a late second costs."""

DUE_S = (None, 800.0, 1100.0, 1300.0, 1500.0, 1700.0, 1900.0, 2300.0, 2700.0, 3100.0)
ALIKE = EAST | SOUTH | WEST
"""The type of the junctions that look alike."""


@dataclass(frozen=True, eq=False)
class Truth:
    """Where the robot truly begins a day, and in which building."""

    place: int
    corridors: NDArray[np.uint8]


@dataclass(frozen=True)
class Outcome:
    """What a day cost, whether it began with a look, and whether the errand was done."""

    cost_s: float
    time_s: float
    looked: bool
    done: bool


def truths(scenario: Scenario, days: int) -> Iterator[Truth]:
    """So many days, drawn as the robot would draw them."""
    ground = draw_ground(scenario, generator(scenario))
    grid, facts = ground.building.grid, ground.facts
    assert isinstance(facts.recall, Recall)
    record = recalled(grid, facts.recall.places)
    belief = ConnectedMaps(grid.columns, grid.rows).posterior(record.junctions)
    places = [one.place for one in facts.recall.may_be_at]
    chances = [one.probability for one in facts.recall.may_be_at]
    goal = grid.intersection(*scenario.errand[0].goal)
    rng, found = np.random.default_rng(SEED), 0
    while found < days:
        place = int(rng.choice(places, p=chances))
        corridors = belief.sample(1, rng)[0]
        behind = grid.corridor(*grid.place(place), OPPOSITE[facts.heading])
        if corridors[behind] and grid.junction_types(corridors[None])[0, goal]:
            found += 1
            yield Truth(place, corridors)


def there(scenario: Scenario, truth: Truth) -> Scenario:
    """The scenario with another truth; what the robot knows stays."""
    columns, rows = len(scenario.world.columns_m), len(scenario.world.rows_m)
    grid = Grid(columns, rows)
    pairs = tuple(
        (grid.place(a), grid.place(b))
        for a, b in (grid.ends(int(c)) for c in np.flatnonzero(truth.corridors))
    )
    assert isinstance(scenario.world.start, Start)
    start = replace(scenario.world.start, junction=grid.place(truth.place))
    # nobody walks here: pings while driving serve nothing but the length of the log
    world = replace(scenario.world, corridors=pairs, start=start, ping_period_s=30.0)
    return replace(scenario, world=world)


def day(scenario: Scenario, case: tuple[str, str, Truth]) -> Outcome:
    """Live one day in a setting by a rule."""
    setting, rule, truth = case
    due_s, late_price = SETTINGS[setting]
    errand = replace(scenario.errand[0], due_s=due_s, late_price=late_price)
    decider = {**scenario.modules.get("decider", {}), "unsure": rule}
    lived = replace(there(scenario, truth), errand=(errand,), modules={"decider": decider})
    said = everything_said(lived)
    done = of_kind(said, TrueErrand)
    time_s = done[0].ended_ns / 1e9 if done else lived.world.until_s
    here = Grid(len(lived.world.columns_m), len(lived.world.rows_m))
    junction_type = here.junction_types(truth.corridors[None])[0, truth.place]
    looked = bool(of_kind(said, PathDecision)[0].explores[junction_type])
    return Outcome(time_s + late_price * max(0.0, time_s - due_s), time_s, looked, bool(done))


def crossover(scenario: Scenario) -> Table:
    """The first decision, for the junction that looks alike, by when the errand is due."""
    title = f"{scenario.errand[0].late_price:g} s a late second: the first decision"
    table = Table("due after, s", "act at once, s", "look first, s", "looks", title=title)
    for due_s in DUE_S:
        errand = replace(scenario.errand[0], due_s=due_s)
        brief = replace(scenario.world, until_s=1.0)
        said = everything_said(replace(scenario, errand=(errand,), world=brief))
        (found,) = of_kind(said, RegistrationDecision)
        costs = (f"{of[ALIKE]:,.0f}" for of in (found.now_s, found.look_s))
        due = "never" if due_s is None else f"{due_s:,.0f}"
        table.add_row(due, *costs, "yes" if found.detour[ALIKE] else "no")
    return table


def interval(values: NDArray[np.float64]) -> str:
    """Mean with its 95 % interval."""
    half = 1.96 * float(values.std(ddof=1)) / np.sqrt(len(values))
    return f"{values.mean():,.0f} +- {half:,.0f}"


def rows(setting: str, by_rule: dict[str, list[Outcome]]) -> Iterator[list[str]]:
    """A row a rule: what its days cost, and how much more than those of the robot that decides."""
    decided = np.array([one.cost_s for one in by_rule[RULES[0]]])
    for rule, days in by_rule.items():
        costs = np.array([one.cost_s for one in days])
        yield [
            setting,
            rule,
            interval(costs),
            "" if rule == RULES[0] else interval(costs - decided),
            f"{np.mean([one.time_s for one in days]):,.0f}",
            f"{sum(one.looked for one in days)} of {len(days)}",
            f"{sum(one.done for one in days)}",
        ]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--days", type=int, default=100)
    parser.add_argument("--jobs", type=int, default=None, help="processes; as many as cores")
    parser.add_argument("--settings", nargs="*", choices=list(SETTINGS), default=list(SETTINGS))
    given = parser.parse_args()
    scenario = load(find(NAME))
    console = Console(width=140)
    console.print(crossover(scenario))
    days = list(truths(scenario, given.days))
    cases = [(s, r, t) for s in given.settings for r in RULES for t in days]
    progress, outcomes = Progress(len(cases)), []
    with ProcessPoolExecutor(given.jobs) as pool:
        for case, outcome in zip(cases, pool.map(partial(day, scenario), cases), strict=True):
            outcomes.append(outcome)
            progress.step(f"{case[0]}, {case[1]}")
    table = Table(title=f"{NAME}, {given.days} days, mean +- 95 % interval")
    heads = (
        "setting",
        "rule",
        "cost, s",
        "more than by deciding, s",
        "time, s",
        "looked",
        "errands done",
    )
    for head in heads:
        table.add_column(head)
    for s, setting in enumerate(given.settings):
        by_rule = {
            rule: outcomes[(s * len(RULES) + k) * len(days) :][: len(days)]
            for k, rule in enumerate(RULES)
        }
        for row in rows(setting, by_rule):
            table.add_row(*row)
    console.print(table)


if __name__ == "__main__":
    main()
