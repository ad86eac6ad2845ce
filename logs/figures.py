"""The figures of a run's page: where it went, when it decided, how well, what it believed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import plotly.colors
import plotly.graph_objects as go
from numpy.typing import NDArray
from plotly.subplots import make_subplots

from bus.messages import LedgerEntry, TrueBuilding, TruePose
from logs.analysis import grid_of
from logs.decisions import KINDS, NEVER, NS_PER_S, cause_of, on_time

Figure: TypeAlias = go.Figure

MARGINALS = "Viridis"
BLUE, GREEN, RED, GREY = "#2a6fbb", "#2c8c4a", "#c62828", "#bbbbbb"


@dataclass(frozen=True)
class BeliefAt:
    """One belief/map over the run; ``true_map`` is None where the true map was not sampled."""

    at_s: float
    entropy: float
    true_map: float | None


def building_figure(
    building: TrueBuilding, poses: list[TruePose], marginals: NDArray[np.float64] | None
) -> Figure:
    """The building, the robot's path, and the final marginal of every corridor as its colour.

    Corridors that exist are solid, those that do not are dotted.
    """
    figure = _figure("x, east (m)", "y, north (m)")
    ends = [_ends_m(building, corridor) for corridor in range(len(building.corridors))]
    for corridor, (a, b) in enumerate(ends):
        exists = bool(building.corridors[corridor])
        colour = GREY
        if marginals is not None:
            share = float(np.clip(marginals[corridor], 0.0, 1.0))
            colour = plotly.colors.sample_colorscale(MARGINALS, [share])[0]
        line = {"color": colour, "width": 9 if exists else 3, "dash": "solid" if exists else "dot"}
        x, y = [a[0], b[0]], [a[1], b[1]]
        figure.add_scatter(x=x, y=y, mode="lines", line=line, hoverinfo="skip", showlegend=False)
    if marginals is not None:
        figure.add_trace(_marginal_marks(building, ends, marginals))
    figure.add_scatter(
        x=[pose.x_m for pose in poses],
        y=[pose.y_m for pose in poses],
        mode="lines+markers",
        name="robot",
        line={"color": RED, "width": 2},
        text=[f"stop {stop}" for stop in range(len(poses))],
    )
    figure.update_xaxes(tickvals=list(building.columns_m), gridcolor="#dddddd")
    figure.update_yaxes(tickvals=list(building.rows_m), gridcolor="#dddddd", scaleanchor="x")
    return figure


def timeline_figure(ledger: list[LedgerEntry]) -> Figure:
    """A bar for each decision from asked to deadline, a mark where it was decided."""
    figure = _figure("simulated time (s)", "")
    good = [entry for entry in ledger if on_time(entry)]
    late = [entry for entry in ledger if not on_time(entry)]
    for name, entries, colour in (("on time", good, BLUE), ("late", late, RED)):
        came = [entry for entry in entries if entry.decided_ns != NEVER]
        figure.add_trace(_bars(entries, f"asked to deadline, {name}", colour))
        figure.add_scatter(
            x=[entry.decided_ns / NS_PER_S for entry in came],
            y=[entry.kind for entry in came],
            mode="markers",
            name=f"decided, {name}",
            marker={"color": colour, "size": 9, "symbol": "diamond", "line": {"width": 1}},
            text=[_words(entry) for entry in came],
            hoverinfo="text+x",
        )
    never = [entry for entry in late if entry.decided_ns == NEVER]
    figure.add_scatter(
        x=[entry.until_ns / NS_PER_S for entry in never],
        y=[entry.kind for entry in never],
        mode="markers",
        name="never decided",
        marker={"color": RED, "size": 11, "symbol": "x"},
        text=[_words(entry) for entry in never],
        hoverinfo="text+x",
    )
    figure.update_yaxes(categoryorder="array", categoryarray=_kinds(ledger)[::-1])
    return figure


def slack_figure(ledger: list[LedgerEntry]) -> Figure:
    """A histogram of the slack for each kind of decision; left of the line is late."""
    kinds = _kinds(ledger)
    figure = make_subplots(rows=1, cols=len(kinds), subplot_titles=kinds)
    for column, kind in enumerate(kinds, start=1):
        came = [e.slack_ns for e in ledger if e.kind == kind and e.decided_ns != NEVER]
        slack_s = [slack_ns / NS_PER_S for slack_ns in came]
        bars = go.Histogram(x=slack_s, marker={"color": BLUE}, showlegend=False)
        figure.add_trace(bars, row=1, col=column)
        figure.add_vline(x=0.0, line={"color": RED, "width": 2}, row=1, col=column)
    figure.update_xaxes(title="slack (s)")
    figure.update_yaxes(title="decisions", col=1)
    return _plain(figure)


def belief_figure(beliefs: list[BeliefAt]) -> Figure:
    """Entropy of the belief and probability of the true map over the run."""
    figure = make_subplots(rows=2, cols=1, shared_xaxes=True, vertical_spacing=0.08)
    times_s = [belief.at_s for belief in beliefs]
    entropy = [belief.entropy for belief in beliefs]
    true_map = [belief.true_map for belief in beliefs]
    for row, (y, name, colour) in enumerate(
        ((entropy, "entropy", BLUE), (true_map, "P(true map)", GREEN)), start=1
    ):
        line = go.Scatter(
            x=times_s, y=y, name=name, mode="lines+markers", line={"color": colour, "shape": "hv"}
        )
        figure.add_trace(line, row=row, col=1)
        figure.update_yaxes(title=name, rangemode="tozero", row=row, col=1)
    figure.update_xaxes(title="simulated time (s)", row=2, col=1)
    return _plain(figure)


def _figure(x: str, y: str) -> Figure:
    figure = go.Figure()
    figure.update_xaxes(title=x)
    figure.update_yaxes(title=y)
    return _plain(figure)


def _plain(figure: Figure) -> Figure:
    margin = {"l": 60, "r": 20, "t": 30, "b": 50}
    figure.update_layout(
        template="plotly_white", margin=margin, legend={"orientation": "h", "y": 1.1}
    )
    return figure


def _ends_m(
    building: TrueBuilding, corridor: int
) -> tuple[tuple[float, float], tuple[float, float]]:
    grid = grid_of(building)
    (ax, ay), (bx, by) = (grid.place(end) for end in grid.ends(corridor))
    x, y = building.columns_m, building.rows_m
    return (float(x[ax]), float(y[ay])), (float(x[bx]), float(y[by]))


def _marginal_marks(
    building: TrueBuilding,
    ends: list[tuple[tuple[float, float], tuple[float, float]]],
    marginals: NDArray[np.float64],
) -> go.Scatter:
    words = ["there is none", "it exists"]
    marker = {
        "color": marginals.tolist(),
        "colorscale": MARGINALS,
        "cmin": 0.0,
        "cmax": 1.0,
        "size": 12,
        "colorbar": {"title": "P(corridor)"},
    }
    return go.Scatter(
        x=[(a[0] + b[0]) / 2 for a, b in ends],
        y=[(a[1] + b[1]) / 2 for a, b in ends],
        mode="markers",
        showlegend=False,
        marker=marker,
        text=[
            f"corridor {c}: P = {p:.4f}; {words[int(building.corridors[c])]}"
            for c, p in enumerate(marginals.tolist())
        ],
        hoverinfo="text",
    )


def _bars(entries: Iterable[LedgerEntry], name: str, colour: str) -> go.Scatter:
    """All bars as one line with gaps: thousands of them stay quick to draw."""
    x: list[float | None] = []
    y: list[str | None] = []
    for entry in entries:
        x += [entry.asked_ns / NS_PER_S, entry.until_ns / NS_PER_S, None]
        y += [entry.kind, entry.kind, None]
    line = {"color": colour, "width": 12}
    return go.Scatter(x=x, y=y, mode="lines", name=name, line=line, opacity=0.35, connectgaps=False)


def _kinds(ledger: list[LedgerEntry]) -> list[str]:
    return list(dict.fromkeys((*KINDS, *(entry.kind for entry in ledger))))


def _words(entry: LedgerEntry) -> str:
    if on_time(entry):
        return f"decision {entry.decision}, slack {entry.slack_ns / NS_PER_S:.3f} s"
    return f"decision {entry.decision}, late: {cause_of(entry)}"
