"""What a calibration found, for people: calibration curves and Brier scores by detector."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from bus.features import FEATURES
from modules.classifier.sensor_model import SensorModel
from scenarios.detector_tally import HELD, STATED, TRIALS, Tally


@dataclass(frozen=True)
class CurvePoint:
    """Of the findings that stated about this probability, how many there were, how often X held.

    ``low`` and ``high`` bound that share with 95 % (Jeffreys).
    """

    feature: str
    stated: float
    held: float
    low: float
    high: float
    findings: int


@dataclass(frozen=True)
class DetectorRow:
    """One detector: share of classes that agree with X, and the Brier score of what it stated.

    ``base_brier`` is the score of always stating how often X holds: 0 for what never varies.
    """

    feature: str
    wedge: int
    trials: int
    present: float
    right: float
    brier: float
    base_brier: float
    takes_s: float


def curve(tally: Tally) -> list[CurvePoint]:
    """The calibration curve of each feature; empty bins are left out.

    Over those of its detectors whose feature was there in some trials and not in others: what
    never varies calibrates nothing.
    """
    from scipy.special import betaincinv  # here, since most commands do without

    points = []
    of_x = tally.counts.sum(axis=3)
    varying = (of_x > 0).all(axis=2)
    for f, sums in enumerate((tally.binned * varying[..., None, None]).sum(axis=1)):
        for found in sums[sums[:, TRIALS] > 0]:
            n, held = found[TRIALS], found[HELD]
            low, high = betaincinv(held + 0.5, n - held + 0.5, [0.025, 0.975])
            points.append(CurvePoint(FEATURES[f], found[STATED] / n, held / n, low, high, int(n)))
    return points


def detector_rows(model: SensorModel, tally: Tally) -> list[DetectorRow]:
    """Every detector, in the order of their codes."""
    rows = []
    for f, feature in enumerate(FEATURES):
        for w in range(model.wedges.count):
            counts = model.counts[f, w]
            trials = int(counts.sum())
            present = float(counts[1].sum() / trials)
            right = float((counts[0, :2].sum() + counts[1, 2:].sum()) / trials)
            rows.append(
                DetectorRow(
                    feature,
                    w,
                    trials,
                    present,
                    right,
                    float(tally.brier[f, w]),
                    present * (1.0 - present),
                    float(model.durations_s[f, w]),
                )
            )
    return rows


def show(model: SensorModel, tally: Tally, console: Console) -> None:
    """The report as text."""
    for title, columns, rows in _tables(model, tally):
        table = Table(title=title)
        for name in columns:
            table.add_column(name, justify="right")
        for row in rows:
            table.add_row(*row)
        console.print(table)


def page(model: SensorModel, tally: Tally) -> str:
    """The report as one HTML page that needs nothing else."""
    parts = [_picture(name, [p for p in curve(tally) if p.feature == name]) for name in FEATURES]
    for title, columns, rows in _tables(model, tally):
        head = "".join(f"<th>{escape(name)}</th>" for name in columns)
        body = "".join(
            "<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows
        )
        parts.append(f"<h2>{escape(title)}</h2><table><tr>{head}</tr>{body}</table>")
    return _PAGE.format(made_by=escape(model.made_by), parts="\n".join(parts))


_Table = tuple[str, tuple[str, ...], list[tuple[str, ...]]]


def _tables(model: SensorModel, tally: Tally) -> list[_Table]:
    detectors: list[tuple[str, ...]] = [
        (
            r.feature, str(r.wedge), str(r.trials), f"{r.present:.3f}", f"{r.right:.4f}",
            f"{r.brier:.4f}", f"{r.base_brier:.4f}", f"{r.takes_s:.1f}",
        )
        for r in detector_rows(model, tally)
    ]  # fmt: skip
    points: list[tuple[str, ...]] = [
        (p.feature, f"{p.stated:.3f}", f"{p.held:.3f}", f"{p.low:.3f} - {p.high:.3f}",
         str(p.findings))
        for p in curve(tally)
    ]  # fmt: skip
    return [
        (
            "detectors: share of classes that agree with X; Brier score of the stated probability",
            ("feature", "wedge", "trials", "X holds", "right", "Brier", "of the base rate", "s"),
            detectors,
        ),
        (
            "calibration: how often X held where a detector stated a probability",
            ("feature", "stated", "held", "95 %", "findings"),
            points,
        ),
    ]


def _picture(name: str, points: list[CurvePoint]) -> str:
    """A calibration curve: stated probability to the right, share held upwards."""

    def at(x: float, y: float) -> tuple[str, str]:
        return f"{40 + 240 * x:.1f}", f"{260 - 240 * y:.1f}"

    marks = []
    for p in points:
        (x, y), (_, low), (_, high) = (at(p.stated, v) for v in (p.held, p.low, p.high))
        marks.append(
            f'<line x1="{x}" y1="{low}" x2="{x}" y2="{high}"/><circle cx="{x}" cy="{y}" r="4">'
            f"<title>stated {p.stated:.3f}, held {p.held:.3f} of {p.findings}</title></circle>"
        )
    return (
        f'<svg viewBox="0 0 300 300" width="300" role="img"><title>{escape(name)}</title>'
        f'<rect x="40" y="20" width="240" height="240"/><path d="M40 260 280 20"/>'
        f'{"".join(marks)}<text x="160" y="292">{escape(name)}: stated</text>'
        '<text x="-140" y="24" transform="rotate(-90)">held</text></svg>'
    )


def as_object(model: SensorModel, tally: Tally) -> dict[str, Any]:
    """The report as one JSON object."""
    return {
        "made_by": model.made_by,
        "brier": float(np.mean(tally.brier)),
        "detectors": [vars(row) for row in detector_rows(model, tally)],
        "curve": [{k: float(v) if k != "feature" else v for k, v in vars(p).items()}
                  for p in curve(tally)],
    }  # fmt: skip


_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Detectors calibrated</title><style>
body {{ font: 15px/1.4 system-ui, sans-serif; margin: 2em; max-width: 60em }}
td, th {{ padding: 0 .8em; text-align: right; font-variant-numeric: tabular-nums }}
svg {{ font-size: 13px; text-anchor: middle }}
rect, path {{ fill: none; stroke: #999 }} line, circle {{ stroke: #06c; fill: #06c }}
</style></head><body><h1>Detectors calibrated</h1><p>{made_by}</p>
{parts}
</body></html>
"""
