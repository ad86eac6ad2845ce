"""The page of a run: one file that needs nothing else, with the right numbers in its figures."""

from __future__ import annotations

from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bus import messages as m
from bus.wire import Sent
from logs.figures import (
    BeliefAt,
    belief_figure,
    building_figure,
    slack_figure,
    timeline_figure,
)
from logs.picture import write_page
from logs.reader import LogReadError
from logs.run_log import LogWriteError


class _Page(HTMLParser):
    """What a browser would see: tags with their attributes, and the text outside of scripts."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        if self.tags and self.tags[-1][0] not in ("script", "style"):
            self.words.append(data.strip())

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.tags if name == tag]


def _ledger(run: list[Sent]) -> list[m.LedgerEntry]:
    return [sent.message for sent in run if isinstance(sent.message, m.LedgerEntry)]


def _only(run: list[Sent], kind: type[Any]) -> list[Any]:
    return [sent.message for sent in run if isinstance(sent.message, kind)]


def test_the_page_needs_nothing_else(run_path: Path, tmp_path: Path) -> None:
    out = tmp_path / "run.html"
    analysis = write_page(run_path, out)
    assert analysis.verdict == "late"
    page = _Page(out.read_text(encoding="utf-8"))
    assert page.all("html") == [{"lang": "en"}]
    assert not [tag for tag, attributes in page.tags if "src" in attributes or tag == "link"]
    title = "two by two, seed 7: 2 of 5 decisions late"
    assert page.words.count(title) == 2  # title and heading
    figures = [str(figure["aria-label"]) for figure in page.all("figure")]
    assert [words.split()[0] for words in figures] == ["Map", "A", "Histogram", "Entropy"]
    ids = [d["id"] for d in page.all("div") if str(d.get("id", "")).startswith("figure")]
    assert ids == [f"figure-{n}" for n in range(4)]
    assert "message lost 1, overrun 1" in page.words  # the ledger is there as a table too


def test_the_page_repeats_byte_for_byte(run_path: Path, tmp_path: Path) -> None:
    write_page(run_path, tmp_path / "a.html")
    write_page(run_path, tmp_path / "b.html")
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()


def test_a_log_of_nothing_still_gets_a_page_that_says_so(
    make_log: Callable[[list[Sent]], Path], tmp_path: Path
) -> None:
    out = tmp_path / "run.html"
    assert write_page(make_log([]), out).inconclusive
    page = _Page(out.read_text(encoding="utf-8"))
    assert "because the log does not say why the run ended" in page.words
    assert len(page.all("figure")) == 2  # no building, no belief to draw


def test_words_of_a_log_are_not_taken_for_html(
    run: list[Sent], make_log: Callable[[list[Sent]], Path], tmp_path: Path
) -> None:
    out = tmp_path / "run.html"
    ended = m.RunEnded("process down: <img src=x>")
    last = Sent("run/ended", "world", 99, -1, 0, (), ended)
    write_page(make_log([*run[:-1], last]), out)
    assert not _Page(out.read_text(encoding="utf-8")).all("img")


def test_bad_paths_are_named(run_path: Path, tmp_path: Path) -> None:
    with pytest.raises(LogReadError, match=r"no\.mcap"):
        write_page(tmp_path / "no.mcap", tmp_path / "run.html")
    with pytest.raises(LogWriteError, match=r"no/run.html: cannot write the page: No such file"):
        write_page(run_path, tmp_path / "no" / "run.html")


def test_each_decision_is_a_bar_to_its_deadline_with_a_mark(run: list[Sent]) -> None:
    traces = {trace.name: trace for trace in timeline_figure(_ledger(run)).data}
    late = traces["asked to deadline, late"]
    assert list(late.x) == [300.0, 480.0, None, 500.0, 550.0, None]
    assert list(traces["asked to deadline, on time"].x)[:3] == [0.0, 240.0, None]
    assert list(traces["decided, late"].x) == [500.0]
    assert list(traces["decided, on time"].x) == [50.0, 60.0, 252.0]
    assert list(traces["decided, on time"].y) == ["path", "sensing", "reaction"]
    assert list(traces["never decided"].x) == [550.0]
    assert traces["decided, late"].marker.color == late.line.color
    assert late.line.color != traces["asked to deadline, on time"].line.color


def test_the_histograms_hold_the_slack_of_each_kind(run: list[Sent]) -> None:
    found = [list(trace.x) for trace in slack_figure(_ledger(run)).data]
    assert found == [[10.0], [190.0, -20.0], [1.0]]


def test_corridors_that_exist_are_solid_and_lie_where_they_are(run: list[Sent]) -> None:
    (building,) = _only(run, m.TrueBuilding)
    marginals = np.array([0.999, 0.002, 0.995, 0.4])
    *lines, marks, robot = building_figure(building, _only(run, m.TruePose), marginals).data
    # east corridors first, from the south: y = 0, y = 30; then north ones: x = 0, x = 20
    assert [(tuple(line.x), tuple(line.y)) for line in lines] == [
        ((0.0, 20.0), (0.0, 0.0)),
        ((0.0, 20.0), (30.0, 30.0)),
        ((0.0, 0.0), (0.0, 30.0)),
        ((20.0, 20.0), (0.0, 30.0)),
    ]
    assert [line.line.dash for line in lines] == ["solid", "dot", "solid", "solid"]
    assert list(marks.marker.color) == marginals.tolist()
    assert marks.text[1] == "corridor 1: P = 0.0020; there is none"
    assert (tuple(robot.x), tuple(robot.y)) == ((0.0, 0.0), (0.0, 30.0))


def test_a_building_without_a_belief_is_drawn_without_colours(run: list[Sent]) -> None:
    (building,) = _only(run, m.TrueBuilding)
    *lines, _robot = building_figure(building, [], None).data
    assert len({line.line.color for line in lines}) == 1


def test_the_belief_is_drawn_over_time() -> None:
    entropy, true_map = belief_figure([BeliefAt(1.0, 0.75, 0.25), BeliefAt(9.0, 0.5, None)]).data
    assert (list(entropy.x), list(entropy.y)) == ([1.0, 9.0], [0.75, 0.5])
    assert list(true_map.y) == [0.25, None]
