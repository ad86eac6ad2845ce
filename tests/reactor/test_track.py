"""The belief about things ahead: exact where it can be, sane everywhere."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from modules.reactor import Scan, ScanError, Settings, Tracker, compiled, react, updated
from modules.reactor.cone import USUAL
from modules.reactor.thing import (
    COLUMNS,
    DISTANCE,
    LINE_PRIOR,
    LINES_M,
    PAIRED,
    SINGLE,
    SPEEDS_M_S,
    STANDS_PRIOR,
    VARIANCE,
    EchoModel,
)
from modules.reactor.thing_kernels import expected
from tests.reactor.things import (
    born,
    echoes_of_disc,
    echoes_of_discs,
    listened,
    moved,
    reweighed,
)

SETTINGS = Settings()
DIAGRAM = compiled(SETTINGS)
MIDDLE = len(LINES_M) // 2
DRIVE_M_S = 0.085


def scan(time_s: float, *echoes: float, speed: float = 0.085) -> Scan:
    """A ping of which the first few of the forward transducers heard something."""
    ranges = np.full(24, np.nan)
    ranges[USUAL.numbers[: len(echoes)]] = echoes
    return Scan(time_s, ranges, 0.01 * np.nan_to_num(ranges) + 0.01, speed)


def of_disc(
    time_s: float, ahead_m: float, left_m: float, rng: np.random.Generator | None = None
) -> Scan:
    """A ping of a disc, without noise or with."""
    ranges = echoes_of_disc(ahead_m, left_m)
    if rng is not None:
        ranges = [r + (0.01 * r + 0.01) * float(rng.standard_normal()) for r in ranges]
    return scan(time_s, *ranges)


def approach(
    speed_m_s: float, left_m: float, pings: int, seed: int, start_m: float = 8.0
) -> Tracker:
    """Fast pings of somebody who approaches."""
    rng = np.random.default_rng(seed)
    tracker = Tracker()
    for k in range(pings):
        at = start_m - 0.25 * k * (speed_m_s + DRIVE_M_S)
        tracker = updated(tracker, of_disc(10.0 + 0.25 * k, at, left_m, rng))
    return tracker


def test_nothing_ahead_is_quiet() -> None:
    tracker = updated(Tracker(), scan(1.0, np.nan))
    assert tracker.things == ()
    assert tracker.approaching == 0.0
    assert not tracker.wants_attention
    assert tracker.quiet_s == np.inf


def test_somebody_new_asks_for_attention_at_the_first_ping() -> None:
    assert updated(Tracker(), of_disc(1.0, 8.0, 0.0)).wants_attention


@pytest.mark.parametrize("speed", [0.8, 1.3, 1.8])
def test_somebody_is_known_to_approach_within_four_fast_pings(speed: float) -> None:
    known = [approach(speed, 0.1, 4, seed).approaching > 0.99 for seed in range(50)]
    assert sum(known) >= 48


@pytest.mark.parametrize("speed", [0.8, 1.3, 1.8])
def test_distance_and_speed_are_learnt(speed: float) -> None:
    thing = approach(speed, 0.4, 12, 5).things[0]
    found = float((thing.weight.sum(axis=1) @ SPEEDS_M_S) / thing.weight.sum())
    distance = float((thing.weight * thing.belief[DISTANCE]).sum() / thing.weight.sum())
    assert found == pytest.approx(speed, abs=0.1)
    assert distance == pytest.approx(8.0 - 11 * 0.25 * (speed + DRIVE_M_S), abs=0.1)


def test_sides_are_learnt() -> None:
    for left_m, side in ((0.4, 0), (0.2, 0), (-0.2, 2), (-0.65, 2)):
        sides = approach(1.3, left_m, 14, 3).things[0].sides
        assert sides[side] > 0.95
        assert sum(sides) == pytest.approx(1.0)


def test_what_stands_is_not_taken_for_somebody() -> None:
    for seed in range(20):
        tracker = approach(0.0, 0.0, 6, seed)
        assert tracker.approaching < 0.01
        assert tracker.things[0].standing > 0.99
        assert not tracker.wants_attention
        assert react(tracker, "continue", DIAGRAM) is None


NONE = np.nan


@pytest.mark.parametrize("cones", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 0), (1, 1, 1)])
def test_echoes_of_one_ping_move_nobody_and_are_forgotten(cones: tuple[int, int, int]) -> None:
    for at_m in np.arange(0.3, 10.5, 0.3):
        tracker = updated(Tracker(), scan(0.5, NONE))
        for k in range(5):
            heard = [at_m if cone and k == 0 else NONE for cone in cones]
            tracker = updated(tracker, scan(1.0 + 0.25 * k, *heard))
            assert react(tracker, "continue", DIAGRAM) is None
        assert tracker.approaching < 0.01


def test_who_has_passed_is_forgotten_and_the_robot_goes_on() -> None:
    tracker = approach(1.3, 0.4, 12, 1, start_m=5.0)
    reaction = react(tracker, "continue", DIAGRAM)
    assert reaction is not None and reaction.due and reaction.act == "pull aside right"
    silent_s = 0.0
    doing = reaction.act
    while doing != "continue":
        silent_s += 0.25
        assert silent_s < 10.0
        ping = replace(scan(12.75 + silent_s, np.nan, speed=0.0), lateral_m=-0.65)
        tracker = updated(tracker, ping)
        said = react(tracker, doing, DIAGRAM)
        doing = said.act if said is not None and said.due else doing
        assert doing in ("pull aside right", "continue")
    # First the robot waits where it stands.
    assert silent_s >= SETTINGS.clear_s
    tracker = updated(tracker, scan(30.0, np.nan))
    assert tracker.things == ()


def test_a_person_before_a_wall_that_is_known_is_seen() -> None:
    tracker = Tracker()
    for k in range(5):
        tracker = updated(tracker, scan(2.0 * k, 9.0 - 0.17 * k, np.nan, np.nan))
    wall = tracker.approaching
    for k in range(4):
        at = 6.0 - 0.25 * 1.385 * k
        tracker = updated(tracker, of_disc(10.0 + 0.25 * k, at, 0.1))
    assert wall < 0.01
    assert tracker.approaching > 0.99


def test_one_person_is_not_taken_for_two() -> None:
    most = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        tracker = Tracker()
        for k in range(14):
            ping = of_disc(10.0 + 0.25 * k, 8.0 - 0.25 * k * 1.385, 0.1, rng)
            if k == 5:  # one transducer is far out, another hears nothing
                ping.mean_m[0] -= 0.35
                ping.mean_m[1] = np.nan
            tracker = updated(tracker, ping)
        most = max(most, sum(thing.approaching > 0.5 for thing in tracker.things))
    assert most == 1


def test_an_echo_of_which_the_better_half_is_missing_asks_for_attention() -> None:
    # At the side only two transducers hear him, and the one straight ahead has dropped out.
    tracker = updated(Tracker(), scan(1.0, np.nan, 7.0))
    assert tracker.wants_attention
    assert not updated(tracker, scan(1.25, np.nan)).wants_attention


def test_scans_must_follow_in_time() -> None:
    tracker = updated(Tracker(), scan(2.0, 5.0))
    with pytest.raises(ScanError, match=r"2\.0 s after 2\.0 s"):
        updated(tracker, scan(2.0, 5.0))
    with pytest.raises(ScanError, match="shapes"):
        Scan(1.0, np.zeros(24), np.zeros(23))
    with pytest.raises(ScanError, match="found 16 ranges, expected 24"):
        updated(tracker, Scan(3.0, np.zeros(16), np.zeros(16)))


def test_one_step_is_bayes_rule_by_integration() -> None:
    """On the centre line the range is linear in distance, so a fine grid must agree."""
    model = EchoModel()
    first, second, elapsed = 6.0, 5.62, 0.25
    # Only cone 0 and only the middle line and all speeds: everything else weighs nothing.
    thing = born(0, first, 0.07, 0.0, 0.0, model)
    weight = np.zeros_like(thing.weight)
    weight[:, MIDDLE] = thing.weight[:, MIDDLE]
    thing = reweighed(thing, weight)
    thing = moved(thing, DRIVE_M_S * elapsed, elapsed, model._replace(line_change_hz=0.0))
    after, _ = listened(thing, 0, second, 0.066, 0.0, model)

    grid = np.linspace(3.0, 9.0, 60_001)
    step = grid[1] - grid[0]
    evidence = np.zeros(len(SPEEDS_M_S))
    mean = np.zeros(len(SPEEDS_M_S))
    for v in range(len(SPEEDS_M_S)):
        prior = normal(grid, thing.belief[DISTANCE, v, MIDDLE], thing.belief[VARIANCE, v, MIDDLE])
        likelihood = model.heard * normal(grid - 0.25, second, 0.066**2)
        likelihood = likelihood + model.masked / USUAL.farthest_m
        joint = thing.weight[v, MIDDLE] * prior * likelihood
        evidence[v] = joint.sum() * step
        mean[v] = (joint * grid).sum() * step / evidence[v]
    false = thing.false * model.stray / USUAL.farthest_m
    total = evidence.sum() + false
    np.testing.assert_allclose(after.weight[:, MIDDLE], evidence / total, atol=1e-9)
    assert after.false == pytest.approx(false / total, abs=1e-9)
    np.testing.assert_allclose(after.belief[DISTANCE, :, MIDDLE], mean, atol=1e-6)


def normal(x: NDArray[np.float64], mean: float, variance: float) -> NDArray[np.float64]:
    """Gaussian density."""
    density: NDArray[np.float64] = np.exp(-0.5 * (x - mean) ** 2 / variance)
    density /= np.sqrt(2.0 * np.pi * variance)
    return density


RANGES = st.one_of(st.just(float("nan")), st.floats(0.15, 10.7))


@settings(max_examples=60, deadline=None)
@given(
    st.lists(
        st.tuples(RANGES, RANGES, RANGES, st.floats(0.01, 5.0), st.floats(-0.6, 0.6)),
        min_size=1,
        max_size=12,
    )
)
def test_whatever_is_heard_probabilities_stay_probabilities(
    heard: list[tuple[float, float, float, float, float]],
) -> None:
    trackers = [Tracker(), Tracker()]
    time_s = 0.0
    for ahead, left, right, elapsed, lateral in heard:
        time_s += elapsed
        ping = replace(scan(time_s, ahead, left, right), lateral_m=lateral)
        trackers = [updated(tracker, ping) for tracker in trackers]
        for thing in trackers[0].things:
            assert (thing.weight >= 0).all() and 0.0 <= thing.false <= 1.0
            assert thing.weight.sum() + thing.false == pytest.approx(1.0)
            assert (thing.belief[VARIANCE] > 0).all()
        assert 0.0 <= trackers[0].approaching <= 1.0 + 1e-12
        assert len(trackers[0].things) <= 6
        react(trackers[0], "continue", DIAGRAM)
    for one, two in zip(trackers[0].things, trackers[1].things, strict=True):
        assert one.belief.tobytes() == two.belief.tobytes()


def test_line_prior_is_uniform_across_the_corridor() -> None:
    # 0.1 m of 1.5 m for the line from 0.3 to 0.4.
    assert LINE_PRIOR.sum() == pytest.approx(1.0)
    assert STANDS_PRIOR.sum() == pytest.approx(1.0)
    assert (LINE_PRIOR[:SINGLE][np.abs(LINES_M) > 0.75] == 0.0).all()
    share = (1.0 - PAIRED) * 0.1 / 1.5
    assert LINE_PRIOR[int(np.abs(LINES_M - 0.35).argmin())] == pytest.approx(share)
    assert LINE_PRIOR[SINGLE:].sum() == pytest.approx(PAIRED)
    assert LINES_M[MIDDLE] == pytest.approx(0.0)


def test_what_has_become_impossible_is_not_worked_on_any_more() -> None:
    tracker = Tracker()
    cells = []
    for k in range(8):
        tracker = updated(tracker, scan(2.0 * k, 9.0 - 0.17 * k))
        cells.append(tracker.cells)
    assert tracker.things[0].standing > 0.99
    assert max(cells) > len(USUAL.numbers) * len(SPEEDS_M_S) * COLUMNS
    assert cells[-1] == len(USUAL.numbers) * (1 + COLUMNS)  # one speed, nought


def of_two(
    time_s: float, ahead_m: float, left_m: float, right_m: float, further_m: float = 0.0
) -> Scan:
    """A ping of two who come abreast, the right one so much further behind."""
    discs = ((ahead_m, left_m), (ahead_m + further_m, -right_m))
    return scan(time_s, *echoes_of_discs(*discs))


@pytest.mark.parametrize("further_m", [0.0, 0.2])
@pytest.mark.parametrize(("left_m", "right_m"), [(0.6, 0.6), (0.55, 0.7)])
def test_two_abreast_are_told_from_one_before_they_are_here(
    left_m: float, right_m: float, further_m: float
) -> None:
    tracker = Tracker()
    for k in range(20):
        at = 8.0 - 0.25 * k * 1.385
        tracker = updated(tracker, of_two(10.0 + 0.25 * k, at, left_m, right_m, further_m))
        if at < 2.9:  # then the outer transducers hear one each
            break
    (pair,) = [thing for thing in tracker.things if thing.approaching > 0.5]
    assert pair.weight[:, SINGLE:].sum() > 0.9
    reaction = react(tracker, "continue", DIAGRAM)
    assert reaction is not None and reaction.act == "continue"


def test_one_is_not_taken_for_two_abreast() -> None:
    for left_m in (0.0, 0.1, 0.2, 0.24, -0.4):
        for seed in range(5):
            thing = approach(1.3, left_m, 15, seed).things[0]
            assert thing.weight[:, SINGLE:].sum() < 0.1


def test_what_is_beside_or_behind_the_robot_has_a_range_or_none() -> None:
    places = product(np.linspace(-0.6, 1.0, 33), range(COLUMNS), np.linspace(-0.65, 0.65, 27))
    for ahead_m, column, lateral_m in places:
        for cone in range(len(USUAL.numbers)):
            found = expected(float(ahead_m), column, float(lateral_m), USUAL, cone)
            assert np.isfinite(found).all()
            assert not found[1] or (found[0] >= 0.0 and found[3] >= -1e-12)
