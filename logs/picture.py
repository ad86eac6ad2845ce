"""A run as one self-contained HTML page, made from one pass over its log."""

from __future__ import annotations

from html import escape
from pathlib import Path

import numpy as np
import plotly.io
from numpy.typing import NDArray

from bus.messages import MapBelief, TrueBuilding, TruePose
from bus.wire import Sent
from logs.analysis import HEARD, Analysis, Tally
from logs.belief import fits, true_map_probability
from logs.decisions import NS_PER_S
from logs.figures import (
    BeliefAt,
    Figure,
    belief_figure,
    building_figure,
    slack_figure,
    timeline_figure,
)
from logs.reader import read_run
from logs.report import seconds, title
from logs.run_log import LogWriteError

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 70rem; margin: 2rem auto;
       padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin: 2rem 0 0; }
figure { margin: 0; } figcaption { color: #555; }
table { border-collapse: collapse; } th, td { padding: .2rem .8rem; text-align: right; }
th:first-child, td:first-child { text-align: left; } tr { border-bottom: 1px solid #ddd; }
"""


class _Scenes:
    """What the figures need of a log beside its analysis."""

    def __init__(self) -> None:
        self.building: TrueBuilding | None = None
        self.poses: list[TruePose] = []
        self.beliefs: list[BeliefAt] = []
        self.marginals: NDArray[np.float64] | None = None

    def hear(self, sent: Sent) -> None:
        match sent.message:
            case TrueBuilding() as building:
                self.building = building
            case TruePose() as pose:
                self.poses.append(pose)
            case MapBelief() as belief:
                self._believe(belief, sent.said_ns / NS_PER_S)

    def _believe(self, belief: MapBelief, at_s: float) -> None:
        true_map: float | None = None
        if self.building is not None and fits(belief, self.building):
            self.marginals = belief.corridors
            true_map = true_map_probability(belief, self.building)
        self.beliefs.append(BeliefAt(at_s, belief.entropy, true_map))


def write_page(path_in: str | Path, path_out: str | Path) -> Analysis:
    """Draw a log as one HTML page that needs nothing else; returns its analysis.

    Raises LogReadError if ``path_in`` is not the log of a run, LogWriteError if ``path_out``
    cannot be written.
    """
    tally, scenes = Tally(), _Scenes()
    with read_run(path_in, (*HEARD, "truth/pose")) as reader:
        for sent in reader:
            tally.hear(sent)
            scenes.hear(sent)
    analysis = tally.analysis(reader)
    page = _page(analysis, _figures(tally, scenes))
    try:
        Path(path_out).write_text(page, encoding="utf-8")
    except OSError as error:
        raise LogWriteError(f"{path_out}: cannot write the page: {error.strerror}") from error
    return analysis


def _figures(tally: Tally, scenes: _Scenes) -> list[tuple[str, str, Figure]]:
    """Heading, words for those who do not see it, figure."""
    figures = [
        (
            "Decisions over time",
            "A bar for each decision from when it was asked to its deadline, with a diamond where "
            "it was decided; late ones are red.",
            timeline_figure(tally.ledger),
        ),
        (
            "Slack",
            "Histogram of the slack for each kind of decision; left of the red line is late.",
            slack_figure(tally.ledger),
        ),
    ]
    if scenes.beliefs:
        words = "Entropy of the belief over maps, and probability of the true map, over the run."
        figures.append(("Belief", words, belief_figure(scenes.beliefs)))
    if scenes.building is not None:
        words = (
            "Map of the building: corridors that exist are solid, others dotted, coloured by the "
            "final belief that they exist; the red line is the robot's path."
        )
        drawn = building_figure(scenes.building, scenes.poses, scenes.marginals)
        figures.insert(0, ("Building", words, drawn))
    return figures


def _page(analysis: Analysis, figures: list[tuple[str, str, Figure]]) -> str:
    parts = [
        '<!doctype html><html lang="en"><head><meta charset="utf-8">',
        '<meta name="viewport" content="width=device-width">',
        f"<title>{escape(title(analysis))}</title><style>{_STYLE}</style></head><body>",
        f"<h1>{escape(title(analysis))}</h1>",
        *(f"<p>because {escape(reason)}</p>" for reason in analysis.reasons),
        _ledger(analysis),
    ]
    for number, (heading, words, figure) in enumerate(figures):
        drawn = plotly.io.to_html(
            figure,
            full_html=False,
            include_plotlyjs=number == 0,
            div_id=f"figure-{number}",  # plotly's own are random: the page would never repeat
            default_height="420px",
        )
        parts.append(
            f'<h2>{escape(heading)}</h2><figure role="group" aria-label="{escape(words)}">'
            f"<figcaption>{escape(words)}</figcaption>{drawn}</figure>"
        )
    parts.append("</body></html>\n")
    return "\n".join(parts)


def _ledger(analysis: Analysis) -> str:
    head = ("kind", "asked", "on time", "late", "slack min", "median", "max", "idle", "causes")
    rows = [
        (
            of.kind,
            str(of.asked),
            str(of.on_time),
            str(of.late),
            *map(seconds, (of.slack_min_s, of.slack_median_s, of.slack_max_s, of.idle_s)),
            ", ".join(f"{cause} {number}" for cause, number in of.causes.items()),
        )
        for of in analysis.decisions
    ]
    header = "".join(f'<th scope="col">{name}</th>' for name in head)
    body = "".join("<tr>" + "".join(f"<td>{escape(c)}</td>" for c in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{header}</tr></thead><tbody>{body}</tbody></table>"
