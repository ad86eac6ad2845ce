"""What hides who comes, and what does not; the ring fires faster where something may."""

from __future__ import annotations

import numpy as np
import pytest

from bus.costs import CostModel
from bus.facts import Facts
from bus.messages import Attention, Ranges
from bus.turns import Turn
from modules.reactor.process import WATCHES_S, Reactor, build
from modules.reactor.settings import Settings
from modules.reactor.sight import SEES_M, hides

NAN = float("nan")


def echoes(*ranges: float) -> np.ndarray:
    """Straight ahead, left, right of it."""
    return np.array([[range_m, 0.01 * np.nan_to_num(range_m) + 0.01] for range_m in ranges])


@pytest.mark.parametrize(
    ("ranges", "found"),
    [
        ((4.2, 4.0, 4.6), True),  # a frame on one side
        ((4.2, NAN, 4.2), True),  # a corner
        ((4.2, 4.2, 4.25), False),  # a wall across the way
        ((4.2, 3.0, 2.9), False),  # the wall across the end of a corridor, and its corners
        ((NAN, 4.0, 4.6), False),  # nothing in the middle
        ((SEES_M + 0.1, NAN, NAN), False),  # far enough
    ],
)
def test_what_is_narrower_than_the_way_hides_who_comes(
    ranges: tuple[float, ...], found: bool
) -> None:
    assert hides(echoes(*ranges)) == found


def heard(reactor: Reactor, time_s: float, ahead_m: float) -> list[float]:
    """One ping, of which only one transducer hears anything: the periods then asked for."""
    mean = np.full(24, NAN)
    mean[0] = ahead_m
    turn = Turn(0, CostModel("free"), ("sensor", 0))
    ranges = Ranges(0, round(time_s * 1e9), mean, np.full(24, 0.05), np.ones(24), 0.085)
    reactor.handlers["belief/ranges"](ranges, turn)
    return [said.period_s for said, _ in turn.said if isinstance(said, Attention)]


def test_the_ring_fires_faster_while_the_view_is_short() -> None:
    reactor = build(Facts(2, 1, 0, 2, 0.085), Settings(), 1)
    known = [4.6 - 0.17 * k for k in range(12)]  # it stands, and is known to
    asked = [heard(reactor, 2.0 * k, ahead_m) for k, ahead_m in enumerate(known)]
    assert asked[-1] == []
    assert [period_s for periods in asked for period_s in periods] == [0.25]
    after = [heard(reactor, 22.25 + 0.25 * k, NAN) for k in range(40)]
    quiet = next(k for k, periods in enumerate(after) if periods)
    assert after[quiet] == [0.0]
    assert (quiet + 1) * 0.25 >= WATCHES_S
