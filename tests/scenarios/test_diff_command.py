"""What `waywiser diff` says, and its exit status."""

from __future__ import annotations

from pathlib import Path

import pytest

from logs.run_log import RunLog
from tests.scenarios.launches import waywiser
from tests.scenarios.mutations import little_log


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return little_log(tmp_path_factory.mktemp("base") / "base.mcap")


@pytest.fixture(scope="module")
def slower(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("new") / "new.mcap"
    return little_log(path, compute__slower={"path": 0.5})


def test_equal_logs_are_good(base: Path) -> None:
    ended = waywiser("diff", str(base), str(base))
    assert (ended.status, ended.err) == (0, "")
    assert ended.out.startswith("no difference: ")
    assert ended.out.endswith("messages are equal, bit for bit\n")
    as_json = waywiser("diff", str(base), str(base), "--json").json
    assert (as_json["status"], as_json["first"], as_json["aftermath"]) == (0, None, None)


def test_the_cause_is_told_before_what_followed(base: Path, slower: Path) -> None:
    ended = waywiser("diff", str(base), str(slower))
    assert ended.status == 1
    lines = ended.out.splitlines()
    assert lines[0] == "made from other things:"
    assert "modules.json:" in lines[1] and "500000000" in lines[1]
    assert lines[2].startswith("the runs part at ")
    assert lines[3].startswith("  cost: decider took 50")
    assert lines[3].endswith("after hearing exactly the same")
    assert lines[4].startswith("    heard belief/map (message 1 of geographer), said at ")
    assert lines[4].endswith("equal in both")
    follows = lines.index("what followed:")
    assert lines[follows + 1].startswith("  base: done after ")
    assert lines[follows + 3] == "  decisions that changed: 5, that chose otherwise: 0"
    assert lines[follows + 4].endswith("slack -500 ms")
    assert lines[follows + 5] == "    by computing of belief/map in decider +500 ms"


def test_json_has_it_all(base: Path, slower: Path) -> None:
    found = waywiser("diff", str(base), str(slower), "--json").json
    assert (found["status"], found["incomplete"]) == (1, [])
    assert (found["first"]["source"], found["first"]["kind"]) == ("decider", "cost")
    assert found["first"]["heard"][0]["equal"] is True
    assert [change["slack_ns"] for change in found["aftermath"]["changes"]] == 5 * [-500_000_000]
    assert found["aftermath"]["changes"][0]["shifts"][0]["process"] == "decider"


def test_a_log_that_is_cut_off_gets_no_verdict(base: Path, slower: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(base.read_bytes()[: base.stat().st_size // 2])
    for pair in ((base, cut), (cut, base), (cut, cut)):
        ended = waywiser("diff", *map(str, pair))
        assert ended.status == 3
        assert "is truncated" in ended.out
    assert waywiser("diff", str(cut), str(slower)).status == 1


def test_a_run_that_ended_sooner_differs(base: Path, tmp_path: Path) -> None:
    killed = little_log(tmp_path / "killed.mcap", fault=[{"kill": "decider", "at_s": 200.0}])
    ended = waywiser("diff", str(base), str(killed))
    assert ended.status == 1
    assert "extra: decider went down at 200 s in new only" in ended.out
    assert "process down: decider after " in ended.out


def test_bad_input_is_told(base: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.txt"
    other.write_text("no log")
    ended = waywiser("diff", str(base), str(other))
    assert ended.status == 2
    assert "other.txt: found a file that is not MCAP" in ended.err
    assert waywiser("diff", str(base), "none.mcap", "--json").json["status"] == 2


def test_a_log_without_anything_in_it_is_a_difference(base: Path, tmp_path: Path) -> None:
    empty = tmp_path / "empty.mcap"
    RunLog(empty, 0, {}, {}).close()
    found = waywiser("diff", str(base), str(empty), "--json").json
    assert (found["status"], found["first"]["kind"], found["first"]["at_ns"]) == (1, "missing", 0)
