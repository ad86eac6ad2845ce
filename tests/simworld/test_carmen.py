"""Reading CARMEN logs, whole ones and those that are not."""

from __future__ import annotations

import gzip
import math
from pathlib import Path

import numpy as np
import pytest

from simworld.carmen import CarmenError, read_carmen

ODOM = "ODOM 1.0 2.0 0.5 0.3 0.1 0.0 7.25 host 7.5\n"


def flaser(beams: int, time_s: float = 8.0, value: float = 2.0) -> str:
    ranges = " ".join([str(value)] * beams)
    return f"FLASER {beams} {ranges} 1.5 2.5 0.25 1.0 2.0 0.5 7.9 host {time_s}\n"


def written(folder: Path, text: str, name: str = "robot.log") -> Path:
    path = folder / name
    data = text.encode()
    path.write_bytes(gzip.compress(data) if name.endswith(".gz") else data)
    return path


@pytest.mark.parametrize(
    ("beams", "first_deg", "last_deg"),
    [(180, -90.0, 89.0), (181, -90.0, 90.0), (360, -90.0, 89.5), (361, -90.0, 90.0)],
)
def test_a_scan_of_each_size(tmp_path: Path, beams: int, first_deg: float, last_deg: float) -> None:
    (scan,) = read_carmen(written(tmp_path, flaser(beams))).scans
    assert len(scan.ranges_m) == len(scan.bearings_rad) == beams
    assert np.degrees(scan.bearings_rad[[0, -1]]) == pytest.approx([first_deg, last_deg])
    assert (scan.x_m, scan.y_m, scan.heading_rad, scan.time_s) == (1.5, 2.5, 0.25, 8.0)


@pytest.mark.parametrize("name", ["robot.log", "robot.log.gz", "robot.data"])
def test_everything_in_order_and_the_rest_passed_over(tmp_path: Path, name: str) -> None:
    text = (
        "# message formats defined: PARAM SYNC ODOM FLASER\n"
        "PARAM robot_use_laser on nohost 0\n\nSYNC here 1 host 1\nNEFF 10.5\n"
        + ODOM
        + flaser(180, 8.0)
        + flaser(181, 9.0)
    )
    log = read_carmen(written(tmp_path, text, name))
    assert [scan.time_s for scan in log.scans] == [8.0, 9.0]
    assert log.parameters == {"robot_use_laser": "on"}
    (odometry,) = log.odometry
    assert (odometry.x_m, odometry.y_m, odometry.heading_rad) == (1.0, 2.0, 0.5)
    assert (odometry.speed_m_s, odometry.turning_rad_s, odometry.time_s) == (0.3, 0.1, 7.5)


def test_what_never_returned_is_no_range(tmp_path: Path) -> None:
    for value in (81.91, 80.0, 0.0):
        (scan,) = read_carmen(written(tmp_path, flaser(180, value=value))).scans
        assert np.isnan(scan.ranges_m).all()
    (scan,) = read_carmen(written(tmp_path, flaser(180, value=79.0))).scans
    assert math.isfinite(scan.ranges_m.max())


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "found no FLASER line, expected a CARMEN log with laser scans"),
        (ODOM, "found no FLASER line"),
        (flaser(100), "line 1: FLASER: found 100 beams, expected one of 180, 181, 360, 361"),
        ("FLASER\n", "line 1: FLASER: found no number beams"),
        (ODOM + flaser(180)[:400], "line 2: FLASER: found 98 values, expected 189; is it cut"),
        (flaser(180)[:-5], "line 1: FLASER: found 188 values, expected 189"),
        (flaser(180) + ODOM[:20], "line 2: ODOM: found 4 values, expected 9; is it cut off"),
        (flaser(180).replace(" 2.5", " here"), "line 1: FLASER: found .*'here', expected numbers"),
        (flaser(180).replace(" 2.5", " nan"), "line 1: FLASER: found nan, expected finite"),
        ("\x00\x7f\n", "found no FLASER line"),
    ],
)
def test_bad_logs_are_refused_by_file_and_line(tmp_path: Path, text: str, says: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(CarmenError, match=says) as caught:
        read_carmen(path)
    assert str(path) in str(caught.value)


def test_cut_and_damaged_compression_and_no_file(tmp_path: Path) -> None:
    path = written(tmp_path, flaser(180) * 50, "robot.log.gz")
    whole = path.read_bytes()
    for spoilt in (whole[:-20], whole[: len(whole) // 2], whole[:-6] + b"\0\0\0\0\0\0", whole[:3]):
        path.write_bytes(spoilt)
        with pytest.raises(CarmenError, match=r"robot\.log\.gz: found .*cut off or damaged"):
            read_carmen(path)
    with pytest.raises(CarmenError, match="No such file"):
        read_carmen(tmp_path / "nothing.log")
    with pytest.raises(CarmenError, match="directory"):
        read_carmen(tmp_path)
