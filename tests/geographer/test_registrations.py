"""Where the robot may be: records laid on the grid, what drops out, what weighs how much."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.facts import Facts, MayBeAt, Recall, Recalled
from bus.grid import EAST, NORTH, SOUTH, WEST, Grid
from modules.geographer import ConnectedMaps, ContradictoryEvidenceError
from modules.geographer.map_belief import MapBelief
from modules.geographer.mixture import ahead, likeliest, told, weighed
from modules.geographer.registration import (
    LostError,
    Registration,
    registrations_of,
    those_left,
    weights,
)

GRID = Grid(3, 3)
MAPS = ConnectedMaps(3, 3)
STARTS = ((4, 0.5), (5, 0.3), (7, 0.2))


def facts(*recalled: Recalled) -> Facts:
    may_be = tuple(MayBeAt(place, p) for place, p in STARTS)
    return Facts(3, 3, 4, EAST, 0.085, recall=Recall(recalled, may_be))


def believe(at: Registration) -> MapBelief:
    return MAPS.posterior(at.record.junctions, 1.0, at.record.corridors)


def test_registrations_are_prior_times_evidence() -> None:
    found = weights(np.log([0.5, 0.5]), np.log([0.3, 0.1]) - 2000.0)
    assert found == pytest.approx([0.75, 0.25])
    with pytest.raises(LostError, match="expected a finite one"):
        weights(np.array([-np.inf]), np.array([0.0]))


def test_a_robot_that_knows_its_place_has_one_registration() -> None:
    (one,) = registrations_of(Facts(3, 3, 4, EAST, 0.085))
    assert (one.place, one.ahead, one.log_prior, one.record.log_scale) == (4, 4, 0.0, 0.0)
    (believed,) = weighed((one,), believe)
    assert believed.weight == 1.0


def test_what_is_recalled_is_in_every_record() -> None:
    found = registrations_of(facts(Recalled(0, NORTH | EAST, 0.85)))
    assert [one.place for one in found] == [4, 5, 7]
    for one in found:
        likelihood = one.record.junctions[0, 0]
        assert likelihood[NORTH | EAST] == 1.0
        others = np.delete(likelihood, NORTH | EAST)
        assert others == pytest.approx(0.01 / 0.85)
        assert one.record.log_scale == pytest.approx(np.log(0.85))


def test_what_leads_off_the_grid_drops_out() -> None:
    found = registrations_of(facts())
    first = [one.departed(EAST, first=True) for one in found]
    assert [one.ahead if one else None for one in first] == [4, 5, 7]
    begun = tuple(one.arrived() for one in those_left(first, found, "a corridor"))
    # from [1, 1], [2, 1] and [1, 2] east: the one at the eastern edge cannot
    went = [one.departed(EAST, first=False) for one in begun]
    assert [one.ahead if one else None for one in went] == [5, None, 8]
    left = those_left(went, begun, "a corridor E")
    assert [one.ahead for one in left] == [5, 8]
    for one in left:
        corridor = GRID.corridor(*GRID.place(one.place), EAST)
        assert one.record.corridors[corridor].tolist() == [0.0, 1.0]
    with pytest.raises(LostError, match=r"found a corridor E, .* it was at \[1, 1\], \[1, 2\]"):
        those_left([None, None], tuple(replace(one) for one in left), "a corridor E")


def test_a_wall_is_evidence_where_there_might_have_been_a_corridor() -> None:
    here, edge, _ = registrations_of(facts())
    corridor = GRID.corridor(1, 1, EAST)
    assert here.blocked(EAST).record.corridors[corridor].tolist() == [1.0, 0.0]
    assert edge.blocked(EAST) is edge


def test_what_no_map_fits_drops_out_and_what_fits_none_is_named() -> None:
    found = registrations_of(facts())
    alone = np.zeros(16)
    alone[SOUTH | WEST] = 1.0
    seen = [one.classified(alone) for one in found]
    # the corridor west of [1, 1] is known not to be there: only that registration needs it
    wall = GRID.corridor(1, 1, WEST)
    blocked = [replace(one, record=one.record.with_corridor(wall, exists=False)) for one in seen]
    left = weighed(blocked, believe)
    assert [one.at.place for one in left] == [5, 7]
    assert sum(one.weight for one in left) == pytest.approx(1.0)
    with pytest.raises(ContradictoryEvidenceError):
        weighed(blocked[:1], believe)


def test_the_improbable_is_not_told_of_and_in_the_end_dropped() -> None:
    found = registrations_of(facts())
    for log_prior, kept, worth in ((-20.0, 3, 3), (-60.0, 3, 2), (-80.0, 2, 2)):
        far = replace(found[1], log_prior=log_prior)
        every = weighed((found[0], far, found[2]), believe)
        assert (len(every), len(told(every))) == (kept, worth)
        assert sum(one.weight for one in told(every)) == pytest.approx(1.0, abs=1e-12)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6))
def test_weights_do_not_depend_on_how_records_are_scaled(seed: int) -> None:
    """Against the belief of likelihoods as they are, multiplied together at once."""
    rng = np.random.default_rng(seed)
    memory = [Recalled(int(v), int(rng.integers(1, 16)), 0.7) for v in rng.permutation(9)[:3]]
    found = list(registrations_of(facts(*memory)))
    steps = rng.integers(0, 3)
    likelihoods = [rng.uniform(1e-6, 1e-3, 16) for _ in range(steps)]
    for likelihood in likelihoods:
        found = [one.classified(likelihood) for one in found]
    logs = []
    for place, prior in STARTS:
        whole = np.ones((3, 3, 16))
        for one in memory:
            types = np.full(16, 0.3 / 15)
            types[one.junction_type] = 0.7
            whole[GRID.place(one.place)[::-1]] *= types
        for likelihood in likelihoods:
            whole[GRID.place(place)[::-1]] *= likelihood
        logs.append(np.log(prior) + MAPS.posterior(whole).log_evidence)
    expected = np.exp(np.array(logs) - np.logaddexp.reduce(logs))
    believed = weighed(found, believe)
    assert [one.weight for one in believed] == pytest.approx(expected, rel=1e-9)
    assert ahead(believed).sum() == pytest.approx(1.0)
    assert likeliest(believed).at.place == STARTS[int(expected.argmax())][0]
