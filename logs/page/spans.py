"""When each process was at work: handler spans, merged until there are few enough to draw."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from bus.messages import Span
from bus.topics import PRIORITY

MOST = 1500
"""Stretches of work a process at most: about one a pixel of a wide screen."""


@dataclass
class Stretch:
    """Handlers of one process that ran with no more than a small gap between them."""

    start_ns: int
    end_ns: int
    handlers: int
    busy_ns: int
    cells: int


class Spans:
    """The stretches of work of every process, the gap growing with their number."""

    def __init__(self) -> None:
        self._rows: dict[str, list[Stretch]] = {}
        self._gap_ns: dict[str, int] = {}

    def hear(self, span: Span) -> None:
        """Add one handler's span; those of a process must come in order."""
        row = self._rows.setdefault(span.process, [])
        own = Stretch(span.start_ns, span.end_ns, 1, span.end_ns - span.start_ns, span.cells)
        if not row or not _join(row[-1], own, self._gap_ns.get(span.process, 0)):
            row.append(own)
        if len(row) > 2 * MOST:
            self._thin(span.process)

    def _thin(self, process: str) -> None:
        """Halve the number of stretches by closing the smaller half of the gaps."""
        row = self._rows[process]
        gaps = sorted(b.start_ns - a.end_ns for a, b in pairwise(row))
        self._gap_ns[process] = gap_ns = gaps[len(gaps) // 2]
        fewer = row[:1]
        for stretch in row[1:]:
            if not _join(fewer[-1], stretch, gap_ns):
                fewer.append(stretch)
        self._rows[process] = fewer

    def rows(self) -> dict[str, list[Stretch]]:
        """The stretches by process, the processes in the order of their priority."""
        return {name: self._rows[name] for name in sorted(self._rows, key=_rank)}

    @property
    def coarsest_s(self) -> float:
        """The longest gap that is not shown, in seconds."""
        return max(self._gap_ns.values(), default=0) / 1e9


def _rank(process: str) -> tuple[int, str]:
    return PRIORITY.get(process, len(PRIORITY)), process


def _join(last: Stretch, next_one: Stretch, gap_ns: int) -> bool:
    """Make the last stretch include the next one if the gap between them is small."""
    if next_one.start_ns - last.end_ns > gap_ns:
        return False
    last.end_ns = max(last.end_ns, next_one.end_ns)
    last.handlers += next_one.handlers
    last.busy_ns += next_one.busy_ns
    last.cells += next_one.cells
    return True
