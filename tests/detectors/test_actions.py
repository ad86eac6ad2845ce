"""What each detector does: the way there and back, and that it takes 30 to 60 seconds."""

import math

import pytest

from bus.features import (
    CONCAVE_CORNER,
    CONVEX_CORNER,
    DOOR_JAMB,
    FEATURES,
    FLAT_WALL,
    OPENING,
    USUAL,
    Wedges,
)
from modules.detectors.actions import Step, duration_s, ping_offsets_rad, plan
from modules.detectors.views import DetectorError, view_of
from scenarios.calibrate_detectors import CRAWL_M_S, PING_S, TURN_RAD_S, moved
from simworld.motion import Pose

DETECTORS = [(f, w) for f in range(len(FEATURES)) for w in range(USUAL.count)]


def test_the_plan_for_the_opening_on_the_left_by_hand() -> None:
    degrees = math.radians
    steps = plan(OPENING, 1, 2.0)
    assert [step.kind for step in steps] == [
        "drive", "turn", "drive", "turn", "ping", "turn", "ping", "turn", "ping", "turn", "ping",
        "turn", "drive", "turn", "drive",
    ]  # fmt: skip
    # To the vantage, faced left, 0.45 m nearer, and from there 3 degrees to each side.
    sweep = [degrees(-3), 3, degrees(2), 3, degrees(2), 3, degrees(2), 3, degrees(-3)]
    expected = [1.0, degrees(90), 0.45, *sweep, -0.45, degrees(-90), -1.0]
    assert [step.amount for step in steps] == pytest.approx(expected, abs=1e-12)


def test_duration_by_hand() -> None:
    # 1.45 m there and back: 2.9 / 0.085 = 34.118 s; turns 90 + 3 + 3 * 2 + 3 + 90 = 192 deg:
    # 12.8 s; 12 pings: 11.52 s.
    found = duration_s(plan(OPENING, 1, 2.0), CRAWL_M_S, TURN_RAD_S, PING_S)
    assert found == pytest.approx(2.9 / 0.085 + 192 / 15 + 12 * 0.96, abs=1e-9)


@pytest.mark.parametrize("width_m", [1.5, 1.8, 2.0, 2.2])
def test_every_detector_takes_thirty_seconds_to_a_minute(width_m: float) -> None:
    for f, w in DETECTORS:
        taken_s = duration_s(plan(f, w, width_m), CRAWL_M_S, TURN_RAD_S, PING_S)
        assert 29.9 <= taken_s <= 62.0, (f, w, taken_s)


def _target_m(feature: int, wedge: int) -> tuple[float, float]:
    """Places in metres for a width of 2 m, from the table of modules.classifier.geometry."""
    if feature in (CONVEX_CORNER, CONCAVE_CORNER) and wedge in (1, 7):
        return (2.0, 1.0) if wedge == 1 else (2.0, -1.0)
    return (
        (2.0, 0.0), (1.0, 1.0), (0.0, 1.0), (-1.0, 1.0),
        (-1.0, 0.0), (-1.0, -1.0), (0.0, -1.0), (1.0, -1.0),
    )[wedge]  # fmt: skip


@pytest.mark.parametrize(("feature", "wedge"), DETECTORS)
def test_a_plan_faces_its_target_and_ends_where_it_began(feature: int, wedge: int) -> None:
    pose = Pose(0.0, 0.0, 0.0)
    offsets_rad = []
    for kind, amount in plan(feature, wedge, 2.0):
        if kind != "ping":
            pose = moved(pose, kind, amount)
            continue
        x, y = _target_m(feature, wedge)
        bearing = math.atan2(y - pose.y_m, x - pose.x_m)
        off_rad = math.remainder(pose.heading_rad - bearing, 2 * math.pi)
        offsets_rad += [off_rad] * int(amount)
        facing_rad = view_of(feature, wedge).facing_rad
        assert math.remainder(bearing - facing_rad, 2 * math.pi) == pytest.approx(0.0, abs=1e-9)
    assert offsets_rad == pytest.approx(ping_offsets_rad(), abs=1e-9)
    assert (pose.x_m, pose.y_m, pose.heading_rad) == pytest.approx((0, 0, 0), abs=1e-9)


@pytest.mark.parametrize("count", [4, 6, 12, 16])
def test_with_other_wedges_each_detector_faces_the_place_it_is_about(count: int) -> None:
    wedges = Wedges(count)
    for f in range(len(FEATURES)):
        for w in range(count):
            place, view = wedges.place(f, w), view_of(f, w, wedges)
            if place is None:
                assert (view.vantage, view.facing_rad) == (0.0, wedges.middle_rad(w))
                continue
            bearing = math.atan2(place.y, place.x - view.vantage)
            assert math.remainder(bearing - view.facing_rad, 2 * math.pi) == pytest.approx(0.0)
            assert plan(f, w, 2.0, wedges)[0] == Step("drive", view.vantage) or not view.vantage


def test_only_sides_are_looked_into_from_nearer_by_hand() -> None:
    assert view_of(OPENING, 1).approach == view_of(OPENING, 7).approach == 0.45
    nearer = [(f, w) for f, w in DETECTORS if view_of(f, w).approach]
    assert nearer == [(f, w) for f in (OPENING, FLAT_WALL, DOOR_JAMB) for w in (1, 7)]
    ahead = plan(OPENING, 0, 2.0)
    assert [step.amount for step in ahead if step.kind == "drive"] == [1.0, -1.0]


def test_left_and_right_are_mirror_images() -> None:
    for f, w in DETECTORS:
        left, right = view_of(f, w), view_of(f, -w % USUAL.count)
        assert (left.vantage, left.approach) == (right.vantage, right.approach)
        assert math.cos(left.facing_rad) == pytest.approx(math.cos(right.facing_rad))
        assert math.sin(left.facing_rad) == pytest.approx(-math.sin(right.facing_rad), abs=1e-12)


def test_refuses_what_cannot_be_done() -> None:
    with pytest.raises(DetectorError, match="got feature 5, wedge 0"):
        plan(5, 0, 2.0)
    with pytest.raises(DetectorError, match="got feature 0, wedge -1"):
        view_of(0, -1)
    with pytest.raises(DetectorError, match=r"wedges 0\.\.11, got feature 0, wedge 12"):
        plan(0, 12, 2.0, Wedges(12))
    with pytest.raises(DetectorError, match=r"got 0\.0 m"):
        plan(0, 0, 0.0)
    with pytest.raises(DetectorError, match=r"got 0\.1 m/s, 0 rad/s"):
        duration_s([Step("drive", 1.0)], 0.1, 0, 1.0)
