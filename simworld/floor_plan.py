"""Floor plans of real buildings: ROS map_server maps as surroundings that reflect sound.

A plan keeps the image's own cells. Turning it upright or shifting it changes only the pose of the
image in the world (``origin_m``, ``turn_rad``); whoever casts rays takes the robot's pose into the
image's frame instead of resampling the image.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError
from scipy import ndimage

SMOOTHING_M = 0.1
"""Walls are as straight as their direction over about this far; at least one cell."""

COHERENT = 0.7
"""A cell whose surroundings have one wall direction less than this is an edge or clutter."""


GREYS, MOSTLY = 16, 0.6
"""Of so many greys three make up at least this share of a floor plan; of the real ones at hand they
make up 0.95 and more, of a picture of something else some 0.4."""


class FloorPlanError(ValueError):
    """A map file that is missing or does not say what map_server expects."""


@dataclass(frozen=True, eq=False)
class Cells:
    """An occupancy grid in its image's frame. Arrays are (rows, columns), row 0 at the bottom.

    - ``occupied``, ``free``: bool; a cell that is neither is unknown, and sound passes it.
    - ``resolution_m``: side of a cell.
    """

    occupied: NDArray[np.bool_]
    free: NDArray[np.bool_]
    resolution_m: float

    @cached_property
    def clearances_m(self) -> NDArray[np.float64]:
        """Distance from the middle of each cell to that of the nearest one that is not free."""
        distances = ndimage.distance_transform_edt(np.pad(self.free, 1))[1:-1, 1:-1]
        return np.asarray(distances * self.resolution_m, dtype=np.float64)

    @cached_property
    def normals_rad(self) -> NDArray[np.float32]:
        """Direction of the wall's normal at each cell, modulo a half turn.

        From the structure tensor of the smoothed occupied cells (Bigün and Granlund, Optimal
        orientation detection of linear symmetry, 1987); nan where no direction prevails, at
        corners, wall ends and clutter, which reflect whatever the incidence. Where a wall nearly
        along the rows steps by one cell, the step tilts its normal, by up to 7 degrees.
        """
        xx, xy, yy = self._structure
        normals = 0.5 * np.arctan2(2.0 * xy, xx - yy)
        normals[np.hypot(xx - yy, 2.0 * xy) < COHERENT * (xx + yy)] = np.nan
        return normals.astype(np.float32)

    @cached_property
    def wall_turn_rad(self) -> float:
        """How far the walls stand counter-clockwise of upright, in [-pi/4, pi/4].

        The circular mean of four times the direction of each wall's normal.
        """
        xx, xy, yy = self._structure
        # The tensor holds twice the angle, so its square holds four times the angle.
        doubled = (xx - yy) + 2.0j * xy
        size = np.abs(doubled)
        fourfold = (doubled**2 / np.where(size > 0.0, size, 1.0)).sum()
        return float(np.angle(fourfold)) / 4.0

    @cached_property
    def _structure(self) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Structure tensor xx, xy, yy of the occupied cells."""
        sigma = max(1.0, SMOOTHING_M / self.resolution_m)
        solid = self.occupied.astype(np.float64)
        up, across = (ndimage.gaussian_filter(solid, sigma, order) for order in ((1, 0), (0, 1)))
        products = (across * across, across * up, up * up)
        xx, xy, yy = (ndimage.gaussian_filter(p, sigma) for p in products)
        return xx, xy, yy


@dataclass(frozen=True, eq=False)
class FloorPlan:
    """Cells and where they lie in the world.

    ``origin_m`` is the world position of the outer corner of cell [0, 0], ``turn_rad`` the
    direction of the rows there, counter-clockwise from east.
    """

    cells: Cells
    origin_m: tuple[float, float]
    turn_rad: float

    def to_image(self, x_m: Any, y_m: Any) -> tuple[Any, Any]:
        """World to image frame: metres along rows and columns from the origin, any shape."""
        c, s = math.cos(self.turn_rad), math.sin(self.turn_rad)
        dx, dy = x_m - self.origin_m[0], y_m - self.origin_m[1]
        return c * dx + s * dy, c * dy - s * dx

    def to_world(self, u_m: Any, v_m: Any) -> tuple[Any, Any]:
        """The inverse of :meth:`to_image`."""
        c, s = math.cos(self.turn_rad), math.sin(self.turn_rad)
        return self.origin_m[0] + c * u_m - s * v_m, self.origin_m[1] + s * u_m + c * v_m

    def moved(self, turn_rad: float, shift_m: tuple[float, float] = (0.0, 0.0)) -> FloorPlan:
        """The plan turned about the world's origin, counter-clockwise, and then shifted."""
        c, s = math.cos(turn_rad), math.sin(turn_rad)
        x, y = self.origin_m
        origin = (c * x - s * y + shift_m[0], s * x + c * y + shift_m[1])
        return replace(self, origin_m=origin, turn_rad=self.turn_rad + turn_rad)

    def upright(self) -> FloorPlan:
        """The plan turned about the world's origin, by the least angle that makes walls upright."""
        off = self.cells.wall_turn_rad + self.turn_rad
        return self.moved(-math.remainder(off, math.pi / 2.0))

    def clearance_m(self, x_m: Any, y_m: Any) -> NDArray[np.float64]:
        """Distance to the nearest cell that is not free; 0 in such a cell and off the plan.

        Takes world coordinates, numbers or arrays of one shape, and returns that shape.
        """
        u, v = self.to_image(np.asarray(x_m), np.asarray(y_m))
        column = np.floor(u / self.cells.resolution_m).astype(np.int64)
        row = np.floor(v / self.cells.resolution_m).astype(np.int64)
        rows, columns = self.cells.free.shape
        on_plan = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        found = self.cells.clearances_m[row.clip(0, rows - 1), column.clip(0, columns - 1)]
        return np.where(on_plan, found, 0.0)


def read_floor_plan(path: Path | str) -> FloorPlan:
    """Read a map_server map: a YAML file beside the image that it names (PNG, PGM and the like).

    The colour channels are averaged to a; the probability of being occupied is (255 - a) / 255,
    or a / 255 with ``negate``; above ``occupied_thresh`` a cell is occupied, below
    ``free_thresh`` free (ROS map_server, trinary and scale mode). Transparency is ignored.

    Raises FloorPlanError, naming file, key, what was found and what was expected.
    """
    path = Path(path)
    said = _Keys(path, _yaml(path))
    mode = said.values.get("mode", "trinary")
    if mode not in ("trinary", "scale"):
        raise said.error("mode", "'trinary' or 'scale'")
    resolution_m = said.number("resolution", 1e-9, math.inf, "a positive number of metres")
    x, y, turn_rad = said.origin()
    negate = said.number("negate", 0, 1, "0 or 1")
    occupied_above = said.number("occupied_thresh", 0.0, 1.0, "a number from 0 to 1")
    free_below = said.number(
        "free_thresh", 0.0, occupied_above, f"a number from 0 to occupied_thresh, {occupied_above}"
    )
    grey = _grey(said.image())
    probability = grey if negate else 1.0 - grey
    cells = Cells(
        occupied=_frozen(probability > occupied_above),
        free=_frozen(probability < free_below),
        resolution_m=resolution_m,
    )
    return FloorPlan(cells, origin_m=(x, y), turn_rad=turn_rad)


@dataclass(frozen=True)
class _Keys:
    """The keys of one map file, read with errors that name it."""

    path: Path
    values: dict[str, Any]

    def error(self, key: str, expected: str) -> FloorPlanError:
        found = f"{self.values[key]!r}" if key in self.values else "no such key"
        return FloorPlanError(f"{self.path}: {key}: found {found}, expected {expected}")

    def number(self, key: str, low: float, high: float, expected: str) -> float:
        value = _number(self.values.get(key))
        if not low <= value <= high:
            raise self.error(key, expected)
        return value

    def origin(self) -> tuple[float, float, float]:
        value = self.values.get("origin")
        numbers = [_number(v) for v in value] if isinstance(value, list) else []
        if len(numbers) != 3 or not np.isfinite(numbers).all():
            raise self.error("origin", "three numbers: x and y in metres, turn in radians")
        return numbers[0], numbers[1], numbers[2]

    def image(self) -> Path:
        value = self.values.get("image")
        if not isinstance(value, str):
            raise self.error("image", "the name of an image file")
        return self.path.parent / value


def _number(value: object) -> float:
    """The value if it is a finite number, else nan, which no bounds admit."""
    if isinstance(value, int | float) and math.isfinite(value):
        return float(value)
    return math.nan


def _yaml(path: Path) -> dict[str, Any]:
    try:
        values = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        found = " ".join(_said(error).split())
        raise FloorPlanError(f"{path}: found {found}, expected a map_server YAML file") from error
    if not isinstance(values, dict):
        raise FloorPlanError(
            f"{path}: found {type(values).__name__}, expected keys and values as map_server's"
        )
    return values


def _said(error: Exception) -> str:
    """What the system said, without the number and the path that the message has already."""
    return (error.strerror if isinstance(error, OSError) else None) or str(error)


def _grey(path: Path) -> NDArray[np.float64]:
    """Mean of the colour channels in 0..1, row 0 at the bottom of the image."""
    try:
        with Image.open(path) as image:
            if image.mode not in ("1", "L", "LA", "P", "RGB", "RGBA"):
                raise FloorPlanError(f"{path}: found mode {image.mode}, expected 8 bits a channel")
            channels = np.asarray(image.convert("RGB"), dtype=np.float64)
    except UnidentifiedImageError as error:
        raise FloorPlanError(f"{path}: found no image in it, expected an image file") from error
    except OSError as error:
        raise FloorPlanError(f"{path}: found {_said(error)}, expected an image file") from error
    grey = np.ascontiguousarray(channels.mean(axis=2)[::-1] / 255.0)
    _check_few_greys(path, grey)
    return grey


def _check_few_greys(path: Path, grey: NDArray[np.float64]) -> None:
    """Raise FloorPlanError for a picture that shows something else."""
    counted, _ = np.histogram(grey, GREYS, (0.0, 1.0))
    share = np.sort(counted)[-3:].sum() / grey.size
    if share < MOSTLY:
        raise FloorPlanError(
            f"{path}: found a picture of many greys (the commonest three of {GREYS} make up "
            f"{share:.0%} of it), expected a floor plan: free, occupied and unknown"
        )


def _frozen(array: NDArray[np.bool_]) -> NDArray[np.bool_]:
    array.setflags(write=False)
    return array
