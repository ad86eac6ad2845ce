"""A choice made with less, judged by the expected costs of the whole."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.grid import DIRECTIONS
from modules.decider import decide
from modules.decider.judging import excess_s
from tests.decider.test_path_anytime import situation_of


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 80))
def test_the_decisions_own_directions_cost_nothing_more(seed: int, maps: int) -> None:
    s = situation_of(seed, maps)
    decision = decide(s)
    excess = excess_s(s, decision.direction)
    best = np.minimum(decision.known_s, decision.unknown_s)
    assert np.isfinite(excess).tolist() == np.isfinite(best).tolist()
    # P_U must be truly better to be chosen, beyond rounding
    assert (np.nan_to_num(excess) <= 1e-8 * np.nan_to_num(best, posinf=1.0)).all()


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.integers(1, 80), st.sampled_from(DIRECTIONS))
def test_no_direction_costs_less_nor_more_than_there_and_back(
    seed: int, maps: int, direction: int
) -> None:
    s = situation_of(seed, maps)
    excess = excess_s(s, np.full(16, direction, dtype=np.uint8))
    corridor = s.grid.corridor(*s.grid.place(s.place), direction)
    judged = excess[np.isfinite(excess)]
    assert (judged >= 0.0).all()
    assert (judged <= 2.0 * s.corridor_s[corridor] + 1e-6).all()
