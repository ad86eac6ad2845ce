"""What can be wrong with what a lost robot is said to know: key, found, expected."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest

from bus.facts import Recall
from bus.grid import Grid
from scenarios.draw import draw
from scenarios.parts import pack_parts, parts_in, parts_of
from scenarios.scenario import ScenarioError, check, find, load
from tests.scenarios.launches import waywiser
from tests.scenarios.runs import Table, with_changes

LOST: Table = {
    "about": "lost",
    "world": {
        "columns_m": [0.0, 20.0, 40.0],
        "rows_m": [0.0, 20.0],
        "start": {"junction": [1, 0], "heading": "E"},
    },
    "recall": {
        "may_be_at": [{"at": [1, 0], "probability": 0.5}, {"at": [2, 1], "probability": 0.5}],
        "places": [{"at": [0, 0], "open": "NE"}],
    },
    "errand": [{"from": [0, 0], "to": [2, 1]}],
}
MAY_BE = "recall.may_be_at"


def may_be(*rows: tuple[list[int], float]) -> list[Table]:
    return [{"at": at, "probability": p} for at, p in rows]


WRONG = {
    "a place off the grid": (
        {"recall.places": [{"at": [0, 2], "open": "N"}]},
        "recall.places[0].at: found intersection [0, 2], expected x from 0 to 2 and y from 0 to 1",
    ),
    "a start off the grid": (
        {MAY_BE: may_be(([1, 0], 0.5), ([3, 0], 0.5))},
        f"{MAY_BE}[1].at: found intersection [3, 0], expected x from 0 to 2 and y from 0 to 1",
    ),
    "the same place twice": (
        {"recall.places": [{"at": [0, 0], "open": "N"}, {"at": [0, 0], "open": "E"}]},
        "recall.places[1].at: found [0, 0] again, expected each place once",
    ),
    "the same start twice": (
        {MAY_BE: may_be(([1, 0], 0.5), ([1, 0], 0.5))},
        f"{MAY_BE}[1].at: found [1, 0] again, expected each place once",
    ),
    "letters that are none": (
        {"recall.places": [{"at": [0, 0], "open": "NX"}]},
        "recall.places[0].open: found 'NX', expected letters of NESW, each once",
    ),
    "a letter twice": (
        {"recall.places": [{"at": [0, 0], "open": "NN"}]},
        "recall.places[0].open: found 'NN', expected letters of NESW, each once",
    ),
    "nothing open": (
        {"recall.places": [{"at": [0, 0], "open": ""}]},
        "recall.places[0].open: found '', expected letters of NESW, each once",
    ),
    "a corridor off the grid": (
        {"recall.places": [{"at": [0, 0], "open": "NW"}]},
        "recall.places[0].open: found 'NW', expected no W, which leads off the grid at [0, 0]",
    ),
    "quite certain": (
        {"recall.places": [{"at": [0, 0], "open": "NE", "certain": 1.0}]},
        "recall.places[0].certain: found 1.0, expected float > 0 and < 1",
    ),
    "no place to be at": (
        {MAY_BE: []},
        f"{MAY_BE}: found 0 places, expected 1 to 6",
    ),
    "probabilities that do not sum to one": (
        {MAY_BE: may_be(([1, 0], 0.5), ([2, 1], 0.4))},
        f"{MAY_BE}: found probabilities that sum to 0.9, expected 1",
    ),
    "a probability of nothing": (
        {MAY_BE: may_be(([1, 0], 1.0), ([2, 1], 0.0))},
        f"{MAY_BE}[1].probability: found 0.0, expected float > 0 and <= 1",
    ),
    "not where it truly is": (
        {MAY_BE: may_be(([2, 0], 0.5), ([2, 1], 0.5))},
        f"{MAY_BE}: found no [1, 0], expected it among them, for there the robot of world.start is",
    ),
    "nobody can come that way": (
        {MAY_BE: may_be(([1, 0], 0.5), ([0, 1], 0.5))},
        f"{MAY_BE}[1].at: found [0, 1], where nobody can come heading E, expected a place with a "
        f"corridor of the grid behind it",
    ),
    "anywhere": (
        {"world.start": "anywhere"},
        "world.start: found 'anywhere' beside [recall], expected where the robot truly is, one of "
        "recall.may_be_at",
    ),
    "an unknown key": (
        {"recall.place": []},
        "recall.place: found an unknown key, expected places?",
    ),
    "an unknown rule": (
        {"modules.decider.unsure": "dither"},
        'modules.decider.unsure: found \'dither\', expected "act", "least expected cost" or "look"',
    ),
    "late already": (
        {"errand": [{"from": [0, 0], "to": [2, 1], "due_s": -1.0}]},
        "errand[0].due_s: found -1.0, expected float >= 0 and <= 1e+09",
    ),
}


@pytest.mark.parametrize(("changes", "message"), WRONG.values(), ids=WRONG)
def test_what_cannot_be_is_refused_with_its_key(changes: Table, message: str) -> None:
    with pytest.raises(ScenarioError) as refused:
        draw(check(with_changes(LOST, changes), "lost.toml"), "lost.toml")
    assert str(refused.value) == f"lost.toml: {message}"


def test_the_command_line_refuses_it_with_status_2(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    said = waywiser("launch", "familiar-place", "--set", "recall.may_be_at=[]", "--in-process")
    assert said.status == 2
    assert f"{MAY_BE}: found 0 places, expected 1 to 6" in said.err
    assert not list(tmp_path.iterdir())


def test_the_modules_are_told_what_may_be_and_not_what_is() -> None:
    scenario = check(LOST, "lost.toml")
    there = with_changes(LOST, {"world.start.junction": [2, 1]})
    elsewhere = with_changes(there, {"world.corridors": [[[0, 0], [1, 0]], [[1, 0], [1, 1]],
                                                         [[1, 1], [2, 1]]]})  # fmt: skip
    told = [parts_of(s) for s in (scenario, check(there, "there"), check(elsewhere, "elsewhere"))]
    assert told[0] == told[1] == told[2], "another truth changes nothing that they are told"
    recall = told[0].facts.recall
    assert isinstance(recall, Recall)
    grid = Grid(3, 2)
    assert [(one.place, one.probability) for one in recall.may_be_at] == [
        (grid.intersection(1, 0), 0.5), (grid.intersection(2, 1), 0.5),
    ]  # fmt: skip
    assert [(one.place, one.junction_type, one.certain) for one in recall.places] == [(0, 3, 0.95)]
    assert told[0].facts.start == grid.intersection(1, 0), "the likeliest, the first of equals"


def test_it_is_kept_in_the_log_and_nothing_of_it_where_there_is_none() -> None:
    lost, aces = (parts_of(s) for s in (check(LOST, "lost"), load(find("aces"))))
    assert parts_in({"modules.json": pack_parts(lost)}, "a log") == lost
    assert parts_in({"modules.json": pack_parts(aces)}, "a log") == aces
    assert b"recall" not in pack_parts(aces)
    assert aces.facts.recall is msgspec.UNSET


def test_a_robot_that_knows_its_place_is_not_lost() -> None:
    assert draw(check(LOST, "lost"), "lost").plan.lost
    drawn = draw(load(find("aces")), "aces")
    assert not drawn.plan.lost
    assert drawn.facts.start == drawn.plan.start
