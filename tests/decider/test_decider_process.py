"""The decider's process: which model its setting names, what it says beside the path, in time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from bus.costs import CostModel, Rate
from bus.facts import Facts
from bus.grid import NORTH, SOUTH, Grid
from bus.messages import AskedPath, JunctionStakes, MapBelief, PathDecision
from bus.turns import Turn
from modules.decider import decide
from modules.decider.outlook import (
    WORLDS,
    decide_by_outlook,
    errands_of,
    most_worlds,
    outlook_cells,
)
from modules.decider.process import POSSIBLE, STAKES_SHARE, Decider, build
from modules.decider.settings import Settings
from modules.decider.stakes import most_maps, regret_s, stakes_of, unsettled_at
from modules.geographer import ConnectedMaps
from tests.decider.test_outlook import situation

GRID = Grid(3, 3)
FREE = CostModel("free")


def belief(visit: int, place: int) -> MapBelief:
    """All connected maps, equally likely, once north is driven to ``place``."""
    driven = np.ones((GRID.corridors, 2))
    x, y = GRID.place(place)
    driven[GRID.corridor(x, y, SOUTH), 0] = 0.0
    found = ConnectedMaps(3, 3).posterior(np.ones((3, 3, 16)), 1.0, driven)
    maps = found.sample(256, np.random.default_rng(5))
    order = np.argsort(GRID.junction_types(maps)[:, place], kind="stable")
    return MapBelief(
        visit, x, y, NORTH, found.junctions, found.corridors, np.full(GRID.corridors, 240.0),
        found.log_evidence, found.entropy, maps[order], np.full(256, 1 / 256), np.zeros(256),
    )  # fmt: skip


def asked(visit: int, until_ns: int = 240 * 10**9, waypoints: tuple[int, ...] = (8,)) -> AskedPath:
    tasks = np.array([[8, 0], [0, 6]])
    return AskedPath(
        1, visit, np.array(waypoints, np.int64), tasks, np.array([3.0, 2.0]), 0, until_ns
    )


def told(
    decider: Decider,
    question: AskedPath,
    place: int,
    costs: CostModel = FREE,
    heard: MapBelief | None = None,
) -> tuple[Any, ...]:
    """What it says once question and belief are there, and its turn."""
    turn = Turn(0, costs, ("geographer", 1))
    decider.handlers["asked/path"](question, Turn(0, costs, ("world", 0)))
    decider.handlers["belief/map"](heard or belief(question.visit, place), turn)
    return (*(message for message, _ in turn.said), turn)


def the_situation(place: int, waypoints: tuple[int, ...] = (8,)) -> Any:
    heard, question = belief(1, place), asked(1)
    return situation(
        GRID, heard.maps, place, 8, came_from=SOUTH, waypoints=waypoints, tasks=question.tasks,
        expected=question.expected, corridor_probability=heard.corridors,
        corridor_s=heard.drive_s, sensing_s=Settings().sensing_s,
    )  # fmt: skip


def a_decider(**settings: Any) -> Decider:
    return build(Facts(3, 3, 0, NORTH, 0.085), Settings(**settings), 1)


def test_plans_of_least_expected_cost_are_the_default() -> None:
    _, decision, _ = told(a_decider(), asked(1), 4)
    assert isinstance(decision, PathDecision)
    expected = decide_by_outlook(the_situation(4), WORLDS[-1]).decision
    assert decision.direction.tolist() == expected.direction.tolist()
    assert decision.unknown_s.tobytes() == expected.unknown_s.tobytes()
    assert decision.hypotheses == expected.hypotheses


def test_the_papers_model_is_used_where_it_is_set_and_in_spare_time() -> None:
    (decision, _turn) = told(a_decider(model="paper"), asked(1), 4)
    expected = decide(the_situation(4), 64)
    assert decision.direction.tolist() == expected.direction.tolist()
    assert decision.unknown_s.tobytes() == expected.unknown_s.tobytes()
    (spare, _turn) = told(a_decider(), asked(1, waypoints=()), 4)
    expected = decide(the_situation(4, waypoints=()), 64)
    assert spare.direction.tolist() == expected.direction.tolist()


def test_it_says_what_a_wrong_type_would_cost_unless_it_comes_back_for_it() -> None:
    decider = a_decider()
    stakes, decision, turn = told(decider, asked(1), 4)
    assert isinstance(stakes, JunctionStakes)
    assert stakes.visit == decision.visit == 1
    s = the_situation(4)
    weighed = stakes_of(s, 32)
    outlook = decide_by_outlook(s, WORLDS[-1])
    assert stakes.regret_s.tobytes() == regret_s(s, weighed, outlook).tobytes()
    assert dict(turn.works)["path"] == outlook.decision.cells + weighed.cells
    # Whoever comes back to an unsettled place finds out: the classifier's own price holds then.
    assert unsettled_at(s)
    assert [type(m) for m in told(decider, asked(2), 4)[:-1]] == [PathDecision]
    assert [type(m) for m in told(decider, asked(3), 3)[:-1]] == [JunctionStakes, PathDecision]
    known = replace(belief(4, 4), corridors=(belief(4, 4).corridors > 0.5).astype(float))
    assert [type(m) for m in told(decider, asked(4), 4, heard=known)[:-1]] == [
        JunctionStakes,
        PathDecision,
    ]


@pytest.mark.parametrize("cells", [20_000, 60_000, 400_000, 10**7])
def test_path_and_stakes_together_fit_the_time_left(cells: int) -> None:
    costs = CostModel("a test", {"path": Rate(0.0, 1000.0)})
    *said, turn = told(a_decider(), asked(1, until_ns=1000 * cells), 4, costs)
    assert turn.cost_ns <= 1000 * cells
    s = the_situation(4)
    heard = belief(1, 4)
    types = int((heard.junctions[heard.y, heard.x] > POSSIBLE).sum())
    legs, tasks = len(errands_of(s).goals), len(s.tasks)
    assert outlook_cells(GRID, 1, types, legs) <= cells, "there is room for the smallest problem"
    # An eighth of the time goes into the stakes at most; the path has what they leave.
    maps = most_maps(types, tasks, cells // STAKES_SHARE)
    assert maps is not None
    weighed = stakes_of(s, maps)
    worlds = most_worlds(GRID, types, legs, cells - weighed.cells)
    outlook = decide_by_outlook(s, worlds or 1)
    assert turn.cells - 1 == weighed.cells + outlook.decision.cells
    assert said[0].regret_s.tobytes() == regret_s(s, weighed, outlook).tobytes()
