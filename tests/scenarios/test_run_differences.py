"""Where two runs part is found, and the right process is named for the right thing."""

from __future__ import annotations

from pathlib import Path

import pytest

from bus.coordinator import Coordinator
from bus.topics import MODULES
from bus.turns import Module
from logs.diff.aftermath import aftermath
from logs.diff.found import FirstDifference
from logs.diff.settings import setting_differences
from logs.first_difference import compare_logs, first_difference
from scenarios.modules import build_module
from tests.scenarios import mutants, spoilt
from tests.scenarios.mutants import mutant
from tests.scenarios.mutations import little_log

MIRRORED = {"missing": "extra", "extra": "missing"}


@pytest.fixture(scope="module")
def base(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return little_log(tmp_path_factory.mktemp("base") / "base.mcap")


def parted(base: Path, new: Path) -> FirstDifference:
    """The first difference, which is the same event whichever log is named first."""
    found, mirrored = first_difference(base, new), first_difference(new, base)
    assert found is not None and mirrored is not None
    assert event_of(found) == event_of(mirrored)
    assert mirrored.kind == MIRRORED.get(found.kind, found.kind)
    return found


def event_of(found: FirstDifference) -> tuple[int, str, str, int]:
    return (found.at_ns, found.source, found.topic, found.sequence)


def test_a_log_does_not_differ_from_itself(base: Path) -> None:
    compared = compare_logs(base, base)
    assert (compared.first, compared.incomplete) == (None, ())
    assert compared.equal > 1000


@pytest.mark.parametrize("module", MODULES)
def test_a_handler_that_costs_more_is_named(module: str, base: Path, tmp_path: Path) -> None:
    found = parted(base, little_log(tmp_path / "new.mcap", mutant(module, mutants.costlier)))
    assert (found.source, found.kind) == (module, "cost")
    assert found.heard and found.heard_the_same
    assert [field.field for field in found.fields] == ["cost"]
    assert "after hearing exactly the same" in found.what


@pytest.mark.parametrize(
    "change, kind", [(mutants.dropping(20), "missing"), (mutants.repeating(3), "extra")]
)
def test_a_message_less_or_more_is_named(
    change: object, kind: str, base: Path, tmp_path: Path
) -> None:
    module = "sensor" if kind == "missing" else "decider"
    found = parted(base, little_log(tmp_path / "new.mcap", mutant(module, change)))  # type: ignore[arg-type]
    assert (found.source, found.kind) == (module, kind)
    assert found.topic in ("belief/ranges", "decision/path")
    assert found.topic in found.what
    assert found.heard_the_same


def test_a_message_that_nobody_heard_is_named(
    monkeypatch: pytest.MonkeyPatch, base: Path, tmp_path: Path
) -> None:
    mutants.coordinated_by(monkeypatch, mutants.DeafCoordinator)
    found = parted(base, little_log(tmp_path / "new.mcap"))
    assert (found.source, found.kind) == ("classifier", "missing")
    assert "did not handle prior/junction (message 4 of geographer) in new" in found.what
    assert not found.heard_the_same


def test_a_choice_that_is_another_is_named_with_its_field(base: Path, tmp_path: Path) -> None:
    new = little_log(tmp_path / "new.mcap", mutant("decider", mutants.contrary))
    found = parted(base, new)
    assert (found.source, found.kind, found.topic) == ("decider", "content", "decision/path")
    assert [field.field for field in found.fields] == ["direction[15]"]
    followed = aftermath(base, new)
    assert followed.flipped
    assert all(change.kind == "path" for change in followed.flipped)
    assert followed.flipped[0].flips[0].startswith("type NESW: ")


def test_a_handler_that_reads_the_wall_clock_is_named(tmp_path: Path) -> None:
    logs = [
        little_log(tmp_path / name, spoilt.build("wall clock")) for name in ("1.mcap", "2.mcap")
    ]
    found = parted(*logs)
    assert (found.source, found.kind) == ("geographer", "cost")
    assert [field.field for field in found.fields] == ["cost", "cells"]


def test_a_handler_that_iterates_a_set_is_named(tmp_path: Path) -> None:
    logs = [tmp_path / "1.mcap", tmp_path / "2.mcap"]
    for seed, log in enumerate(logs):
        spoilt.log_in_a_process("set", seed + 1, log)
    found = parted(*logs)
    assert (found.source, found.kind) == ("geographer", "cost")


def test_swapped_priorities_are_named_as_another_order(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    base = little_log(tmp_path / "base.mcap", compute__processors=1)
    mutants.coordinated_by(monkeypatch, mutants.SwappedCoordinator)
    found = parted(base, little_log(tmp_path / "new.mcap", compute__processors=1))
    assert (found.source, found.kind) == ("reactor", "order")
    assert "after sensor took up" in found.what


def test_another_order_within_a_turn_is_named(
    monkeypatch: pytest.MonkeyPatch, base: Path, tmp_path: Path
) -> None:
    mutants.coordinated_by(monkeypatch, mutants.ContraryCoordinator)
    found = parted(base, little_log(tmp_path / "new.mcap"))
    assert (found.source, found.kind) == ("classifier", "order")
    assert "before percept/departure (message 1 of world), in base after it" in found.what


def test_the_clock_says_that_priorities_are_others(
    monkeypatch: pytest.MonkeyPatch, base: Path, tmp_path: Path
) -> None:
    class Swapped(mutants.SwappedCoordinator):
        living = Coordinator.living

    mutants.coordinated_by(monkeypatch, Swapped)
    found = parted(base, little_log(tmp_path / "new.mcap"))
    assert (found.at_ns, found.topic, found.kind) == (0, "health/state", "order")
    assert "about sensor" in found.what and "about reactor" in found.what


def test_a_process_that_goes_down_is_named(base: Path, tmp_path: Path) -> None:
    fault = [{"kill": "decider", "at_s": 100.0}]
    found = parted(base, little_log(tmp_path / "new.mcap", fault=fault))
    assert (found.at_ns, found.source, found.kind) == (100_000_000_000, "decider", "extra")
    assert found.what == "decider went down at 100 s in new only"


def test_what_a_handler_prints_is_compared(base: Path, tmp_path: Path) -> None:
    new = little_log(tmp_path / "new.mcap", mutant("detectors", mutants.talkative))
    found = parted(base, new)
    assert (found.source, found.kind, found.topic) == ("detectors", "extra", "output")


def test_another_seed_is_told_beside_the_first_difference(base: Path, tmp_path: Path) -> None:
    new = little_log(tmp_path / "new.mcap", seed=2)
    assert next(of.field for of in setting_differences(base, new)) == "seed"
    assert parted(base, new).kind == "content"
    assert setting_differences(base, base) == ()


def test_slack_that_changed_is_told_by_hop(base: Path, tmp_path: Path) -> None:
    slower = {"belief": 0.25}
    new = little_log(tmp_path / "new.mcap", compute__slower=slower)
    changes = [change for change in aftermath(base, new).changes if change.kind == "path"]
    assert changes
    for change in changes:
        assert change.slack_ns == -250_000_000
        (shift,) = change.shifts
        assert (shift.part, shift.process, shift.change_ns) == (
            "computing",
            "geographer",
            250_000_000,
        )


def test_all_that_changed_the_slack_adds_up(base: Path, tmp_path: Path) -> None:
    new = little_log(
        tmp_path / "new.mcap",
        compute__profile="huey-1990",
        compute__processors=1,
    )
    changes = [change for change in aftermath(base, new).changes if change.shifts]
    assert len(changes) > 5
    for change in changes:
        available = sum(s.change_ns for s in change.shifts if s.part == "time available")
        taken = sum(s.change_ns for s in change.shifts if s.part != "time available")
        assert change.slack_ns == available - taken


def test_nothing_follows_where_nothing_differs(base: Path) -> None:
    followed = aftermath(base, base)
    assert followed.changes == ()
    assert followed.base == followed.new


def test_mutants_are_not_the_sound_module_by_another_name(base: Path, tmp_path: Path) -> None:
    def unchanged(name: str, *arguments: object) -> Module:
        return build_module(name, *arguments)  # type: ignore[arg-type]

    assert first_difference(base, little_log(tmp_path / "new.mcap", unchanged)) is None
