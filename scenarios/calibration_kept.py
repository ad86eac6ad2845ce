"""The finished part of a calibration on disk, so that one that was killed goes on.

A file of JSON lines beside the result: a head that says which calibration it is, then the tally
of each task in order, written as it is done. A last line that was cut off counts as not done.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from bus.features import Wedges
from scenarios.detector_tally import Tally, tally_of

ROOT = Path(__file__).parents[1]
SOURCES = (
    "modules/detectors",
    "modules/classifier/geometry.py",
    "bus/features.py",
    "simworld/building.py",
    "simworld/fittings.py",
    "simworld/raycast.py",
    "simworld/sonar.py",
    "scenarios/calibrate_detectors.py",
    "scenarios/detector_tally.py",
    "scenarios/trial_junction.py",
)
"""What a trial's outcome comes from."""


class KeptError(ValueError):
    """A kept part that is of another calibration, or no kept part at all."""


class Kept:
    """The kept part of one calibration. ``head`` says which: trials, seed, ring and so on."""

    def __init__(self, path: Path, head: Mapping[str, Any], wedges: Wedges) -> None:
        self.path = path
        self._wedges = wedges
        self._head = json.loads(json.dumps({**head, "code": code_fingerprint()}))

    def done(self) -> list[Tally]:
        """The tallies of the tasks that were done, in order; begins the file if there is none.

        What follows the last whole line is cut off. Raises KeptError and OSError.
        """
        if not self.path.exists():
            self._append(self._head)
            return []
        lines = self._whole_lines()
        head = next(lines, None)
        if head != self._head:
            raise KeptError(f"{self.path}: {self._difference(head)}; delete it to begin anew")
        return list(lines)

    def keep(self, tally: Tally) -> None:
        """Write down one more task. Raises OSError."""
        self._append(tally.as_lists())

    def remove(self) -> None:
        """The calibration is finished."""
        self.path.unlink()

    def _append(self, line: Any) -> None:
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")

    def _whole_lines(self) -> Iterator[Any]:
        content = self.path.read_bytes()
        end = content.rfind(b"\n") + 1
        if end < len(content):
            with self.path.open("r+b") as file:
                file.truncate(end)
        return self._read(content[:end].decode("utf-8", errors="replace"))

    def _read(self, text: str) -> Iterator[Any]:
        for number, line in enumerate(text.splitlines()):
            try:
                found = json.loads(line)
                yield found if number == 0 else tally_of(found, self._wedges)
            except (KeyError, TypeError, ValueError) as error:
                raise KeptError(
                    f"{self.path}: line {number + 1}: found {error}, expected the kept part of a "
                    "calibration; delete it to begin anew"
                ) from error

    def _difference(self, head: Any) -> str:
        if not isinstance(head, dict):
            return "found no head, expected the kept part of a calibration"
        keys = [key for key in self._head if head.get(key) != self._head[key]]
        found = ", ".join(f"{key} {head.get(key)!r}" for key in keys)
        expected = ", ".join(f"{key} {self._head[key]!r}" for key in keys)
        return f"kept part of another calibration: found {found}, expected {expected}"


def code_fingerprint() -> str:
    """A hash of the code that decides what a trial finds: its counts must not be mixed."""
    digest = hashlib.sha256()
    for source in SOURCES:
        path = ROOT / source
        for file in sorted(path.glob("*.py")) if path.is_dir() else [path]:
            digest.update(file.read_bytes())
    return digest.hexdigest()[:12]
