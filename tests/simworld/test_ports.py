"""An abrupt change in a wall, and a wall ahead, among lost and crossed echoes."""

from __future__ import annotations

import math

import pytest

from simworld.ports import PortError, ears_of, end_at_m, has_ended
from simworld.sonar import SonarRing

NAN = math.nan


WALL = [1.04] * 6
SILENCE = [NAN] * 12


@pytest.mark.parametrize(
    ("early_m", "ended"),
    [
        ([*WALL, NAN, 5.0, *SILENCE[2:]], True),
        ([1.3, 1.2, NAN, 1.1, 1.05, 1.04, *SILENCE], True),  # one echo was lost
        ([*WALL, *SILENCE[:5], 0.7, *SILENCE[6:]], True),  # another's echo
        ([*WALL, NAN, *WALL, *WALL[:5]], False),  # the wall runs on
        (WALL + [NAN] * 7 + [1.39, 1.35, 1.31, 1.28, 1.25], False),  # the far jamb of a door
        ([NAN] * 5 + [1.04] + SILENCE, False),  # one chance echo is no wall
        ([*WALL[1:], NAN, *SILENCE], False),  # it had ended before
        ([1.04, *SILENCE], False),  # nothing was known before
    ],
)
def test_a_wall_ends_where_it_was_heard_and_then_not(early_m: list[float], ended: bool) -> None:
    assert has_ended(early_m, wall_m=1.0) is ended


def test_a_wall_ahead_is_where_the_echoes_agree() -> None:
    driven_m = [0.0, 0.1, 0.2, 0.3, 0.4]
    assert end_at_m(driven_m, [3.0, 2.9, 2.8, 2.7, 2.6]) == pytest.approx(3.0)
    assert end_at_m(driven_m, [3.0, NAN, 2.8, 2.7, 2.6]) == pytest.approx(3.0)
    assert end_at_m(driven_m, [3.0, 2.9, 1.2, 0.7, 2.6]) is None
    assert end_at_m(driven_m, [NAN] * 5) is None


def test_the_ring_of_24_listens_at_60_degrees_where_corners_leave_at_75() -> None:
    ears = ears_of(SonarRing())
    assert (ears.ahead, ears.left, ears.right) == (0, 6, 18)
    assert (ears.early_left, ears.early_right) == (4, 20)
    assert ears.leaves_rad == pytest.approx(math.radians(75.0))


def test_a_ring_without_such_a_transducer_is_refused() -> None:
    with pytest.raises(PortError, match="found a ring of 4 transducers"):
        ears_of(SonarRing(transducers=4))
