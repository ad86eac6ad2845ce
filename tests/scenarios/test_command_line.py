"""What the command line says before anything runs, and how soon it can."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from scenarios.scenario import shipped
from tests.scenarios.launches import SHORT, waywiser

HEAVY = ("numpy", "zenoh", "numba", "scipy", "simpy", "plotly", "mcap", "google.protobuf")


def test_help_imports_nothing_heavy() -> None:
    program = (
        "import sys\n"
        "from scenarios.commands import app\n"
        "try:\n    app(['launch', '--help'])\nexcept SystemExit:\n    pass\n"
        f"print([name for name in {HEAVY!r} if name in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True).stdout
    assert "Usage: " in out
    assert out.splitlines()[-1] == "[]"


@pytest.mark.parametrize(
    "command",
    ["launch", "analyse", "calibrate detectors", "calibrate compute"],
)
def test_help_has_examples(command: str) -> None:
    said = waywiser(*command.split(), "--help")
    assert said.status == 0
    assert f"`waywiser {command}" in " ".join(said.out.split())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("lunch",), "No such command 'lunch'"),
        (("launch", "aces", "--sped", "3"), "No such option: --sped"),
        (("launch", "aces", "--seed", "one"), "Invalid value for '--seed'"),
        (("launch", "aces", "--seed", "-1"), "Invalid value for '--seed'"),
        (("analyse",), "Missing argument 'LOG...'"),
    ],
)
def test_usage_errors_end_with_2(arguments: tuple[str, ...], words: str) -> None:
    said = waywiser(*arguments)
    assert said.status == 2
    assert words in said.err
    assert said.out == ""


def test_launch_alone_lists_what_is_shipped() -> None:
    said = waywiser("launch")
    assert said.status == 2
    first, *listed = said.err.splitlines()
    assert first == "waywiser: found no scenario, expected a TOML file or one of"
    assert [line.split()[0] for line in listed] == shipped()
    assert listed[0].endswith(
        "Explore the ACES building, run errands, meet people who do not look up"
    )


def test_json_is_one_object_and_nothing_else(tmp_path: Path) -> None:
    path, log = tmp_path / "short.toml", tmp_path / "run.mcap"
    path.write_text(SHORT)
    said = waywiser("launch", str(path), "--in-process", "--log", str(log), "--json")
    facts = said.json
    assert (facts["status"], facts["reason"], facts["log"]) == (0, "done", str(log))
    assert facts["failed"] == {}
    assert "error" not in facts
    assert said.err == ""
    analysed = waywiser("analyse", str(log), "--json")
    assert [one["path"] for one in analysed.json["logs"]] == [str(log)]


def test_analyse_json_is_one_object_also_when_it_fails(tmp_path: Path) -> None:
    said = waywiser("analyse", str(tmp_path / "nosuch.mcap"), "--json")
    assert said.status == 2
    assert said.json["status"] == 2
    assert "nosuch.mcap" in said.json["error"]


def test_two_logs_of_one_second_have_two_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("time.strftime", lambda _: "20260101-120000")
    Path("short.toml").write_text(SHORT)
    logs = [waywiser("launch", "short.toml", "--in-process", "--json").json["log"] for _ in "ab"]
    names = [f"logs/runs/short-seed1-20260101-120000{again}.mcap" for again in ("", "-2")]
    assert logs == names
    assert Path(logs[0]).read_bytes() == Path(logs[1]).read_bytes()
