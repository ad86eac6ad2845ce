"""What the page's script does, in a browser: the address decides what is shown, keys work."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from bus import messages as m
from bus.wire import Sent
from logs.picture import write_page
from logs.study import study
from tests.logs.browser import CHROMIUM, NO_CHROMIUM, Document, show
from tests.logs.conftest import MakeLog, S, Speaker, a_run, may_be_at

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason=NO_CHROMIUM)


def _driving_run() -> list[Sent]:
    """The made-up run, in which the robot also drives from 240 s on, 20 m to the east."""
    speaker = Speaker()
    said = a_run()
    at = next(i for i, sent in enumerate(said) if sent.said_ns > 240 * S)
    for sent in said[:at]:
        speaker.say(sent.said_ns / S, sent.message)
    speaker.say(240, m.Departure(2, 2))
    for n in range(1, 21):
        ranges_m = np.full(24, np.nan)
        ranges_m[[0, 6]] = 5.0, 1.0
        speaker.say(240 + n / 2, m.Odometry(1.0, 0.0, 0.5))
        speaker.say(240 + n / 2, m.Sonar(n, 0, 240 * S + n * S // 2, ranges_m))
    speaker.say(250, m.TruePose(20.0, 30.0, 0.0, 3))
    for sent in said[at:]:
        speaker.say(sent.said_ns / S, sent.message)
    return speaker.said


@pytest.fixture
def page(make_log: MakeLog, tmp_path: Path) -> Path:
    out = tmp_path / "run.html"
    write_page(study(make_log(_driving_run())), out)
    return out


def _rows(document: Document) -> list[str]:
    rows = [e for e in document.all("tr") if "data-decision" in e.attributes]
    return [str(row.attributes["data-decision"]) for row in rows]


def _robot_m(document: Document) -> tuple[float, float]:
    placed = str(document.by_id("robot").attributes["transform"])
    x, y = placed.removeprefix("translate(").split(")")[0].split()
    return float(x), -float(y)


def test_the_address_decides_what_is_shown(page: Path) -> None:
    shown = show(page, "#t=245&decision=4&late=1&kinds=path")
    document = shown.document
    assert shown.console == []
    assert document.by_id("clock").words == "245.0 s of 600.0 s"
    assert _robot_m(document) == pytest.approx((10.0, 30.0), abs=0.1)
    assert _rows(document) == ["6", "4"]  # late paths only, the one that never came first
    boxes = [e for e in document.all("tr") if e.attributes.get("aria-current") == "true"]
    assert [e.attributes["data-decision"] for e in boxes] == ["4"]
    assert document.by_id("chosen-heading").words == "Decision 4, path"
    assert "late by 20.0 s: overrun; stand" in document.by_id("chosen").words
    assert str(document.by_id("goal").attributes["transform"]).startswith("translate(20.000 -30.")
    assert document.by_id("person").attributes.get("hidden") == ""


def test_a_lost_robot_shows_where_it_may_be(make_log: MakeLog, tmp_path: Path) -> None:
    speaker = Speaker()
    for sent in a_run():
        if sent.said_ns == 240 * S:
            speaker.say(240, may_be_at(1, [1, 2], [0.25, 0.75]))
        speaker.say(sent.said_ns / S, sent.message)
    out = tmp_path / "lost.html"
    write_page(study(make_log(speaker.said)), out)
    assert "0,1 (0.750), 1,0 (0.250)" in show(out, "#t=245").document.by_id("state").words
    assert "junction ahead" not in show(out, "#t=10").document.by_id("state").words


def test_echoes_belief_and_words_are_those_of_the_moment(page: Path) -> None:
    document = show(page, "#t=245").document
    hits = str(document.by_id("hits").attributes["d"])
    (ahead_x, ahead_y), (left_x, left_y) = (
        map(float, hit.removesuffix("h0").split()) for hit in hits.split("M")[1:]
    )
    assert (ahead_x, -ahead_y) == pytest.approx((15.0, 30.0), abs=0.03)
    assert (left_x, -left_y) == pytest.approx((10.0, 31.0), abs=0.03)
    lines = [document.by_id(f"corridor-{c}").attributes["class"] for c in range(4)]
    assert lines == ["belief likely", "belief open", "belief open", "belief open"]
    assert document.by_id("said").words.startswith("Decision 2, sensing:")
    later = show(page, "#t=599").document
    lines = [later.by_id(f"corridor-{c}").attributes["class"] for c in range(4)]
    assert lines == ["belief sure", "belief ruled-out", "belief sure", "belief open"]
    assert "ruled" not in later.by_id("corridors").words
    assert "0,1 to 1,1 0.0020 known not to be there there is none" in later.by_id("corridors").words


def test_a_late_decision_leads_to_its_chain_hop_by_hop(late_run: Path, tmp_path: Path) -> None:
    found, out = study(late_run), tmp_path / "late.html"
    write_page(found, out)
    worst = found.chains[0]
    assert worst.slack_ns < 0
    name = f"{worst.kind} {worst.decision}"
    first = next(e for e in show(out).document.all("a") if e.words == name)
    shown = show(out, str(first.attributes["href"]))
    assert shown.console == []
    document = shown.document
    assert document.by_id("chosen-heading").words == f"Decision {worst.decision}, {worst.kind}"
    words = document.by_id("chosen").words
    at = -1
    for hop in reversed(worst.chain.hops):
        at = words.index(f"{hop.topic} {hop.source} {hop.sequence}: said at", at + 1)
        assert f", to the {hop.process}:" in words[at : at + 120]
    assert "45.0000 s of work" in words  # the handler that was made slow
    assert "The chain goes on" not in words
    assert "Response times" in [e.words for e in document.all("h2")]


def test_nonsense_in_the_address_is_passed_over(page: Path) -> None:
    shown = show(page, "#t=banana&decision=99&late=7&kinds=,x&from=9&to=3")
    assert shown.console == []
    assert shown.document.by_id("clock").words == "0.0 s of 600.0 s"
    assert _rows(shown.document) == []  # no such kind: nothing passes
    assert shown.document.by_id("window").words == "0.0 s to 600.0 s"


_PROBE = """<script type="module">
const key = (name, on = document.body) =>
  on.dispatchEvent(new KeyboardEvent("keydown", { key: name, bubbles: true, cancelable: true }));
const told = [];
const tell = (id) => told.push(document.getElementById(id).textContent);
key("ArrowRight"); tell("clock");
key("ArrowLeft"); tell("clock");
key("n"); tell("chosen-heading");
key("n"); key("p"); tell("chosen-heading");
key("+", document.querySelector("canvas")); tell("window");
key("0", document.querySelector("canvas")); tell("window");
document.querySelector("input[value=path]").click();
told.push(location.hash);
document.querySelector("#decisions a").click(); tell("clock");
told.push(document.activeElement.id);
key(" "); tell("play"); key(" "); tell("play");
document.title = told.join("|");
</script></body>"""


def test_keys_filters_and_links_work(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    page.write_text(text.replace("</body>", _PROBE), encoding="utf-8")
    shown = show(page)
    assert shown.console == []
    assert shown.document.all("title")[0].words.split("|") == [
        "10.0 s of 600.0 s",
        "0.0 s of 600.0 s",
        "Decision 1, path",
        "Decision 1, path",
        "150.0 s to 450.0 s",
        "0.0 s to 600.0 s",
        "#t=50&decision=1&kinds=sensing,reaction",
        "252.0 s of 600.0 s",  # of those left, the reaction had the least slack
        "chosen-heading",
        "Pause",
        "Play",
    ]


# Frames come when the browser likes, or never: the test draws them, a tenth of a second apart.
_PLAYER = """<script type="module">
let now = 0, frames = [];
performance.now = () => now;
window.requestAnimationFrame = (draw) => frames.push(draw);
document.getElementById("speed").value = "300";
document.getElementById("play").click();
for (let drawn = 0; drawn < 5; drawn++) {
  now += 100;
  frames.shift()(now);
}
document.getElementById("play").click();
document.title = `${location.hash} ${frames.length}`;
</script></body>"""


def test_playing_moves_on_and_pausing_puts_the_moment_into_the_address(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    page.write_text(text.replace("</body>", _PLAYER), encoding="utf-8")
    shown = show(page, "#t=100")
    assert shown.console == []
    # Five frames of 0.1 s at 300 times the speed are 150 s; one frame was still asked for.
    assert shown.document.all("title")[0].words == "#t=250 1"
    assert shown.document.by_id("play").words == "Play"


def test_a_log_of_nothing_makes_no_errors(make_log: MakeLog, tmp_path: Path) -> None:
    out = tmp_path / "empty.html"
    write_page(study(make_log([])), out)
    shown = show(out, "#t=5")
    assert shown.console == []
    assert _rows(shown.document) == []
