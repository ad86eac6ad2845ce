"""Does the cost model hold? What handlers took on the machine, beside what the profile says."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bus.messages import WallSpan
from logs.reader import read_run


@dataclass(frozen=True)
class CostCheck:
    """One kind of handler: its measured and modelled medians, and their totals' ratio.

    ``ratio`` is measured over modelled time (None where the profile says it costs nothing);
    ``correlation`` is that of cells with measured time (None where either never varies).
    """

    process: str
    topic: str
    handlers: int
    cells: int
    measured_median_s: float
    modelled_median_s: float
    ratio: float | None
    correlation: float | None


def wall_path(log: Path) -> Path:
    """Where the wall stamps of a run are: beside its log."""
    return log.with_suffix(".wall.mcap")


def cost_checks(log: Path) -> tuple[CostCheck, ...]:
    """One row for each kind of handler, the most expensive first; none without a wall log.

    Raises LogReadError where there is a wall log that cannot be read.
    """
    path = wall_path(log)
    if not path.is_file():
        return ()
    rows: dict[tuple[str, str], list[tuple[int, int, int]]] = {}
    with read_run(path, ("wall/span",)) as reader:
        for sent in reader:
            span = sent.message
            if isinstance(span, WallSpan):
                work = (span.cells, span.modelled_ns, span.took_ns)
                rows.setdefault((span.process, span.topic), []).append(work)
    checks = [_check(process, topic, work) for (process, topic), work in rows.items()]
    return tuple(sorted(checks, key=lambda c: -c.handlers * c.measured_median_s))


def _check(process: str, topic: str, work: list[tuple[int, int, int]]) -> CostCheck:
    cells, modelled_ns, took_ns = np.array(work, dtype=np.float64).T
    varies = len(work) > 2 and cells.std() > 0.0 and took_ns.std() > 0.0
    return CostCheck(
        process,
        topic,
        len(work),
        int(cells.sum()),
        float(np.median(took_ns)) / 1e9,
        float(np.median(modelled_ns)) / 1e9,
        float(took_ns.sum() / modelled_ns.sum()) if modelled_ns.sum() else None,
        float(np.corrcoef(cells, took_ns)[0, 1]) if varies else None,
    )
