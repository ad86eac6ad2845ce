"""The act refined until stopped: what it has by then, and why it stopped."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from modules.reactor.anytime import acts_within, cells_before, refine
from modules.reactor.diagram import Settings
from modules.reactor.meeting import ACTS
from modules.reactor.react import Encounter, encounter, outlook, utilities
from modules.reactor.tables import compiled
from tests.reactor.things import walker

DIAGRAM = compiled(Settings())
UNLIMITED = 10**9


def met_by(ahead_m: float, speed_m_s: float, left_m: float, p: float = 0.9) -> Encounter:
    thing = walker(ahead_m, speed_m_s, left_m, p)
    return encounter(thing.belief, thing.false, 0.0, DIAGRAM.settings)


def whole(met: list[Encounter], doing: str) -> np.ndarray:
    return utilities([outlook(one, DIAGRAM) for one in met], ACTS.index(doing), DIAGRAM)


def test_it_is_settled_once_nothing_else_can_be_better() -> None:
    # Nobody comes, most likely: going on costs next to nothing, and all else costs time at best.
    met = [met_by(9.0, 1.3, 0.7, p=0.001)]
    refined = refine(met, "continue", DIAGRAM, UNLIMITED)
    assert (refined.stopped, refined.act) == ("settled", "continue")
    assert refined.weighed < len(ACTS)
    assert refined.cells == cells_before(met, refined.weighed)


def test_it_stops_with_nothing_left_when_every_act_was_weighed() -> None:
    # Whatever it does the cart-wide things on both sides are upon it.
    met = [met_by(0.6, 1.3, 0.0, p=1.0)]
    refined = refine(met, "continue", DIAGRAM, UNLIMITED)
    assert (refined.stopped, refined.weighed) == ("nothing left", len(ACTS))
    np.testing.assert_allclose(refined.expected_utility, whole(met, "continue"), rtol=1e-9)


def test_it_stops_out_of_cells_before_the_act_that_does_not_fit() -> None:
    met = [met_by(0.6, 1.3, 0.0, p=1.0)]
    three = cells_before(met, 3)
    refined = refine(met, "continue", DIAGRAM, three)
    assert (refined.stopped, refined.weighed, refined.cells) == ("out of cells", 3, three)
    assert refine(met, "continue", DIAGRAM, three - 1).weighed == 2
    assert acts_within(met, three) == 3
    assert acts_within(met, three - 1) == 2


def test_to_begin_with_it_goes_on_with_what_is_being_done() -> None:
    met = [met_by(3.0, 1.3, 0.0)]
    refined = refine(met, "pull aside left", DIAGRAM, 0)
    assert (refined.stopped, refined.act, refined.cells) == ("out of cells", "pull aside left", 0)
    assert acts_within(met, 0) == 0


@settings(max_examples=150, deadline=None)
@given(
    st.lists(
        st.builds(
            met_by,
            st.floats(0.3, 10.0),
            st.sampled_from([0.0, 0.8, 1.3, 1.8]),
            st.floats(-0.7, 0.7),
            st.floats(0.01, 1.0),
        ),
        min_size=1,
        max_size=2,
    ),
    st.sampled_from(ACTS),
    st.integers(0, 400),
)
def test_stopped_by_itself_it_has_the_best_act_of_all(
    met: list[Encounter], doing: str, cells: int
) -> None:
    refined = refine(met, doing, DIAGRAM, UNLIMITED)
    everything = whole(met, doing)
    assert refined.stopped != "out of cells"
    assert everything[ACTS.index(refined.act)] >= everything.max() - 1e-9
    assert refined.cells <= cells_before(met)
    short = refine(met, doing, DIAGRAM, cells)
    assert short.cells <= cells
    assert everything[ACTS.index(short.act)] >= everything[ACTS.index(doing)] - 1e-9
    if short.weighed:
        among = ~np.isnan(short.expected_utility)
        assert everything[ACTS.index(short.act)] >= everything[among].max() - 1e-9
