"""Acting at once or looking first where the robot may be: against plain Python, by enumeration."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.grid import DIRECTIONS, EAST, JUNCTION_TYPES, NORTH, SOUTH, WEST, Grid, Maps
from modules.decider.frames import corridors_shifted, frames_of, routes_to_look, shifted
from modules.decider.hypotheses import by_junction_type
from modules.decider.roads import roads_of
from modules.decider.situation import Situation, SituationError
from modules.decider.whereabouts import (
    LOOKS,
    MAPS,
    Rule,
    Whereabouts,
    decide_whereabouts,
    most_maps,
    whereabouts_cells,
)
from modules.geographer import ConnectedMaps
from tests.decider.whereabouts_reference import Best, Seen, routes_of, solve

GRID = Grid(4, 3)
MAPS_OF = ConnectedMaps(4, 3)
MOST = 4


def some(seed: int) -> Whereabouts:
    """Two or three places that a robot heading east may be at, with a belief each."""
    rng = np.random.default_rng(seed)
    places = [v for v in range(GRID.intersections) if GRID.place(v)[0] > 0]
    goal = int(rng.integers(GRID.intersections))
    chosen = rng.permutation([v for v in places if v != goal])[: int(rng.integers(2, 4))].tolist()
    memory = rng.dirichlet(np.full(JUNCTION_TYPES, 0.2), GRID.intersections) + 1e-4
    remembered = rng.random(GRID.intersections) < 0.7
    memory[~remembered] = 1.0
    seconds = rng.uniform(100, 300, GRID.corridors)
    situations, ahead = [], []
    for place in chosen:
        x, y = GRID.place(place)
        driven = np.ones((GRID.corridors, 2))
        driven[GRID.corridor(x, y, 8), 0] = 0.0
        belief = MAPS_OF.posterior(memory.reshape(3, 4, 16), 1.0, driven)
        maps = belief.sample(60, rng)
        situations.append(
            Situation(
                GRID, place, 8, (goal,), np.empty((0, 2), np.int64), np.empty(0), maps,
                np.full(60, 1 / 60), belief.log_probability(maps), belief.corridors, seconds, 40.0,
            )
        )  # fmt: skip
        ahead.append(belief.junction(x, y))
    weights = rng.dirichlet(np.ones(len(chosen)))
    late = (
        (float(rng.uniform(300, 2000)), float(rng.uniform(0.5, 20))) if rng.random() < 0.5 else ()
    )
    return Whereabouts(tuple(situations), weights, np.array(ahead), *late)


HALL = Grid(9, 2)
"""A hall along y = 1 with the goal at [4, 1], as far west of [6, 1] as it is east of [2, 1]."""


def hall(south_of_a: int, south_of_b: int) -> Maps:
    """One map: two junctions that look alike, with something south of each."""
    found = np.zeros((1, HALL.corridors), np.uint8)
    found[0, [HALL.corridor(x, 1, EAST) for x in range(8)]] = 1
    for x, south in ((6, south_of_a), (2, south_of_b)):
        for direction in (d for d in DIRECTIONS if south & d):
            found[0, HALL.corridor(x, 0, direction)] = 1
    return found


def at(place: tuple[int, int], maps: Maps) -> Situation:
    return Situation(
        HALL, HALL.intersection(*place), EAST, (HALL.intersection(4, 1),),
        np.empty((0, 2), np.int64), np.empty(0), maps, np.ones(1), np.zeros(1),
        maps[0].astype(float), np.full(HALL.corridors, 100.0), 0.0,
    )  # fmt: skip


def in_the_hall(p: float, south_of_b: int = NORTH | WEST) -> Whereabouts:
    """At A with probability p, or at B; a corner is south of A, something else south of B."""
    maps = hall(NORTH | EAST, south_of_b)
    ahead = np.zeros((2, JUNCTION_TYPES))
    ahead[:, EAST | SOUTH | WEST] = 1.0
    places = (at((6, 1), maps), at((2, 1), maps))
    return Whereabouts(places, np.array([p, 1.0 - p]), ahead)


ALIKE = EAST | SOUTH | WEST


def decided(asked: Whereabouts, rule: Rule = "least expected cost") -> list[float]:
    """At the hall's junction: what acting and looking cost, whether it looks, where it goes."""
    found = decide_whereabouts(asked, 1, rule).decision
    columns = found.known_s, found.unknown_s, found.explores, found.direction
    return [float(column[ALIKE]) for column in columns]


def test_by_hand_it_looks_where_a_mistake_costs_more() -> None:
    # Right: 200 s. As if at A from B: 200 s west to the hall's end, nobody; 400 s back east.
    # The look: 100 s south, 100 s back, then right. What saves nothing is not done.
    assert decided(in_the_hall(0.5)) == pytest.approx([200 + 0.5 * 400, 200 + 200, 0, WEST])
    late = replace(in_the_hall(0.5), left_s=450.0, late_price=3.0)
    assert decided(late) == pytest.approx([400 + 0.5 * 3 * 150, 400, 1, SOUTH])
    # with less than that left, the right answer is too late after the look as well
    late = replace(late, left_s=200.0)
    assert decided(late) == pytest.approx([400 + 0.5 * 3 * 400, 400 + 3 * 200, 0, WEST])


def test_by_hand_it_goes_where_it_most_probably_is() -> None:
    assert decided(in_the_hall(0.7)) == pytest.approx([200 + 0.3 * 400, 400, 0, WEST])
    assert decided(in_the_hall(0.3)) == pytest.approx([200 + 0.3 * 400, 400, 0, EAST])


def test_what_looks_the_same_everywhere_is_no_place_to_look() -> None:
    assert decided(in_the_hall(0.5, NORTH | EAST)) == pytest.approx([400, np.inf, 0, WEST])


def test_the_rules_to_compare_with() -> None:
    assert decided(in_the_hall(0.9), "look") == pytest.approx([240, 400, 1, SOUTH])
    late = replace(in_the_hall(0.5), left_s=450.0, late_price=3.0)
    assert decided(late, "act") == pytest.approx([625, np.inf, 0, WEST])
    assert decided(in_the_hall(0.5, NORTH | EAST), "look")[3] == WEST, "nowhere to look"


def test_what_does_not_fit_together_is_refused() -> None:
    asked = in_the_hall(0.5)
    done = replace(asked.situations[0], waypoints=())
    with pytest.raises(SituationError, match=r"goals ahead: found .*, expected one"):
        replace(asked, situations=(done, asked.situations[1]))
    with pytest.raises(SituationError, match=r"weights has shape \(1,\), expected \(2,\)"):
        replace(asked, weights=np.ones(1))


def test_why_is_told() -> None:
    choice = decide_whereabouts(replace(in_the_hall(0.5), left_s=450.0, late_price=3.0), 1)
    assert HALL.place(int(choice.acts_at[ALIKE])) == (6, 1)
    assert HALL.place(int(choice.looks_at[ALIKE])) == (6, 0)
    assert choice.acts_at[NORTH] == choice.looks_at[NORTH] == -1
    calm = decide_whereabouts(in_the_hall(0.3), 1)
    assert HALL.place(int(calm.acts_at[ALIKE])) == (2, 1)
    assert calm.looks_at[ALIKE] == -1


@given(st.integers(0, GRID.intersections - 1), st.integers(0, GRID.intersections - 1))
def test_grids_shift_as_their_places_do(of: int, to: int) -> None:
    places, corridors = shifted(GRID, of, to), corridors_shifted(GRID, of, to)
    assert places[of] == to
    (x0, y0), (x1, y1) = GRID.place(of), GRID.place(to)
    for v in range(GRID.intersections):
        x, y = GRID.place(v)
        inside = 0 <= x + x1 - x0 < GRID.columns and 0 <= y + y1 - y0 < GRID.rows
        assert (places[v] >= 0) == inside
        if inside:
            assert GRID.place(int(places[v])) == (x + x1 - x0, y + y1 - y0)
    for corridor, source in enumerate(corridors.tolist()):
        if source >= 0:
            assert [int(places[v]) for v in GRID.ends(source)] == list(GRID.ends(corridor))


@pytest.mark.parametrize("cells", [0, 10**4, 10**5, 10**7])
def test_as_many_maps_as_fit(cells: int) -> None:
    maps = most_maps(3, 8, cells)
    assert maps in MAPS
    assert whereabouts_cells(3, 8, maps) <= cells or maps == MAPS[0]
    bigger = [n for n in MAPS if n > maps]
    assert not bigger or whereabouts_cells(3, 8, bigger[0]) > cells


def reference(asked: Whereabouts, junction_type: int) -> Best:
    """By enumeration, over the looks that the decider considers."""
    fit = [
        s
        for k, s in enumerate(asked.situations)
        if asked.ahead[k, junction_type] > 0
        and junction_type in by_junction_type(s, roads_of(s.grid, s.corridor_s), MOST)
    ]
    frames = frames_of(fit, junction_type)
    routes = [
        tuple(DIRECTIONS[d] for d in route.steps.tolist())
        for route in routes_to_look(fit, frames, LOOKS)
    ]
    possible = set(routes_of([Seen.of(s, junction_type) for s in fit]))
    assert set(routes) <= possible, "ways over corridors that are known"
    return solve(asked, junction_type, routes, MOST)


@settings(max_examples=12, deadline=None)
@given(st.integers(0, 10**6))
def test_the_decision_is_the_best_over_acts_and_looks(seed: int) -> None:
    asked = some(seed)
    choice = decide_whereabouts(asked, MOST)
    found = choice.decision
    for t in np.flatnonzero(np.isfinite(found.known_s)).tolist():
        best = reference(asked, t)
        assert found.known_s[t] == pytest.approx(best.now_s, rel=1e-9)
        least = min(best.by_route.values(), default=np.inf)
        if np.isfinite(found.unknown_s[t]):
            assert any(
                found.unknown_s[t] == pytest.approx(cost, rel=1e-9)
                for cost in best.by_route.values()
            )
            assert found.unknown_s[t] >= least - 1e-6
        # what it leaves out tells nothing, so it saves nothing to speak of
        if found.explores[t]:
            assert found.unknown_s[t] < found.known_s[t]
        else:
            assert found.known_s[t] <= found.unknown_s[t] * (1 + 1e-9)
    assert found.cells <= whereabouts_cells(
        len(asked.situations), int((asked.weights @ asked.ahead > 0).sum()), MOST
    )
