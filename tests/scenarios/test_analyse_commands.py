"""The analyse and check commands, as a user gives them."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from scenarios.commands import app
from scenarios.launch import launch_in_process, prepare


def _run(*words: str | Path) -> Result:
    return CliRunner().invoke(app, [str(word) for word in words], env={"COLUMNS": "100"})


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A run in which some decisions are late, and one in which none is."""
    folder = tmp_path_factory.mktemp("runs")
    late, punctual = folder / "late.mcap", folder / "punctual.mcap"
    launch_in_process(prepare("aces", ["compute.slower.sensing=45"], 1), late)
    launch_in_process(prepare("aces", [], 1), punctual)
    return late, punctual


def test_one_log_says_where_the_time_went(logs: tuple[Path, Path]) -> None:
    result = _run("analyse", logs[0])
    assert result.exit_code == 1
    parts = ["Decisions", "Late decisions", "Late chains", "Handlers and queues", "Age of the"]
    at = [result.stdout.index(part) for part in parts]
    assert at == sorted(at)
    assert "classifier computing 45.0 s" in " ".join(result.stdout.split())
    assert "Registration: where it believed to be" in result.stdout


def test_several_logs_are_a_table_and_one_ledger(logs: tuple[Path, Path]) -> None:
    result = _run("analyse", *logs, "--json")
    assert result.exit_code == 1
    found = json.loads(result.stdout)
    assert [one["verdict"] for one in found["logs"]] == ["late", "in time"]
    for k, of in enumerate(found["combined"]):
        each = [one["decisions"][k] for one in found["logs"]]
        assert of["asked"] == sum(one["asked"] for one in each)
        assert of["late"] == sum(one["late"] for one in each)
        assert of["idle_s"] == pytest.approx(sum(one["idle_s"] for one in each))
    text = _run("analyse", *logs).stdout
    assert "Late chains" not in text
    assert text.count("aces, seed 1:") == 2


def test_the_json_has_all_of_it(logs: tuple[Path, Path]) -> None:
    (one,) = json.loads(_run("analyse", logs[0], "--json").stdout)["logs"]
    parts = {"slack", "chains", "paths", "processes", "traffic", "calibration", "knowledge"}
    assert parts <= set(one)
    assert one["chains"][0]["slack_ns"] < 0
    assert one["chains"][0]["chain"]["response_ns"] > 0
    assert one["knowledge"][0]["registered"] is True


def _rows(folder: Path, table: str) -> list[dict[str, str]]:
    with (folder / f"{table}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_tables_hold_every_log(logs: tuple[Path, Path], tmp_path: Path) -> None:
    folder = tmp_path / "tables"
    assert _run("analyse", *logs, "--tables", folder).exit_code == 1
    found = json.loads(_run("analyse", *logs, "--json").stdout)["logs"]
    sizes = {
        "ledger": sum(len(one["ledger"]) for one in found),
        "spans": sum(load["handlers"] for one in found for load in one["loads"]),
        "topics": sum(len(one["traffic"]) for one in found),
        "chains": sum(len(row["chain"]["hops"]) for one in found for row in one["chains"]),
        "paths": sum(len(one["paths"]) for one in found),
        "beliefs": sum(len(one["knowledge"]) for one in found),
    }
    assert {table: len(_rows(folder, table)) for table in sizes} == sizes
    assert {row["log"] for row in _rows(folder, "spans")} == set(map(str, logs))
    for row in _rows(folder, "paths"):
        assert float(row["first_median_s"]) <= float(row["last_median_s"])
        assert float(row["best_median_s"]) <= float(row["worst_median_s"])
    for row in _rows(folder, "ledger"):
        if row["decided_ns"]:
            assert int(row["slack_ns"]) == int(row["until_ns"]) - int(row["decided_ns"])


def test_tables_that_cannot_be_written_are_bad_input(
    logs: tuple[Path, Path], tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("")
    result = _run("analyse", logs[0], "--tables", tmp_path / "file" / "tables")
    assert result.exit_code == 2
    assert "cannot write tables" in result.stderr


def test_a_trace_is_written(logs: tuple[Path, Path], tmp_path: Path) -> None:
    trace = tmp_path / "run.pftrace"
    assert _run("analyse", logs[1], "--perfetto", trace).exit_code == 0
    assert trace.stat().st_size > 100_000
    nowhere = _run("analyse", logs[1], "--perfetto", tmp_path / "no" / "run.pftrace")
    assert nowhere.exit_code == 2
    assert "cannot write the trace" in nowhere.stderr


def test_check_says_what_it_looked_at(logs: tuple[Path, Path], tmp_path: Path) -> None:
    result = _run("check", logs[0])
    assert result.exit_code == 0
    assert result.stdout.splitlines()[0].endswith(": good")
    assert all(line.startswith("  ok") for line in result.stdout.splitlines()[1:])
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(logs[0].read_bytes()[:-1])
    assert _run("check", cut).exit_code == 3
    as_json = json.loads(_run("check", cut, "--json").stdout)
    assert as_json["verdict"] == "inconclusive"
    assert _run("check", tmp_path / "nothing").exit_code == 2
