"""Laser scans as readings of a ring: by hand, and the detectors on the ACES log."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from benchmarks.aces_detectors import entries
from modules.classifier.sensor_model import load_sensor_model
from simworld.carmen import Scan, read_carmen
from simworld.laser_ring import FARTHEST_M, ring_readings

ACES = Path(__file__).parents[3] / "shared" / "maps" / "aces" / "aces-corrected.log.gz"


def scan(x: float, heading_deg: float, ranges: float = 3.0) -> Scan:
    return Scan(0.0, x, 0.0, math.radians(heading_deg), np.full(181, ranges))


def test_half_a_ring_and_the_other_half_from_the_scan_the_other_way() -> None:
    ahead, seen = ring_readings([scan(0.0, 0.0)], 0.0, 0.0, 0.0)
    assert seen[0].nonzero()[0].tolist() == [*range(6), *range(19, 24)]
    assert ahead[0, seen[0]] == pytest.approx(3.0)
    assert np.isnan(ahead[0, ~seen[0]]).all()
    both, seen = ring_readings([scan(0.0, 0.0), scan(0.1, 180.0, 5.0)], 0.0, 0.0, 0.0)
    assert both[0, [0, 12]] == pytest.approx([3.0, 4.9], abs=0.05)
    assert both[1, [0, 12]] == pytest.approx([3.0, 4.9], abs=0.05)
    assert seen[0].sum() == 22  # a cone at each side is on the edge of both


def test_what_is_seen_is_seen_from_the_vantage() -> None:
    # Half a metre before the scan's place and turned left: the point ahead is on the right.
    ranges, seen = ring_readings([scan(0.5, 0.0)], 0.0, 0.0, math.pi / 2)
    assert ranges[0, 18] == pytest.approx(3.5, abs=0.05)
    assert not seen[0, 6]
    moved, _ = ring_readings([Scan(0.0, 7.5, -4.0, 0.0, scan(0.0, 0.0).ranges_m)], 7.0, -4.0, 0.0)
    assert moved[0, 0] == pytest.approx(3.5, abs=0.05)
    assert ring_readings([scan(1.5, 0.0)], 0.0, 0.0, 0.0)[0].shape == (0, 24)


def test_far_things_are_not_heard() -> None:
    ranges, seen = ring_readings([scan(0.0, 0.0, FARTHEST_M + 0.1)], 0.0, 0.0, 0.0)
    assert np.isnan(ranges).all()
    assert seen.any()


@pytest.mark.skipif(not ACES.is_file(), reason=f"needs the log {ACES}")
def test_the_detectors_see_the_openings_of_the_real_building() -> None:
    found = [e for e in entries(read_carmen(ACES).scans, 1.0, load_sensor_model()) if e.readings]
    assert len(found) == 23
    # As measured: rooms and stubs at the junctions are openings, too, to whoever cannot go there.
    assert sum(e.found == e.junction.type for e in found) >= 8
    assert sum(e.found == e.open_sides for e in found) >= 15
