"""Worked examples: three maps on a 2 x 2 grid.

    2 -c1- 3        c0 and c3 take 300 s, c1 and c2 take 100 s; sensing takes 60 s.
    c2     c3       A = c0 c2 c3 (c1 is missing)   Pr 0.4
    0 -c0- 1        B = c0 c1 c2 c3                Pr 0.4
                    C = c0 c1 c3 (c2 is missing)   Pr 0.2

The robot comes from 1 to 0, on an errand to 3. At 0 it finds type NE (A or B) or E (C).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bus.grid import EAST, NORTH, SOUTH, Grid
from modules.decider import Situation, decide

A, B, C = [1, 0, 1, 1], [1, 1, 1, 1], [1, 1, 0, 1]
SITUATION = Situation(
    grid=Grid(2, 2),
    place=0,
    came_from=EAST,
    waypoints=(3,),
    tasks=np.array([[2, 3]]),
    expected=np.array([10.0]),
    maps=np.array([A, B, C], dtype=np.uint8),
    weights=np.array([0.4, 0.4, 0.2]),
    log_probability=np.log([0.4, 0.4, 0.2]),
    corridor_probability=np.array([1.0, 0.6, 0.8, 1.0]),
    corridor_s=np.array([300.0, 100.0, 100.0, 300.0]),
    sensing_s=60.0,
)
NE = NORTH | EAST


def test_a_shortcut_that_is_often_needed_is_explored() -> None:
    decision = decide(SITUATION)
    # P_K: M* is c0, c2, c3: 0-1-3 takes 600. The most probable map is A (ties go to the first):
    # 2-0-1-3 takes 700 under A, and under B too. 600 + 10 * 700.
    assert decision.known_s[NE] == pytest.approx(7600)
    # P_U to 2: 100 + 60; then under A back by 2-0-1-3, 700, under B on by c1, 100:
    # (860 + 260) / 2 = 560. The type at 2 tells A from B, so the task takes 700 under A and
    # 100 under B: 10 * 400 = 4000.
    assert decision.unknown_s[NE] == pytest.approx(4560)
    assert decision.explores[NE]
    assert decision.direction[NE] == NORTH


def test_what_is_known_is_taken_where_nothing_is_left_to_learn() -> None:
    decision = decide(SITUATION)
    # Type E: only C is left. 0-1-3 takes 600, the task 2-3 takes 100, ten times.
    assert decision.known_s[EAST] == pytest.approx(600 + 1000)
    assert decision.unknown_s[EAST] == np.inf
    assert not decision.explores[EAST]
    assert decision.direction[EAST] == EAST


def test_where_errors_are_found_at_once_information_is_worth_nothing() -> None:
    # With B the most probable map, the plan for 2-3 is c1. Under A it is seen to be missing
    # before a step is lost: 2-0-1-3, 700; under B 100. So E[P_K] = 600 + 10 * 400, and knowing
    # c1 beforehand saves nothing: E[P_U] = 560 + 10 * 400.
    decision = decide(replace(SITUATION, log_probability=np.array([-2.0, -1.0, -3.0])))
    assert decision.known_s[NE] == pytest.approx(4600)
    assert decision.unknown_s[NE] == pytest.approx(4560)


def test_an_unlikely_shortcut_without_future_tasks_is_not_explored() -> None:
    # Given NE, A has 0.9 of the probability: E[P_U] = 0.9 * 860 + 0.1 * 260 = 800, E[P_K] = 600.
    decision = decide(
        replace(
            SITUATION,
            tasks=np.empty((0, 2), dtype=np.int64),
            expected=np.empty(0),
            weights=np.array([0.72, 0.08, 0.2]),
            corridor_probability=np.array([1.0, 0.28, 0.8, 1.0]),
        )
    )
    assert decision.known_s[NE] == pytest.approx(600)
    assert decision.unknown_s[NE] == pytest.approx(800)
    assert decision.direction[NE] == EAST


def test_many_expected_tasks_turn_the_same_choice() -> None:
    # A is most probable: each task that c1 would shorten loses 600 under B, 0.1 * 600 = 60.
    # Exploring costs 200 more now, so it pays from four expected tasks on: 240 > 200 > 180.
    unlikely = replace(
        SITUATION,
        weights=np.array([0.72, 0.08, 0.2]),
        log_probability=np.log([0.72, 0.08, 0.2]),
        corridor_probability=np.array([1.0, 0.28, 0.8, 1.0]),
    )
    assert not decide(replace(unlikely, expected=np.array([3.0]))).explores[NE]
    assert decide(replace(unlikely, expected=np.array([4.0]))).explores[NE]


def test_spare_time_is_spent_on_exploring_where_that_pays() -> None:
    spare = replace(SITUATION, waypoints=())
    decision = decide(spare)
    # Stay: 10 * 700. Go to 2 and sense: 160 + 10 * 400.
    assert decision.known_s[NE] == pytest.approx(7000)
    assert decision.unknown_s[NE] == pytest.approx(4160)
    assert decision.direction[NE] == NORTH
    # Nothing to learn: stay.
    assert decision.known_s[EAST] == pytest.approx(1000)
    assert decision.direction[EAST] == 0


def test_no_known_path_means_p_k_is_infinite() -> None:
    # c3 is open too, so that M* is c0 and c2 only. Sensing at 2: under A back to 1 and, hoping,
    # on by c3.
    decision = decide(replace(SITUATION, corridor_probability=np.array([1.0, 0.6, 0.8, 0.9])))
    assert decision.known_s[NE] == np.inf
    assert decision.explores[NE]
    assert decision.unknown_s[NE] == pytest.approx(4560)


def test_a_type_that_no_map_has_gets_the_shortest_consistent_step() -> None:
    # NE is in no map of this H; the shortest consistent path 0-2-3 uses the open corridor c1.
    decision = decide(
        replace(
            SITUATION,
            maps=np.array([C], dtype=np.uint8),
            weights=np.ones(1),
            log_probability=np.zeros(1),
        )
    )
    assert decision.direction[NE] == NORTH
    assert decision.known_s[NE] == np.inf
    assert decision.unknown_s[NE] == np.inf
    assert not decision.explores[NE]
    # No corridor leads south from 0, so type S leaves nothing to take, and type NS only north.
    assert decision.direction[SOUTH] == 0
    assert decision.direction[NORTH | SOUTH] == NORTH


def test_without_any_hypothesis_every_type_gets_its_consistent_step() -> None:
    none = replace(
        SITUATION,
        maps=np.empty((0, 4), dtype=np.uint8),
        weights=np.empty(0),
        log_probability=np.empty(0),
    )
    decision = decide(none)
    assert decision.direction[NE] == NORTH
    assert decision.direction[EAST] == EAST
    assert decision.cells == decision.hypotheses == 0


def test_waypoints_already_reached_are_dropped() -> None:
    there = decide(replace(SITUATION, waypoints=(0, 0, 3)))
    assert there.known_s[NE] == decide(SITUATION).known_s[NE]


def test_an_errand_counts_all_its_legs() -> None:
    # 0-1-3 takes 600, and from there 3-1-0 takes 600: c1 was not seen from 0 or 1, but at 3 it
    # is: under B the way back is 3-2-0, 200. E = 600 + (600 + 200) / 2.
    decision = decide(replace(SITUATION, waypoints=(3, 0), expected=np.zeros(1)))
    assert decision.known_s[NE] == pytest.approx(1000)
