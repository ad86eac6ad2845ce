"""The familiar intersection of section 2: when a detour to make sure pays.

    python -m benchmarks.familiar_place

On a grid of 6 x 3 lines the robot knows the surroundings of one intersection, A, from before. It
has lost count of the corridors it drove and stands where a T is open to the east, south and west,
as A is. Is this A, or one of two other intersections that have not been seen yet? The weight of
each answer is its prior times the evidence over all connected maps for what was seen, placed there.
Two corridors west of A is a corner, the restaurant of the example: the detour drives there, looks
and comes back. Two tables say when that is worth its time: by what a wrong answer costs, and by
how much time is left. Everything is exact and repeats on any machine.
"""

from __future__ import annotations

import argparse

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from bus.grid import EAST, SOUTH, WEST
from modules.decider.familiar import Detour, Familiar, decide_detour
from modules.geographer import ConnectedMaps
from modules.geographer.registration import weights

CORRIDOR_S = 240.0
"""About four minutes (section 5)."""

A = (2, 2)
PLACES = (A, (4, 2), (3, 2))
"""Where the robot may be: A itself, or an intersection further east."""
PRIOR = (0.5, 0.25, 0.25)
SEEN_HERE = EAST | SOUTH | WEST
RESTAURANT = {(0, 2): EAST | SOUTH, (1, 2): EAST | SOUTH | WEST, (2, 2): EAST | SOUTH | WEST}
"""What is known from before: A, and the way to the corner two corridors west of it."""
CONFUSED = 0.05
"""P(a reading speaks for some other type); the readings of a visit together."""
DIRECT_S = 3 * CORRIDOR_S
"""What is left of the errand by the right act."""
LOOK_S = 4 * CORRIDOR_S
"""To the corner and back."""


def likelihood(junction_type: int) -> NDArray[np.float64]:
    """P(readings | type), (16,), where the readings speak for one type."""
    found = np.full(16, CONFUSED / 15)
    found[junction_type] = 1.0 - CONFUSED
    return found


def evidence(maps: ConnectedMaps, place: tuple[int, int]) -> tuple[float, NDArray[np.float64]]:
    """Log evidence if the robot is at ``place``, and P(type) two corridors west of there."""
    given = np.ones((maps.grid.rows, maps.grid.columns, 16))
    for (x, y), junction_type in RESTAURANT.items():
        given[y, x] *= likelihood(junction_type)
    given[place[1], place[0]] *= likelihood(SEEN_HERE)
    belief = maps.posterior(given)
    return belief.log_evidence, belief.junction(place[0] - 2, place[1])


def asked(wrong_s: float, left_s: float = np.inf, late_price: float = 0.0) -> Familiar:
    """The decision: act on one of the registrations, or look first."""
    maps = ConnectedMaps(6, 3)
    found = [evidence(maps, place) for place in PLACES]
    probability = weights(np.log(PRIOR), np.array([log for log, _ in found]))
    reads = np.array([likelihood(t) for t in range(16)]).T  # (reading, type)
    shows = np.array([reads @ types for _, types in found]).T
    act_s = DIRECT_S + wrong_s * (1.0 - np.eye(len(PLACES)))
    return Familiar.there_and_back(probability, act_s, LOOK_S, shows, left_s, late_price)


def curve(values: list[tuple[str, Detour]], title: str, by: str) -> Table:
    """One row a case."""
    table = Table(title=title)
    for name in (by, "act at once, s", "look first, s", "saves, s", "detour"):
        table.add_column(name)
    for name, found in values:
        table.add_row(
            name,
            f"{found.now_s:.0f}",
            f"{found.look_s:.0f}",
            f"{found.worth_s:+.0f}",
            "yes" if found.pays else "no",
        )
    return table


def main() -> None:
    """Print when the detour pays."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.parse_args()
    console = Console(width=100)
    weights = ", ".join(
        f"{place} {p:.3f}" for place, p in zip(PLACES, asked(0.0).probability, strict=True)
    )
    console.print(f"the robot is at: {weights}")
    wrong = [1200.0, 2400.0, 3600.0, 4800.0, 7200.0, 9600.0, 14400.0]
    cases = [(f"{w:.0f} s", decide_detour(asked(w))) for w in wrong]
    console.print(curve(cases, "no hurry: by what a wrong answer costs", "wrong answer"))
    left = [600.0, 900.0, 1200.0, 1500.0, 1800.0, 2400.0, 3600.0, 6000.0]
    cases = [(f"{t:.0f} s", decide_detour(asked(3600.0, t, 10.0))) for t in left]
    title = "a wrong answer costs 3600 s, each late second ten: by the time left"
    console.print(curve(cases, title, "time left"))


if __name__ == "__main__":
    main()
