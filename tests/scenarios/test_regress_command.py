"""The regress command as a user gives it: exit status, text, JSON, JUnit, measuring in turn."""

from __future__ import annotations

import shutil
from pathlib import Path
from xml.etree import ElementTree

import pytest

from scenarios import self_test
from scenarios.rounds import Installation, installation
from tests.scenarios.fake_install import calls, fake_install
from tests.scenarios.launches import waywiser
from tests.scenarios.mutations import dearer, little_log, mutated

UNTIL_S = 400


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path, Path]:
    """A run, the same once more, and one in which a handler is dearer."""
    folder = tmp_path_factory.mktemp("logs")
    build = mutated("geographer", "percept/departure", dearer)
    return (
        little_log(folder / "base.mcap", world__until_s=UNTIL_S),
        little_log(folder / "same.mcap", world__until_s=UNTIL_S),
        little_log(folder / "dearer.mcap", build, world__until_s=UNTIL_S),
    )


def folder_of(folder: Path, *logs: Path) -> Path:
    folder.mkdir()
    for log in logs:
        shutil.copy(log, folder)
    return folder


def regress(*words: object) -> tuple[int, str, str]:
    ended = waywiser("regress", *map(str, words))
    return ended.status, ended.out, ended.err


def test_nothing_changed(logs: tuple[Path, Path, Path], tmp_path: Path) -> None:
    status, out, _ = regress(logs[0], logs[1])
    assert status == 0
    assert "simulated time: same" in out
    folders = folder_of(tmp_path / "a", logs[0]), folder_of(tmp_path / "b", logs[1])
    assert regress(*folders)[0] == 0


def test_a_change_fails_and_is_named(logs: tuple[Path, Path, Path], tmp_path: Path) -> None:
    xml = tmp_path / "regress.xml"
    status, out, _ = regress(logs[0], logs[2], "--junit", xml)
    assert status == 1
    assert "geographer's percept/departure takes 9.9" in out
    assert ElementTree.parse(xml).getroot().get("failures") == "2"
    ended = waywiser("regress", str(logs[0]), str(logs[2]), "--json")
    assert (ended.status, ended.json["status"], ended.json["outcome"]) == (1, 1, "failed")
    assert "geographer took" in ended.json["runs"][0]["cause"]


def test_a_baseline_is_written_and_held(logs: tuple[Path, Path, Path], tmp_path: Path) -> None:
    baseline = tmp_path / "base.jsonl"
    assert regress(logs[0], "--write-baseline", baseline)[0] == 0
    assert regress(baseline, logs[1])[0] == 0
    status, out, _ = regress(baseline, logs[2])
    assert status == 1
    assert "geographer's percept/departure takes 9.9" in out


def test_a_log_that_is_cut_off_is_inconclusive(
    logs: tuple[Path, Path, Path], tmp_path: Path
) -> None:
    cut = tmp_path / "cut.mcap"
    data = logs[1].read_bytes()
    cut.write_bytes(data[: len(data) * 2 // 3])
    status, out, _ = regress(logs[0], cut)
    assert status == 3
    assert "the log is truncated" in out
    assert regress(cut, "--write-baseline", tmp_path / "b.jsonl")[0] == 3
    assert not (tmp_path / "b.jsonl").exists()


def test_what_cannot_be_compared_is_bad_input(
    logs: tuple[Path, Path, Path], tmp_path: Path
) -> None:
    other = little_log(tmp_path / "o.mcap", compute__profile="huey-1990", world__until_s=UNTIL_S)
    status, _, err = regress(logs[0], other)
    assert (status, "profile 'host' and 'huey-1990'" in err) == (2, True)
    status, _, err = regress(logs[0], tmp_path / "none.mcap")
    assert (status, "none.mcap" in err) == (2, True)
    for words in ([], [logs[0]], [logs[0]] * 3, [logs[0], "--self-test"]):
        status, _, err = regress(*words)
        assert (status, "expected" in err) == (2, True), words
    status, _, err = regress(logs[0], logs[1], "--junit", tmp_path / "none" / "x.xml")
    assert (status, "x.xml" in err) == (2, True)
    ended = waywiser("regress", str(tmp_path / "none.mcap"), str(logs[0]), "--json")
    assert (ended.status, ended.json["status"]) == (2, 2)


def test_wall_time_that_is_asked_for_and_not_there_is_inconclusive(
    logs: tuple[Path, Path, Path],
) -> None:
    assert regress(logs[0], logs[1], "--wall")[0] == 3


LIKE = [10.0 + 0.01 * k for k in range(9)]


def measured(tmp_path: Path, log: Path, new_ms: list[float], *words: str) -> tuple[int, str, str]:
    base = fake_install(tmp_path / "old", log, LIKE)
    new = fake_install(tmp_path / "now", log, new_ms)
    return regress(base, new, "--measure", "aces", *words)


def test_both_sides_run_in_turn_and_the_first_runs_do_not_count(
    logs: tuple[Path, Path, Path], tmp_path: Path
) -> None:
    status, out, _ = measured(tmp_path, logs[0], LIKE, "--wall")
    assert status == 0
    assert "wall time: no slower" in out
    order = [line.split()[0] for line in calls(tmp_path)]
    assert order == ["old", "now"] + ["old", "now", "now", "old"] * 4
    assert calls(tmp_path)[:2] == ["old warm-base.mcap", "now warm-new.mcap"]


def test_a_slower_installation_is_told_and_fails_where_asked(
    logs: tuple[Path, Path, Path], tmp_path: Path
) -> None:
    slower = [1.5 * ms for ms in LIKE]
    status, out, _ = measured(tmp_path, logs[0], slower)
    assert status == 0
    assert "(failed)      wall time: slower: +50" in out
    shutil.rmtree(tmp_path / "old")
    shutil.rmtree(tmp_path / "now")
    assert measured(tmp_path, logs[0], slower, "--wall")[0] == 1


def test_more_rounds_only_if_unclear(logs: tuple[Path, Path, Path], tmp_path: Path) -> None:
    unclear = [13.0, 13.0, 13.0, 13.0, 13.0, 13.0, 13.0, 1.0, 10.035]
    status, out, _ = measured(
        tmp_path, logs[0], unclear, "--wall", "--rounds", "8", "--most-rounds", "10"
    )
    rounds = (len(calls(tmp_path)) - 2) // 2
    assert 8 < rounds <= 10
    assert status in (1, 3), out


def test_an_installation_that_cannot_run_is_bad_input(tmp_path: Path) -> None:
    broken = tmp_path / "python"
    broken.write_text("#!/bin/sh\necho no module named waywiser >&2\nexit 1\n")
    broken.chmod(0o755)
    status, _, err = regress(broken, broken, "--measure", "aces")
    assert status == 2
    assert "no whole log" in err
    assert "no module named waywiser" in err
    status, _, err = regress(tmp_path / "none", broken, "--measure", "aces")
    assert (status, "expected a source tree" in err) == (2, True)


def test_a_source_tree_runs_in_its_own_folder(tmp_path: Path) -> None:
    (tmp_path / "waywiser.py").touch()
    assert installation(tmp_path, tmp_path / "x").folder == tmp_path


def test_the_self_test_tells_the_rates_with_intervals(
    logs: tuple[Path, Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = fake_install(tmp_path / "own", logs[0], LIKE)
    side = Installation((str(program), "-m", "waywiser"), tmp_path)
    monkeypatch.setattr(self_test, "this_installation", lambda _: side)
    status, out, _ = regress("--self-test", "--comparisons", "2")
    assert status == 0
    assert "simulated time   0 of 16 (0.0 %, 0.0 - 20.6 %)" in out
    assert "work by handler  0 of 16" in out
    assert "wall time        0 of 2 (0.0 %, 0.0 - 84.2 %)" in out


def test_the_self_test_sees_an_alarm(
    logs: tuple[Path, Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = fake_install(tmp_path / "own", logs[0], LIKE)
    shutil.copy(logs[2], tmp_path / "own" / "made-03.mcap")  # one of its runs is another
    side = Installation((str(program), "-m", "waywiser"), tmp_path)
    monkeypatch.setattr(self_test, "this_installation", lambda _: side)
    ended = waywiser("regress", "--self-test", "--comparisons", "1", "--json")
    assert ended.status == 1
    assert [rate["alarms"] > 0 for rate in ended.json["rates"]] == [True, True, False]
