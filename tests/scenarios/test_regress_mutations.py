"""Whatever changes a run is found by regress, and named; what changes nothing never is."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import pytest

from bus.topics import CLASSIFIER, DECIDER, PRIORITY
from logs.regress.baseline import read_baseline, write_baseline
from logs.regress.compare import compare
from logs.regress.regression import FAILED, GOOD, INCONCLUSIVE, Regression, regress
from logs.regress.summary import summarise
from scenarios import in_process
from tests.scenarios import spoilt
from tests.scenarios.mutations import by_the_wall_clock, dearer, drops_one, little_log, mutated


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return little_log(tmp_path_factory.mktemp("base") / "base.mcap")


def regressed(base: list[Path], new: list[Path]) -> Regression:
    return regress([summarise(log) for log in base], [summarise(log) for log in new])


def cause_of(found: Regression) -> str:
    (run,) = found.runs
    assert found.outcome == FAILED
    return run.cause


def test_a_handler_a_tenth_dearer(base: Path, tmp_path: Path) -> None:
    build = mutated("geographer", "percept/departure", dearer)
    found = regressed([base], [little_log(tmp_path / "new.mcap", build)])
    cause = cause_of(found)
    assert "geographer took" in cause
    assert "after hearing exactly the same" in cause
    # its notes of a single cell stay what they are
    assert "geographer's percept/departure takes 9.96 % more cells for each message" in cause
    assert [change.name for change in found.runs[0].comparison.work] == [
        "geographer's percept/departure"
    ]


def test_a_handler_a_tenth_dearer_against_a_baseline(base: Path, tmp_path: Path) -> None:
    write_baseline(tmp_path / "base.jsonl", [summarise(base)])
    build = mutated("geographer", "percept/departure", dearer)
    new = summarise(little_log(tmp_path / "new.mcap", build))
    cause = cause_of(regress(read_baseline(tmp_path / "base.jsonl"), [new]))
    assert cause.startswith("geographer's percept/departure takes 9.96 % more cells")
    assert "the first decision that changed is path 1 (visit 0" in cause


def test_a_dearer_profile_is_the_price_and_not_the_work(base: Path, tmp_path: Path) -> None:
    write_baseline(tmp_path / "base.jsonl", [summarise(base)])
    new = summarise(little_log(tmp_path / "new.mcap", compute__slower={"belief": 1.0}))
    cause = cause_of(regress(read_baseline(tmp_path / "base.jsonl"), [new]))
    assert "geographer's" in cause
    assert "time for the same cells: its price changed" in cause


def test_a_dropped_message(base: Path, tmp_path: Path) -> None:
    build = mutated("geographer", "likelihood/junction", drops_one)
    cause = cause_of(regressed([base], [little_log(tmp_path / "new.mcap", build)]))
    assert cause.startswith("geographer, handling likelihood/junction")
    assert "did not say prior/junction" in cause


def test_a_swapped_priority(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    base = little_log(tmp_path / "base.mcap", compute__processors=1)
    swapped = {
        **PRIORITY,
        CLASSIFIER: PRIORITY[DECIDER],
        DECIDER: PRIORITY[CLASSIFIER],
    }
    monkeypatch.setattr(in_process, "PRIORITY", swapped)
    found = regressed([base], [little_log(tmp_path / "new.mcap", compute__processors=1)])
    assert "priorities differ" in cause_of(found)
    assert found.runs[0].comparison.ledger


def test_a_read_of_the_wall_clock(base: Path, tmp_path: Path) -> None:
    build = mutated("geographer", "belief/pose", by_the_wall_clock)
    new = [little_log(tmp_path / f"{k}.mcap", build) for k in range(2)]
    cause = cause_of(regressed([base], new))
    assert cause.startswith("new does not repeat itself: geographer took")
    assert "to handle belief/pose" in cause
    assert "after hearing exactly the same" in cause
    backwards = regressed(new, [base])  # nothing can be told from a base that does not repeat
    assert backwards.outcome == INCONCLUSIVE
    assert backwards.runs[0].reasons[0].startswith("base does not repeat itself: geographer")


def test_an_iteration_without_an_order(tmp_path: Path) -> None:
    logs = [tmp_path / f"{seed}.mcap" for seed in (1, 2)]
    for seed, log in enumerate(logs, start=1):
        spoilt.log_in_a_process("set", seed, log)
    cause = cause_of(regressed(logs[:1], logs[1:]))
    assert "geographer took" in cause
    assert "after hearing exactly the same" in cause


def test_a_hundred_comparisons_of_the_same_find_nothing(tmp_path: Path) -> None:
    runs = [summarise(little_log(tmp_path / f"{k}.mcap", world__until_s=100)) for k in range(15)]
    pairs = list(combinations(runs, 2))
    assert len(pairs) > 100
    assert runs[0].ledger
    assert [pair for pair in pairs if not compare(*pair).same] == []
    assert regress(runs[:7], runs[7:]).outcome == GOOD
