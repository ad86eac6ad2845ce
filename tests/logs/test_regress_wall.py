"""Wall time: one number a run, the exact test, and the floor under the effect."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.coordinator import Handled
from logs.regress.wall import (
    CANNOT_SAY,
    FASTER,
    LEAST_RUNS,
    SAME,
    SLOWER,
    TOO_FEW,
    compare_wall,
    typical_work_s,
)
from scenarios.launch import prepare
from scenarios.wall_record import WallRecord

BASE = tuple(1.0 + 0.001 * k for k in range(8))


def times(factor: float) -> tuple[float, ...]:
    return tuple(factor * took_s for took_s in BASE)


@pytest.mark.parametrize(
    "factor, verdict",
    [(1.0, SAME), (1.05, SAME), (1.2, SLOWER), (0.95, SAME), (0.8, FASTER)],
)
def test_a_tenth_is_the_least_that_counts(factor: float, verdict: str) -> None:
    assert compare_wall(BASE, times(factor)).verdict == verdict


def test_p_is_that_of_the_exact_test() -> None:
    # of all ways to split 16 runs, two put the sides apart completely
    assert compare_wall(BASE, times(1.2)).p == pytest.approx(2 / math.comb(16, 8))


def test_with_few_runs_nothing_is_said() -> None:
    few = BASE[: LEAST_RUNS - 1]
    for sides in ((few, BASE), (BASE, few)):
        found = compare_wall(*sides)
        assert (found.verdict, found.p, found.ratio) == (TOO_FEW, None, None)


def test_between_the_levels_it_is_unclear() -> None:
    new = (*times(1.2)[:6], 0.5, 1.0065)
    found = compare_wall(BASE, new)
    assert 0.01 < (found.p or 0.0) < 0.1
    assert found.verdict == CANNOT_SAY
    assert compare_wall(BASE, new, level=0.09).verdict == SLOWER


@given(st.lists(st.floats(1e-3, 1e3), min_size=16, max_size=16, unique=True))
def test_swapping_the_sides_swaps_the_verdict(took_s: list[float]) -> None:
    there, back = compare_wall(took_s[:8], took_s[8:]), compare_wall(took_s[8:], took_s[:8])
    opposite = {SLOWER: FASTER, FASTER: SLOWER}
    assert back.verdict == opposite.get(there.verdict, there.verdict)


def test_the_promise_is_kept_where_runs_differ_much() -> None:
    rng = np.random.default_rng(1)
    alarms = sum(
        compare_wall(*rng.lognormal(0.0, 0.5, (2, 8)).tolist()).verdict == SLOWER
        for _ in range(2000)
    )
    # the rate is at most half of 1 %: were it that, 22 or more would come once in 10,000
    assert alarms < 22


def test_a_run_is_its_handlers_medians_times_their_number(tmp_path: Path) -> None:
    log = tmp_path / "a.mcap"
    log.touch()
    assert typical_work_s(log) is None
    with WallRecord(log, prepare("aces", [], 1).script) as wall:
        for took_ns in (100, 300, 50_000_000_000):  # the first call compiled
            wall.measured("decider", _handled("belief/map", took_ns))
        wall.measured("sensor", _handled("percept/sonar", 7))
    assert typical_work_s(log) == pytest.approx((3 * 300 + 7) / 1e9)


def _handled(topic: str, took_ns: int) -> Handled:
    return Handled(topic, "world", 1, 0, 1, 1, 0, "", took_ns)
