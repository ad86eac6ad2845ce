"""Reading logs of real robots in the CARMEN format: laser scans and odometry.

One message a line (CARMEN Robot Navigation Toolkit, logger module): its name, its numbers, then
the sender's time, the sender's host and the logger's time. Read are FLASER, whose first pose a
mapper has corrected where the log is a corrected one, ODOM and PARAM; other lines are passed over.
"""

from __future__ import annotations

import gzip
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

BEAMS_TO_STEP_DEG = {180: 1.0, 181: 1.0, 360: 0.5, 361: 0.5}
"""A half circle that begins at -90 degrees, with or without its last beam. Of the offsets from
-90.5 to -88.5 degrees, -90 gives the sharpest walls for 180 beams in the log of the ACES
building."""

NO_ECHO_M = 80.0
"""The SICK LMS 200 says this or more where nothing returned."""

AFTER = 3
"""Sender's time, host and logger's time."""


class CarmenError(ValueError):
    """A log that cannot be read: file, line, found, expected."""


@dataclass(frozen=True, eq=False)
class Scan:
    """One scan of the laser that looks ahead.

    - ``ranges_m``: (beams,), counter-clockwise from the right; nan where nothing returned.
    - ``x_m, y_m, heading_rad``: the laser's pose, corrected where the log is.
    - ``time_s``: the logger's time.
    """

    time_s: float
    x_m: float
    y_m: float
    heading_rad: float
    ranges_m: NDArray[np.float64]

    @cached_property
    def bearings_rad(self) -> NDArray[np.float64]:
        """The direction of each beam relative to the heading, (beams,)."""
        beams = len(self.ranges_m)
        bearings: NDArray[np.float64] = np.deg2rad(
            np.arange(beams) * BEAMS_TO_STEP_DEG[beams] - 90.0
        )
        return bearings


@dataclass(frozen=True)
class Odometry:
    """Where the wheels say that the robot is, and how fast it goes."""

    time_s: float
    x_m: float
    y_m: float
    heading_rad: float
    speed_m_s: float
    turning_rad_s: float


@dataclass(frozen=True, eq=False)
class CarmenLog:
    """Scans and odometry in the order of the log, and the parameters as text."""

    scans: tuple[Scan, ...]
    odometry: tuple[Odometry, ...]
    parameters: dict[str, str]


def read_carmen(path: Path | str) -> CarmenLog:
    """Read a log, compressed with gzip or not.

    Raises CarmenError for a file that cannot be read, that is cut off in the middle of a line or
    of the compressed data, that has numbers which are none, or no FLASER line at all.
    """
    path = Path(path)
    scans, odometry, parameters = [], [], {}
    for number, line in enumerate(_lines(path), 1):
        words = line.split()
        name = words[0] if words else "#"
        try:
            if name == "FLASER":
                scans.append(_scan(words))
            elif name == "ODOM":
                odometry.append(_odometry(words))
            elif name == "PARAM" and len(words) > 1:
                parameters[words[1]] = " ".join(words[2:3])
        except _LineError as error:
            raise CarmenError(f"{path}, line {number}: {name}: {error}") from None
    if not scans:
        raise CarmenError(f"{path}: found no FLASER line, expected a CARMEN log with laser scans")
    return CarmenLog(tuple(scans), tuple(odometry), parameters)


class _LineError(ValueError):
    """What is wrong with one line."""


def _lines(path: Path) -> Iterator[str]:
    number = 0
    try:
        with path.open("rb") as raw:
            compressed = raw.read(2) == b"\x1f\x8b"
            raw.seek(0)
            for line in gzip.GzipFile(fileobj=raw) if compressed else raw:
                number += 1
                yield line.decode("ascii", "replace")
    except (EOFError, gzip.BadGzipFile, OSError) as error:
        if isinstance(error, OSError) and error.strerror:
            raise CarmenError(f"{path}: found {error.strerror}, expected a CARMEN log") from None
        raise CarmenError(
            f"{path}: found compressed data that is cut off or damaged after line {number}, "
            f"expected a whole log"
        ) from None


def _scan(words: list[str]) -> Scan:
    """FLASER n range*n x y theta odom_x odom_y odom_theta, and the times."""
    beams = words[1] if len(words) > 1 else "no number"
    if not beams.isdigit() or int(beams) not in BEAMS_TO_STEP_DEG:
        expected = ", ".join(map(str, BEAMS_TO_STEP_DEG))
        raise _LineError(f"found {beams} beams, expected one of {expected}")
    values = _numbers(words[2:], int(beams) + 6)
    ranges_m = np.array(values[: int(beams)])
    ranges_m[(ranges_m >= NO_ECHO_M) | (ranges_m <= 0.0)] = np.nan
    x_m, y_m, heading_rad = values[int(beams) : int(beams) + 3]
    return Scan(values[-1], x_m, y_m, heading_rad, ranges_m)


def _odometry(words: list[str]) -> Odometry:
    """ODOM x y theta tv rv accel, and the times."""
    x_m, y_m, heading_rad, speed, turning, _, time_s = _numbers(words[1:], 6)
    return Odometry(time_s, x_m, y_m, heading_rad, speed, turning)


def _numbers(words: list[str], count: int) -> list[float]:
    """So many numbers and the logger's time. Raises _LineError."""
    if len(words) != count + AFTER:
        raise _LineError(f"found {len(words)} values, expected {count + AFTER}; is it cut off?")
    wanted = [*words[:count], words[-1]]
    try:
        values = [float(word) for word in wanted]
    except ValueError as error:
        raise _LineError(f"found {error}, expected numbers") from None
    bad = [word for word, value in zip(wanted, values, strict=True) if not math.isfinite(value)]
    if bad:
        raise _LineError(f"found {bad[0]}, expected finite numbers")
    return values
