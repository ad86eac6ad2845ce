"""Places, wedges and detectors: which wedge holds what, for any number of wedges."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.features import (
    FAR_LEFT,
    FAR_SIDE,
    FEATURES,
    FEWEST,
    LEFT_SIDE,
    MOST,
    NEAR_LEFT,
    PLACES,
    USUAL,
    WALL_LEFT,
    WAY_BEHIND,
    WedgeError,
    Wedges,
)

numbers = st.integers(FEWEST, MOST)


def test_the_usual_eight_by_hand() -> None:
    places = (FAR_SIDE, LEFT_SIDE, FAR_LEFT, NEAR_LEFT, WALL_LEFT, WAY_BEHIND)
    assert [USUAL.holding(place) for place in places] == [0, 1, 1, 2, 3, 4]
    mirrored = [USUAL.holding(place.mirrored) for place in places]
    assert mirrored == [0, 7, 7, 6, 5, 4]


@given(numbers)
def test_a_wedge_holds_the_bearings_within_half_of_it(count: int) -> None:
    wedges = Wedges(count)
    for place in PLACES:
        wedge = wedges.holding(place)
        assert 0 <= wedge < count
        off = math.remainder(math.radians(place.bearing_deg) - wedges.middle_rad(wedge), math.tau)
        assert abs(off) <= math.pi / count + 1e-9


@given(numbers)
def test_left_is_the_mirror_of_right(count: int) -> None:
    wedges = Wedges(count)
    for place in PLACES:
        if place.y:
            assert wedges.holding(place.mirrored) == -wedges.holding(place) % count


@given(numbers)
def test_a_detector_is_about_a_place_of_its_wedge(count: int) -> None:
    wedges = Wedges(count)
    held = {wedges.holding(place) for place in PLACES}
    for feature in range(len(FEATURES)):
        about = [wedges.place(feature, wedge) for wedge in range(count)]
        for wedge, place in enumerate(about):
            assert (place is None) == (wedge not in held)
            assert place is None or wedges.holding(place) == wedge


@given(st.integers(8, MOST))
def test_with_eight_or_more_every_place_has_a_detector_of_each_of_its_features(count: int) -> None:
    wedges = Wedges(count)
    for place in PLACES:
        for feature in place.holds:
            # one place may hide another that may show the same and is nearer the wedge's middle
            nearest = wedges.place(feature, wedges.holding(place))
            assert nearest is not None
            assert feature in nearest.holds
            if count >= 12:
                assert nearest == place


@given(numbers, st.data())
def test_codes_and_parts(count: int, data: st.DataObject) -> None:
    wedges = Wedges(count)
    detector = data.draw(st.integers(0, wedges.detectors - 1))
    feature, wedge = wedges.parts(detector)
    assert wedges.code(feature, wedge) == detector == feature * count + wedge


def test_refuses_what_there_is_not() -> None:
    for count in (3, 361, 0, -8):
        with pytest.raises(WedgeError, match=f"found {count}, expected 4 to 360"):
            Wedges(count)
    with pytest.raises(WedgeError, match=r"0\.\.39, got 40"):
        USUAL.parts(40)
    with pytest.raises(WedgeError, match="got feature 5, wedge 0"):
        USUAL.code(5, 0)
