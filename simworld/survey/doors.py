"""Doors of a floor plan, from a doors.yaml file of the BWI project.

The format is that of utexas-bwi/bwi_common, ``multi_level_map``: a list of doors, each with
``name`` and the world positions ``door_corner_pt_1`` and ``door_corner_pt_2``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from simworld.survey.errors import SurveyError

CORNERS = ("door_corner_pt_1", "door_corner_pt_2")


@dataclass(frozen=True)
class Door:
    """A door's name and its two corners in the plan's world frame, in metres."""

    name: str
    from_m: tuple[float, float]
    to_m: tuple[float, float]


def read_doors(path: Path | str) -> tuple[Door, ...]:
    """The doors of a doors.yaml file. Raises SurveyError that names file, door and key."""
    path = Path(path)
    try:
        listed = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        said = error.strerror if isinstance(error, OSError) else str(error)
        found = " ".join(str(said).split())
        raise SurveyError(f"{path}: found {found}, expected a doors.yaml file") from error
    if not isinstance(listed, list):
        raise SurveyError(f"{path}: found {type(listed).__name__}, expected a list of doors")
    return tuple(_door(path, number, entry) for number, entry in enumerate(listed))


def _door(path: Path, number: int, entry: Any) -> Door:
    if not isinstance(entry, dict):
        raise SurveyError(f"{path}: door {number}: found {entry!r}, expected keys and values")
    first, second = (_corner(path, number, entry, key) for key in CORNERS)
    return Door(str(entry.get("name", number)), first, second)


def _corner(path: Path, number: int, entry: dict[str, Any], key: str) -> tuple[float, float]:
    value = entry.get(key)
    numbers = value if isinstance(value, list) else []
    if len(numbers) == 2 and all(isinstance(v, int | float) and math.isfinite(v) for v in numbers):
        return float(numbers[0]), float(numbers[1])
    found = f"{value!r}" if key in entry else "no such key"
    raise SurveyError(f"{path}: door {number}: {key}: found {found}, expected x and y in metres")
