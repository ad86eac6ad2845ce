"""How long a decision about something ahead takes: compiled, by brute force, by pyAgrum.

    python -m benchmarks.reaction_speed [--encounters N]

The same random encounters to all three, in one process: a belief over cells of what is heard, when
and where, room on either side, and what the robot does. *Compiled* is what runs use
(``modules/reactor/tables.py``); *the joint table* sums over every state of the diagram in numpy;
*pyAgrum, inference* is Shafer and Shenoy's message passing over a diagram declared beforehand,
*declared and solved* both. All must choose the same act.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from rich.console import Console
from rich.table import Table

from modules.reactor.cone import Floats
from modules.reactor.declared import declare, solve
from modules.reactor.diagram import (
    HEARD,
    Settings,
    change_table,
    intent_table,
    severity_table,
    time_table,
    what_table,
)
from modules.reactor.meeting import ACTS
from modules.reactor.react import Encounter, outlook, utilities
from modules.reactor.room import Room, rooms_of
from modules.reactor.sides import Sides
from modules.reactor.tables import (
    ROOMS_M,
    SIDES_M,
    TTC_CLASSES,
    Diagram,
    collision_table,
    compiled,
)
from modules.reactor.thing import COLUMNS

Answer = TypeVar("Answer")
SETTINGS = Settings()
CELLS = 12
"""Entries of a belief that are not zero: what is typical when a decision is due."""


def drawn(seed: int) -> tuple[Encounter, int, tuple[int, int]]:
    """An encounter, the number of the act that is being done, classes of room left and right."""
    rng = np.random.default_rng([seed, 3])
    shape = (len(HEARD), TTC_CLASSES, COLUMNS)
    table = np.zeros(int(np.prod(shape)))
    table[rng.choice(len(table), CELLS, replace=False)] = rng.dirichlet(np.full(CELLS, 0.3))
    met = Encounter(table.reshape(shape), int(rng.integers(len(SIDES_M))), 0.0)
    left, right = (int(k) for k in rng.integers(len(ROOMS_M), size=2))
    return met, int(rng.integers(len(ACTS))), (left, right)


def sides_of(room: tuple[int, int]) -> Sides:
    """Room of these classes; no way known to be open."""
    return Sides(Room(*(float(ROOMS_M[k]) for k in room)), np.zeros(len(ACTS)))


def by_joint_table(met: Encounter, doing: int, room: tuple[int, int]) -> Floats:
    """Expected utility of each act as the sum over what, intent, and all that is heard."""
    rooms = rooms_of(sides_of(room).room)
    hit = collision_table(SETTINGS)[met.side][rooms, np.arange(len(ACTS))]
    weight = np.einsum("htn,hw,wi->htnwi", met.heard, what_table(SETTINGS), intent_table(SETTINGS))
    harm = np.einsum("htnwi,awitn,aw->a", weight, hit, severity_table(SETTINGS), optimize=True)
    lost = np.einsum("htnwi,awi->a", weight, time_table(SETTINGS), optimize=True)
    utility: Floats = -SETTINGS.collision * harm - lost - change_table(SETTINGS)[doing]
    return utility


def by_tables(diagram: Diagram, met: Encounter, doing: int, sides: Sides) -> Floats:
    """Expected utility of each act as in a run."""
    return utilities([outlook(met, diagram, sides)], doing, diagram)


def timed(work: Callable[..., Answer], *given: Any) -> tuple[Answer, float]:
    """What it answers, and the microseconds it took."""
    began = time.perf_counter_ns()
    answer = work(*given)
    return answer, (time.perf_counter_ns() - began) / 1e3


def measured(seed: int, diagram: Diagram) -> dict[str, float]:
    """Microseconds by method. Ends the program if the methods do not choose the same act."""
    met, doing, room = drawn(seed)
    found, tables_us = timed(by_tables, diagram, met, doing, sides_of(room))
    joint, joint_us = timed(by_joint_table, met, doing, room)
    declared, declare_us = timed(declare, met.heard, met.side, room, ACTS[doing], SETTINGS)
    solved, solve_us = timed(solve, declared)
    acts = {ACTS[int(found.argmax())], ACTS[int(joint.argmax())], solved.act}
    if len(acts) > 1 or abs(found.max() - solved.expected_utility) > 1e-6:
        raise SystemExit(f"encounter {seed}: the methods differ: {sorted(acts)}")
    return {
        "compiled": tables_us,
        "the joint table, numpy": joint_us,
        "pyAgrum, inference": solve_us,
        "pyAgrum, declared and solved": declare_us + solve_us,
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description="Microseconds a decision about something ahead takes, by method.",
        epilog="Example: python -m benchmarks.reaction_speed --encounters 100",
    )
    parser.add_argument("--encounters", type=int, default=100, help="how many are drawn (100)")
    given = parser.parse_args()
    diagram = compiled(SETTINGS)
    measured(given.encounters, diagram)  # the first compiles
    took = [measured(seed, diagram) for seed in range(given.encounters)]
    table = Table("method", "median, us", "least, us", "median against compiled")
    compiled_us = np.median([one["compiled"] for one in took])
    for method in took[0]:
        all_us = [one[method] for one in took]
        ratio = np.median(all_us) / compiled_us
        table.add_row(method, f"{np.median(all_us):.0f}", f"{min(all_us):.0f}", f"{ratio:.0f}")
    Console(width=120).print(table)
    print(f"{given.encounters} encounters, the same act by all, utilities within 1e-6")


if __name__ == "__main__":
    main()
