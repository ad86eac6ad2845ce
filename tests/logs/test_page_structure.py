"""The page of a run as a document: one file that needs nothing else, readable without a mouse."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from bus import messages as m
from bus.wire import Sent
from logs.picture import write_page
from logs.reader import LogReadError
from logs.run_log import LogWriteError
from logs.study import study
from tests.logs.browser import Document
from tests.logs.conftest import MakeLog


def _page(log: Path, tmp_path: Path) -> Document:
    out = tmp_path / "run.html"
    write_page(study(log), out)
    return Document(out.read_text(encoding="utf-8"))


def test_the_page_needs_nothing_else(run_path: Path, tmp_path: Path) -> None:
    out = tmp_path / "run.html"
    write_page(study(run_path), out)
    text = out.read_text(encoding="utf-8")
    page = Document(text)
    assert page.all("html")[0].attributes == {"lang": "en"}
    assert not [e for e in page.elements if "src" in e.attributes]
    assert [e.attributes["href"] for e in page.all("link")] == ["data:,"]  # no icon is fetched
    assert not re.search(r"https?://|@import|url\(", text)
    title = "two by two, seed 7: 2 of 5 decisions late"
    assert [page.all(tag)[0].words for tag in ("title", "h1")] == [title, title]


def test_the_first_table_is_the_ledger(run_path: Path, tmp_path: Path) -> None:
    ledger = _page(run_path, tmp_path).all("table")[0].words
    assert "path 3 1 2 -20.0 s 85.0 s 190.0 s 30.0 s message lost 1, overrun 1" in ledger


def test_everything_has_a_name_for_those_who_do_not_see_it(run_path: Path, tmp_path: Path) -> None:
    page = _page(run_path, tmp_path)
    ids = [e.attributes["id"] for e in page.elements if "id" in e.attributes]
    assert len(ids) == len(set(ids))
    for element in page.elements:
        for reference in ("aria-labelledby", "aria-describedby", "for"):
            for name in (element.attributes.get(reference) or "").split():
                assert name in ids, f"{element.tag} {reference}={name}"
        if element.attributes.get("role") == "img":
            assert element.attributes.get("aria-label") or element.attributes["aria-labelledby"]
    for table in page.all("table"):
        assert table.words
    assert all(e.attributes.get("scope") in ("col", "row") for e in page.all("th"))
    for button in page.all("button"):
        assert button.words or button.attributes.get("aria-label")
    labelled = {e.attributes.get("for") for e in page.all("label")}
    for control in (*page.all("input"), *page.all("select")):
        inside = control.attributes.get("id") in labelled
        assert inside or _inside_a_label(page, control.attributes), control


def _inside_a_label(page: Document, attributes: dict[str, str | None]) -> bool:
    at = next(i for i, e in enumerate(page.elements) if e.attributes is attributes)
    before = [e.tag for e in page.elements[:at] if e.tag in ("label", "div", "legend", "button")]
    return before[-1] == "label"


def test_the_true_corridors_are_outlined_where_they_are(run_path: Path, tmp_path: Path) -> None:
    page = _page(run_path, tmp_path)
    floors = [e.attributes for e in page.all("rect") if e.attributes.get("class") == "floor"]
    # of the 2 by 2 grid, 20 m by 30 m, all but the northern corridor; 2 m wide, y downward
    boxes = [tuple(float(f[k] or "") for k in ("x", "y", "width", "height")) for f in floors]
    assert boxes == [(-1, -1, 22, 2), (-1, -31, 2, 32), (19, -31, 2, 32)]
    lines = [e.attributes for e in page.all("line") if e.attributes.get("id")]
    assert [line["id"] for line in lines] == [f"corridor-{c}" for c in range(4)]
    assert (lines[1]["x1"], lines[1]["y1"], lines[1]["x2"], lines[1]["y2"]) == (
        "0",
        "-30",
        "20",
        "-30",
    )


def test_the_page_repeats_byte_for_byte(run_path: Path, tmp_path: Path) -> None:
    write_page(study(run_path), tmp_path / "a.html")
    write_page(study(run_path), tmp_path / "b.html")
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()


def test_a_log_of_nothing_still_gets_a_page_that_says_so(make_log: MakeLog, tmp_path: Path) -> None:
    out = tmp_path / "run.html"
    write_page(study(make_log([])), out)
    page = Document(out.read_text(encoding="utf-8"))
    assert "because the log does not say why the run ended" in [e.words for e in page.all("p")]
    assert "hidden" in page.by_id("replay").attributes  # no building, nothing to replay


def test_words_of_a_log_are_not_taken_for_html(
    run: list[Sent], make_log: MakeLog, tmp_path: Path
) -> None:
    evil = "</script><img src=x>"
    ended = Sent("run/ended", "world", 99, -1, 0, (), m.RunEnded(f"process down: {evil}"))
    late = m.LedgerEntry(9, evil, 1, 0, 1, -1, -1, 0, 0, 0, evil, evil)
    said = Sent("ledger", "world", 98, -1, 0, (), late)
    page = _page(make_log([*run[:-1], said, ended]), tmp_path)
    assert not page.all("img")
    assert len(page.all("script")) == 2


def test_bad_paths_are_named(run_path: Path, tmp_path: Path) -> None:
    found = study(run_path)
    with pytest.raises(LogWriteError, match=r"no/run.html: cannot write the page: No such file"):
        write_page(found, tmp_path / "no" / "run.html")
    run_path.unlink()
    with pytest.raises(LogReadError, match=r"RUN\.mcap"):
        write_page(found, tmp_path / "run.html")
