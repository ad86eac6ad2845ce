"""What the decider makes of what it is told of a robot that may be in several places."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from bus.costs import CostModel, Rate
from bus.facts import Facts
from bus.grid import NORTH, SOUTH, Grid
from bus.messages import (
    AskedErrand,
    AskedPath,
    MapBelief,
    PathDecision,
    RegistrationDecision,
    Registrations,
)
from bus.turns import Turn
from modules.decider.process import Decider, build
from modules.decider.settings import Settings
from modules.decider.told import whereabouts_of
from modules.decider.whereabouts import MAPS, decide_whereabouts, most_maps, whereabouts_cells
from modules.geographer import ConnectedMaps

GRID = Grid(3, 3)
SETTINGS = Settings()
S = 10**9
PLACES = (4, 3, 5)
"""The middle, and west and east of it, all entered northward."""


def asked(*waypoints: int, visit: int = 2) -> AskedPath:
    return AskedPath(
        7, visit, np.array(waypoints, np.int64), np.array([[8, 0]]), np.ones(1), 0, 240 * S
    )


def told(visit: int = 2) -> tuple[Registrations, MapBelief]:
    """Three beliefs, and the one of the likeliest as that of the map."""
    maps, of, junctions, corridors = [], [], [], []
    for k, place in enumerate(PLACES):
        x, y = GRID.place(place)
        driven = np.ones((GRID.corridors, 2))
        driven[GRID.corridor(x, y, SOUTH), 0] = 0.0
        found = ConnectedMaps(3, 3).posterior(np.ones((3, 3, 16)), 1.0, driven)
        maps.append(found.sample(40, np.random.default_rng(k)))
        of += [k] * 40
        junctions.append(found.junctions)
        corridors.append(found.corridors)
    ahead = [types[GRID.place(v)[::-1]] for types, v in zip(junctions, PLACES, strict=True)]
    drive_s, n = np.full(GRID.corridors, 240.0), len(of)
    said = Registrations(
        visit, NORTH, np.array(PLACES), np.array([0.5, 0.3, 0.2]), np.array(ahead),
        np.array(corridors), np.array([drive_s] * 3), np.array(of), np.concatenate(maps),
        np.full(n, 1 / 40), np.zeros(n),
    )  # fmt: skip
    belief = MapBelief(
        visit, 1, 1, NORTH, junctions[0], corridors[0], drive_s, 0.0, 0.0, maps[0],
        np.full(40, 1 / 40), np.zeros(40),
    )  # fmt: skip
    return said, belief


def test_each_place_has_a_situation_of_its_own() -> None:
    said, _ = told()
    found = whereabouts_of(GRID, SETTINGS, asked(8), said, None)
    assert found is not None
    assert [s.place for s in found.situations] == list(PLACES)
    assert found.weights.tolist() == said.weights.tolist()
    assert (found.left_s, found.late_price) == (np.inf, 0.0)
    for k, situation in enumerate(found.situations):
        assert situation.came_from == SOUTH
        assert situation.maps.tolist() == said.maps[40 * k : 40 * k + 40].tolist()
        assert situation.corridor_probability.tolist() == said.corridors[k].tolist()


def test_a_place_that_would_be_the_errand_s_end_is_left_out() -> None:
    said, _ = told()
    found = whereabouts_of(GRID, SETTINGS, asked(3, 8), said, None)
    assert found is not None
    assert [s.place for s in found.situations] == [4, 5]
    assert found.weights == pytest.approx([0.5 / 0.7, 0.2 / 0.7])


def test_in_spare_time_the_likeliest_place_counts() -> None:
    said, _ = told()
    found = whereabouts_of(GRID, SETTINGS, asked(), said, None)
    assert found is not None
    assert [s.place for s in found.situations] == [4]


def test_what_was_told_of_another_visit_does_not_count() -> None:
    said, _ = told(visit=1)
    assert whereabouts_of(GRID, SETTINGS, asked(8), said, None) is None
    assert whereabouts_of(GRID, SETTINGS, asked(8), None, None) is None


def test_the_time_left_counts_from_arrival() -> None:
    said, _ = told()
    for visit, left_s, price in ((2, 60.0, 3.0), (1, np.inf, 0.0)):
        due = AskedErrand(visit, 300 * S, 3.0)
        found = whereabouts_of(GRID, SETTINGS, asked(8), said, due)
        assert found is not None
        assert (found.left_s, found.late_price) == (left_s, price)


def decider() -> Decider:
    return build(Facts(3, 3, 4, NORTH, 0.085), SETTINGS, 1)


def heard(of: Decider, costs: CostModel, question: AskedPath) -> Turn:
    """Its turn when it hears the map, having heard the rest."""
    said, belief = told()
    for topic, message in (
        ("asked/errand", AskedErrand(2, 900 * S, 3.0)),
        ("asked/path", question),
        ("belief/registrations", said),
    ):
        before = Turn(0, costs, ("anybody", 0))
        of.handlers[topic](message, before)
        assert not before.said
    turn = Turn(0, costs, ("geographer", 9))
    of.handlers["belief/map"](belief, turn)
    return turn


def test_it_says_why_and_then_the_way() -> None:
    turn = heard(decider(), CostModel("free"), asked(8))
    (why, _), (path, parents) = turn.said
    assert isinstance(why, RegistrationDecision) and isinstance(path, PathDecision)
    expected = whereabouts_of(GRID, SETTINGS, asked(8), told()[0], AskedErrand(2, 900 * S, 3.0))
    assert expected is not None
    choice = decide_whereabouts(expected, MAPS[-1])
    assert path.direction.tolist() == choice.decision.direction.tolist()
    assert why.now_s.tobytes() == path.known_s.tobytes() == choice.decision.known_s.tobytes()
    assert why.look_s.tobytes() == choice.decision.unknown_s.tobytes()
    assert why.acts_at.tolist() == choice.acts_at.tolist()
    assert len(parents) == 3


@pytest.mark.parametrize("cells", [6_000, 20_000, 10**6])
def test_it_solves_what_fits_the_time_left(cells: int) -> None:
    costs = CostModel("a test", {"path": Rate(0.0, 1000.0)})
    question = msgspec.structs.replace(asked(8), until_ns=1000 * cells)
    turn = heard(decider(), costs, question)
    assert turn.cost_ns <= 1000 * cells
    types = int((told()[0].weights @ told()[0].ahead > 1e-9).sum())
    assert whereabouts_cells(3, types, most_maps(3, types, cells)) <= cells


def test_with_one_place_left_it_decides_as_ever() -> None:
    said, belief = told()
    alone = decider()
    for topic, message in (("asked/path", asked(8)), ("belief/map", belief)):
        turn = Turn(0, CostModel("free"), ("geographer", 9))
        alone.handlers[topic](message, turn)
    assert [type(m).__name__ for m, _ in turn.said] == ["JunctionStakes", "PathDecision"]
    assert len(said.places) == 3
