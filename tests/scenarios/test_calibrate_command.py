"""`waywiser calibrate detectors`: its file, its report, its refusals, and going on when stopped."""

import json
import signal
import subprocess
import sys
import time
from html.parser import HTMLParser
from pathlib import Path

import pytest
from typer.testing import CliRunner

from modules.classifier.sensor_model import load_sensor_model
from scenarios.commands import app

ROOT = Path(__file__).parents[2]


def calibrate(*arguments: str) -> tuple[int, str, str]:
    result = CliRunner().invoke(app, ["calibrate", "detectors", "--workers", "1", *arguments])
    return result.exit_code, result.stdout, result.stderr


class Tags(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.count: dict[str, int] = {}

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.count[tag] = self.count.get(tag, 0) + 1
        assert not any(name in ("src", "href") for name, _ in attrs)


def test_writes_model_and_report(tmp_path: Path) -> None:
    out, html = tmp_path / "model.json", tmp_path / "report.html"
    status, said, _ = calibrate("--trials", "20", "--out", str(out), "--html", str(html), "--json")
    assert status == 0
    report = json.loads(said)
    model = load_sensor_model(out)
    assert model.made_by == report["made_by"]
    assert (model.counts.sum(axis=(2, 3)) == 20).all()
    assert len(report["detectors"]) == 40
    assert 0.0 <= report["brier"] < 0.05
    for row in report["detectors"]:
        assert row["brier"] <= 1.0 - row["right"] + 0.25
        assert row["base_brier"] == pytest.approx(row["present"] * (1 - row["present"]))
    for point in report["curve"]:
        n = point["findings"]
        assert point["low"] <= (n * point["held"] + 0.5) / (n + 1) <= point["high"]
    varies = sum(0.0 < row["present"] < 1.0 for row in report["detectors"])
    assert sum(point["findings"] for point in report["curve"]) == 20 * varies
    tags = Tags()
    tags.feed(html.read_text())
    assert tags.count["svg"] == 5
    assert tags.count["circle"] == len(report["curve"])
    assert not (tmp_path / "model.json.part").exists()


def test_the_report_in_words(tmp_path: Path) -> None:
    out = tmp_path / "model.json"
    status, said, _ = calibrate("--trials", "3", "--out", str(out))
    assert status == 0
    assert "Brier" in said
    assert f"written: {out}" in said.replace("\n", "")


def test_another_ring_makes_another_model(tmp_path: Path) -> None:
    out = tmp_path / "model.json"
    ring = ("--set", "world.sonar.transducers=16", "--set", "world.sonar.specular_limit_deg=42")
    assert calibrate("--trials", "2", "--out", str(out), "--scenario", "aces", *ring)[0] == 0
    assert load_sensor_model(out).made_by.endswith(" ".join(["--scenario aces", *ring]))
    found = load_sensor_model(out).ring
    assert found["transducers"] == 16.0
    assert found["specular_limit_rad"] == pytest.approx(0.733, abs=1e-3)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--set", "seed=1"], "--set: found without --scenario"),
        (["--scenario", "nowhere"], "nowhere: found no such file"),
        (
            ["--scenario", "aces", "--set", "world.sonar.transducers=0"],
            "world.sonar.transducers: found 0",
        ),
        (["--scenario", "aces", "--set", "world.sonar.nearest_m=20"], "nearest_m less than"),
        (["--wedges", "3"], "wedges: found 3, expected 4 to 360"),
        (["--html", "/nowhere/report.html"], "--html /nowhere/report.html: found no such folder"),
    ],
)
def test_refuses_before_the_first_trial(tmp_path: Path, arguments: list[str], says: str) -> None:
    out = tmp_path / "model.json"
    status, said, errors = calibrate("--trials", "4000", "--out", str(out), *arguments)
    assert (status, said) == (2, "")
    assert says in errors
    assert list(tmp_path.iterdir()) == []


def test_other_wedges_make_another_model_but_never_the_shipped_one(tmp_path: Path) -> None:
    out = tmp_path / "twelve.json"
    assert calibrate("--trials", "2", "--out", str(out), "--wedges", "12")[0] == 0
    assert load_sensor_model(out).made_by.endswith("--trials 2 --seed 1 --wedges 12")
    assert load_sensor_model(out, expected_wedges=12).wedges.count == 12
    of_scenario = ("--scenario", "aces", "--set", "sensing.wedges=16")
    assert calibrate("--trials", "1", "--out", str(out), *of_scenario)[0] == 0
    assert load_sensor_model(out).wedges.count == 16
    status, _, errors = calibrate("--trials", "2", "--wedges", "12")
    assert status == 2
    assert "--wedges 12: found no --out" in errors


def test_refuses_a_folder_and_the_kept_part_of_another_calibration(tmp_path: Path) -> None:
    assert "found a folder" in calibrate("--out", str(tmp_path))[2]
    part = tmp_path / "model.json.part"
    part.write_text('{"trials": 7}\n')
    status, said, _ = calibrate("--trials", "2", "--out", str(tmp_path / "model.json"), "--json")
    assert status == 2
    assert "found trials 7" in json.loads(said)["error"]
    assert part.exists()


def test_ctrl_c_keeps_what_is_done(tmp_path: Path) -> None:
    out, part = tmp_path / "model.json", tmp_path / "model.json.part"
    command = [sys.executable, str(ROOT / "waywiser.py"), "calibrate", "detectors"]
    # a shell that runs the tests in the background has SIGINT ignored, and so has what it starts
    signal.signal(signal.SIGINT, signal.default_int_handler)
    # so many trials that it cannot be through before it is stopped
    command += ["--trials", "20000", "--workers", "2", "--out", str(out)]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
        while not (part.exists() and part.read_text().count("\n") > 1):
            assert process.poll() is None
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate()
    assert process.returncode == 3
    assert "the same command goes on" in errors
    assert "Traceback" not in errors
    assert not out.exists()
    assert part.read_text().count("\n") > 1
