"""Baselines: a line a decision, read back as they were written, refused with the line's number."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from logs.reader import LogReadError
from logs.regress.baseline import BaselineError, baseline_text, read_baseline, write_baseline
from logs.regress.matching import read_side
from tests.logs.made_regress import decision, summary, with_decision


def test_what_is_written_is_read_back(tmp_path: Path) -> None:
    path = tmp_path / "baselines" / "two.jsonl"
    runs = [summary(seed=2), summary(seed=1)]
    write_baseline(path, runs)
    found = read_baseline(path)
    assert [run.identity for run in found] == [runs[1].identity, runs[0].identity]
    assert [run.simulated for run in found] == [run.simulated for run in reversed(runs)]
    assert list(path.parent.iterdir()) == [path]
    assert baseline_text(found) == path.read_text()
    assert read_side(path) == found


def test_a_changed_decision_is_one_changed_line() -> None:
    was = baseline_text([summary()]).splitlines()
    now = baseline_text([with_decision(summary(), 2, size=5)]).splitlines()
    assert len(was) == 1 + 2 + 4
    changed = [pair for pair in zip(was, now, strict=True) if pair[0] != pair[1]]
    assert len(changed) == 1
    assert '"decision":3' in changed[0][0]


def test_the_order_of_runs_is_their_own() -> None:
    runs = [summary(seed=seed) for seed in (3, 1, 2)]
    assert baseline_text(runs) == baseline_text(sorted(runs, key=lambda run: run.identity.seed))


GOOD = baseline_text([summary()])


@pytest.mark.parametrize(
    "text, told",
    [
        ("", "found nothing in it"),
        (GOOD.replace('"version":1', '"version":2'), r"line 1: version: found 2, expected 1"),
        ("\n".join(GOOD.splitlines()[1:]), "line 1: found no run yet"),
        (GOOD + "{", "line 8: found .* expected a line of a baseline"),
        (GOOD.replace('"size":4', '"size":"4"'), "line 4: found Expected `int`, got `str`"),
        (GOOD.replace('"topic"', '"tropic"'), "line 2: found .*tropic"),
    ],
)
def test_what_is_no_baseline_is_refused(text: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "b.jsonl"
    path.write_text(text)
    with pytest.raises(BaselineError, match=told) as refused:
        read_baseline(path)
    assert str(path) in str(refused.value)


def test_neither_log_nor_text_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "b.bin"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(BaselineError, match="neither a log nor text"):
        read_side(path)
    with pytest.raises(BaselineError, match="No such file"):
        read_side(tmp_path / "none.jsonl")
    with pytest.raises(LogReadError, match=r"no \*.mcap in the folder"):
        read_side(tmp_path)


def test_defaults_are_left_out_and_the_cause_is_not() -> None:
    late = replace(summary(0), ledger=(decision(1), decision(2, slack_s=-1.0, cause="overrun")))
    lines = baseline_text([late]).splitlines()[-2:]
    assert "cause" not in lines[0]
    assert '"cause":"overrun"' in lines[1]
