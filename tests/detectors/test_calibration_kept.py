"""A calibration that was killed goes on, and counts what it would have counted in one go."""

import json
from pathlib import Path

import numpy as np
import pytest

from bus.features import USUAL, Wedges
from scenarios import calibrate_detectors
from scenarios.calibrate_detectors import kept_part, model_of, run_trials
from scenarios.calibration_kept import KeptError
from scenarios.detector_tally import empty_tally
from simworld.sonar import SonarRing

SEED = 5


@pytest.fixture(autouse=True)
def small_tasks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(calibrate_detectors, "TRIALS_A_TASK", 3)


class KilledError(Exception):
    """What ends a run in the middle."""


def die_after(trials: int, path: Path) -> None:
    def progress(done: int) -> None:
        if done >= trials:
            raise KilledError

    with pytest.raises(KilledError):
        run_trials(12, SEED, 1, progress, kept=kept_part(path, 12, SEED))


@pytest.mark.parametrize("torn", [b"", b'{"counts": [[[1, 2'])
def test_a_killed_run_goes_on_where_it_was(tmp_path: Path, torn: bytes) -> None:
    path = tmp_path / "model.json.part"
    die_after(6, path)
    assert len(path.read_text().splitlines()) == 1 + 2
    with path.open("ab") as file:
        file.write(torn)
    done: list[int] = []
    again = run_trials(12, SEED, 1, done.append, kept=kept_part(path, 12, SEED))
    whole = run_trials(12, SEED)
    assert done == [3, 6, 9, 12]
    assert np.array_equal(again.counts, whole.counts)
    assert again.binned.tobytes() == whole.binned.tobytes()
    assert model_of(again, 12, SEED).as_json() == model_of(whole, 12, SEED).as_json()
    assert len(kept_part(path, 12, SEED).done()) == 4


def test_what_was_kept_is_not_done_again(tmp_path: Path) -> None:
    path = tmp_path / "model.json.part"
    die_after(9, path)
    head, *tasks = path.read_text().splitlines()
    tally = json.loads(tasks[0])
    tally["counts"][0][0][0][0] += 1000
    path.write_text("\n".join([head, json.dumps(tally), *tasks[1:], ""]))
    again = run_trials(12, SEED, kept=kept_part(path, 12, SEED))
    assert again.counts[0, 0, 0, 0] - run_trials(12, SEED).counts[0, 0, 0, 0] == 1000


def test_the_kept_part_of_another_calibration_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "model.json.part"
    die_after(3, path)
    with pytest.raises(KeptError, match=r"part: .* found seed 5, expected seed 6; delete it"):
        run_trials(12, 6, kept=kept_part(path, 12, 6))
    with pytest.raises(KeptError, match="found trials 12, expected trials 9"):
        run_trials(9, SEED, kept=kept_part(path, 9, SEED))
    with pytest.raises(KeptError, match="'transducers': 16"):
        kept_part(path, 12, SEED, SonarRing(transducers=16)).done()
    with pytest.raises(KeptError, match="found wedges 8, expected wedges 12"):
        kept_part(path, 12, SEED, wedges=Wedges(12)).done()
    monkeypatch.setattr("scenarios.calibration_kept.SOURCES", ("simworld/sonar.py",))
    with pytest.raises(KeptError, match="found code"):
        kept_part(path, 12, SEED).done()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("a shopping list\n", "line 1: found Expecting value"),
        ("[]\n", "found no head"),
        ("\n", "line 1"),
    ],
)
def test_what_is_no_kept_part_is_refused(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "model.json.part"
    path.write_text(text)
    with pytest.raises(KeptError, match=says):
        kept_part(path, 12, SEED).done()


def test_a_spoilt_task_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "model.json.part"
    die_after(3, path)
    path.write_text(path.read_text() + '{"counts": [1], "binned": []}\n')
    with pytest.raises(KeptError, match="line 3: found shapes"):
        kept_part(path, 12, SEED).done()


def test_tallies_by_hand() -> None:
    tally = empty_tally(USUAL)
    for x, evidence, stated in ((1, 3, 0.95), (1, 2, 0.85), (0, 0, 0.02), (0, 3, 1.0)):
        tally.note(1, 2, x, evidence, stated)
    assert tally.counts[1, 2].tolist() == [[1, 0, 0, 1], [0, 0, 1, 1]]
    # (0.05^2 + 0.15^2 + 0.02^2 + 1) / 4
    assert tally.brier[1, 2] == pytest.approx((0.0025 + 0.0225 + 0.0004 + 1.0) / 4)
    assert tally.binned[1, 2, 9].tolist() == pytest.approx([2.0, 1.95, 1.0, 1.0025])
    assert tally.binned[1, 2, 8].tolist() == pytest.approx([1.0, 0.85, 1.0, 0.0225])
    assert tally.binned[1, 2, 0].tolist() == pytest.approx([1.0, 0.02, 0.0, 0.0004])
