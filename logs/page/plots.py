"""Plots of a page: SVG with axes, whose colours come from the page's style by class."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from bus.messages import LedgerEntry
from logs.decisions import NEVER, NS_PER_S
from logs.page.record import Believed
from logs.page.tables import table
from logs.page.thin import evenly

MOST_STEPS = 1500
BINS = 24

WIDTH, HEIGHT = 720, 130
LEFT, RIGHT, TOP, BOTTOM = 56, 12, 22, 24
"""Size of a plot and of the room for its labels, in units of its viewBox."""


def slack_bins(slack_ns: Sequence[int]) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Numbers in each bin of a histogram, and its edges in seconds, of which one is 0.

    Hence no bar is both late and in time. Counted in whole nanoseconds, so that nothing is lost
    at an edge; a bin holds its lower edge.
    """
    lowest, highest = min(0, *slack_ns), max(0, *slack_ns)
    wide = max(1, -((lowest - highest) // (BINS - 2)))
    first, last = lowest // wide, highest // wide
    which = [ns // wide - first for ns in slack_ns]
    counts = np.bincount(which, minlength=last - first + 1).astype(np.int64)
    edges = np.arange(first, last + 2, dtype=np.float64) * wide / NS_PER_S
    return counts, edges


def slack_figure(kind: str, entries: Sequence[LedgerEntry]) -> str:
    """Histogram of the slack of the decisions of one kind; "" where none was ever decided."""
    slack_ns = [entry.slack_ns for entry in entries if entry.decided_ns != NEVER]
    if not slack_ns:
        return ""
    counts, edges = slack_bins(slack_ns)
    tallest = int(counts.max())
    across, up = _Axis(edges[0], edges[-1], LEFT, WIDTH - RIGHT), _upward(0, tallest)
    parts: list[str] = []
    rows: list[tuple[str, str]] = []
    for number, low, high in zip(counts.tolist(), edges, edges[1:], strict=False):
        if number == 0:
            continue
        late = "late" if high <= 0 else "good"
        of = f"{low:,.1f} s to {high:,.1f} s"
        told = f"<title>{number}: slack {of}</title>"
        left, wide = across(low), max(1.0, across(high) - across(low) - 1)
        parts.append(
            f'<rect class="{late}" x="{left:.1f}" y="{up(number):.1f}" width="{wide:.1f}" '
            f'height="{HEIGHT - BOTTOM - up(number):.1f}">{told}</rect>'
        )
        rows.append((of, str(number)))
    parts.append(_upright("zero", across(0.0)))
    parts += [_label(across(v), f"{v:,.4g} s") for v in (edges[0], edges[-1]) if v]
    parts.append(_label(across(0.0), "0", TOP - 8))
    parts.append(_side(up(tallest) + 4, str(tallest)))
    lates = sum(slack < 0 for slack in slack_ns)
    words = f"{len(slack_ns)} {kind} decisions came, {lates} of them late"
    name = f"slack-{kind}"
    return _figure(name, f"Slack of {kind} decisions", words, parts) + _as_table(
        ("slack", "decisions"), rows
    )


def belief_figures(beliefs: Sequence[Believed], duration_s: float) -> str:
    """Entropy, probability of the true map, and corridors right, wrong and open over the run."""
    shown = evenly(beliefs, MOST_STEPS)
    times_s = [belief.at_ns / NS_PER_S for belief in shown]
    end_s = max(duration_s, times_s[-1])
    entropy = [belief.compared.entropy for belief in shown]
    sampled = [belief.compared.true_map if belief.compared.sampled else None for belief in shown]
    right = [belief.compared.right for belief in shown]
    wrong = [belief.compared.wrong for belief in shown]
    unsettled = [belief.compared.open for belief in shown]
    plots = (
        ("entropy", "Entropy of the belief over maps (nats)", ((entropy, "good"),)),
        ("true-map", "Probability of the true map", ((sampled, "good"),)),
        (
            "corridors",
            "Corridors known rightly (solid), not known (dashed), known wrongly (dotted)",
            ((right, "good"), (unsettled, "open"), (wrong, "late")),
        ),
    )
    drawn = [_steps(name, title, times_s, lines, end_s) for name, title, lines in plots]
    rows = [
        (
            f"{at_s:,.1f}",
            f"{belief.compared.entropy:.3f}",
            f"{belief.compared.true_map:.6f}" if belief.compared.sampled else "not sampled",
            f"{belief.compared.right}",
            f"{belief.compared.wrong}",
            f"{belief.compared.open}",
        )
        for at_s, belief in list(zip(times_s, shown, strict=True))[-200:]
    ]
    head = ("time (s)", "entropy", "P(true map)", "right", "wrong", "open")
    return "".join(drawn) + _as_table(head, rows)


class _Axis:
    """From a value to a position, along one side of a plot."""

    def __init__(self, low: float, high: float, begin: float, end: float) -> None:
        self._low, self._scale, self._begin = low, (end - begin) / ((high - low) or 1.0), begin

    def __call__(self, value: float) -> float:
        return self._begin + (value - self._low) * self._scale


def _upward(low: float, high: float) -> _Axis:
    return _Axis(low, high, HEIGHT - BOTTOM, TOP)


def _steps(
    name: str,
    title: str,
    times_s: list[float],
    lines: Sequence[tuple[Sequence[float | None], str]],
    end_s: float,
) -> str:
    highest = max((v for values, _ in lines for v in values if v is not None), default=0.0) or 1.0
    across, up = _Axis(0.0, end_s, LEFT, WIDTH - RIGHT), _upward(0.0, highest)
    parts: list[str] = []
    for values, kind in lines:
        path = _step_path([across(t) for t in (*times_s, end_s)], values, up)
        parts.append(f'<path class="step {kind}" d="{path}"/>')
    parts += [_label(across(v), f"{v:,.0f} s") for v in (0.0, end_s / 2, end_s)]
    parts += [_side(up(highest) + 4, f"{highest:.3g}"), _side(up(0.0), "0")]
    parts.append(_upright("now", across(0.0)))
    (first, _), *_ = lines
    words = f"from {_number(first[0])} at {times_s[0]:,.0f} s to {_number(first[-1])} at the end"
    return _figure(f"belief-{name}", title, words, parts, f'data-end="{end_s:g}"')


def _number(value: float | None) -> str:
    return "not sampled" if value is None else f"{value:.3g}"


def _step_path(x: Sequence[float], values: Sequence[float | None], up: _Axis) -> str:
    """A step for each value to the next place; none where there is no value."""
    parts: list[str] = []
    pen_down = False
    for left, right, value in zip(x, x[1:], values, strict=False):
        if value is None:
            pen_down = False
            continue
        parts.append(f"{'V' if pen_down else f'M{left:.1f} '}{up(value):.1f}H{right:.1f}")
        pen_down = True
    return "".join(parts)


def _figure(name: str, title: str, words: str, parts: list[str], more: str = "") -> str:
    base = HEIGHT - BOTTOM
    return (
        f'<figure id="{escape(name)}"><figcaption>{escape(title)}: {escape(words)}.</figcaption>'
        f'<svg class="plot" role="img" aria-label="{escape(title)}: {escape(words)}" {more} '
        f'viewBox="0 0 {WIDTH} {HEIGHT}">'
        f'<path class="axis" d="M{LEFT} {TOP}V{base}H{WIDTH - RIGHT}"/>{"".join(parts)}'
        "</svg></figure>"
    )


def _upright(kind: str, x: float) -> str:
    return f'<line class="{kind}" x1="{x:.1f}" x2="{x:.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}"/>'


def _label(x: float, words: str, y: float = HEIGHT - 6) -> str:
    end = "start" if x < LEFT + 20 else "end" if x > WIDTH - RIGHT - 20 else "middle"
    return f'<text x="{x:.1f}" y="{y}" text-anchor="{end}">{words}</text>'


def _side(y: float, words: str) -> str:
    return f'<text x="{LEFT - 6}" y="{y:.1f}" text-anchor="end">{words}</text>'


def _as_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    return f"<details><summary>as a table</summary>{table(head, rows)}</details>"
