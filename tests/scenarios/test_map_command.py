"""The map command, as a user gives it."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import yaml
from PIL import Image

from scenarios.scenario import load
from simworld.occupancy import write_floor_plan
from tests.scenarios.launches import waywiser
from tests.simworld.drawn_plans import Box, corridor_boxes, drawn_plan

COLUMNS_M, ROWS_M = (0.0, 14.0, 30.0), (0.0, 13.0)
ROOM = (6.5, -5.5, 7.5, 0.0)


@pytest.fixture
def building(tmp_path: Path) -> Path:
    """A ladder with a room, turned by 12 degrees, as map.yaml and map.pgm."""
    boxes = corridor_boxes(COLUMNS_M, ROWS_M, np.ones(7, np.uint8), 2.0)
    path = tmp_path / "map.yaml"
    write_floor_plan(drawn_plan([*boxes, ROOM], np.deg2rad(12.0)), path)
    return path


def test_it_says_what_was_found(building: Path) -> None:
    said = waywiser("map", str(building))
    assert (said.status, said.err) == (0, "")
    words = " ".join(said.out.split())
    assert "6 junctions, 7 corridors; upright when turned by -1" in words
    assert re.search(r"\[1, 0\] NEW 14\.\d, -?0\.\d 0\.\d\d", words)
    assert re.search(r"\[0, 0\] - \[1, 0\] 14\.\d [12]\.\d\d", words)


def test_json_is_one_object_with_all_of_it(building: Path) -> None:
    facts = waywiser("map", str(building), "--json").json
    assert facts["status"] == 0
    assert facts["turn_deg"] == pytest.approx(-12.0, abs=0.5)
    assert facts["columns_m"] == pytest.approx(COLUMNS_M, abs=0.4)
    assert facts["rows_m"] == pytest.approx(ROWS_M, abs=0.4)
    assert [j["corridors"] for j in facts["junctions"]] == ["NE", "ES", "NEW", "ESW", "NW", "SW"]
    assert len(facts["corridors"]) == 7
    assert facts["corridors"][0]["ends"] == [[0, 0], [0, 1]]
    assert (facts["left_out"], facts["written"]) == ([], {})


def test_the_door_stub_and_doors_are_options(building: Path, tmp_path: Path) -> None:
    shown = waywiser("map", str(building), "--door-stub", "4", "--json").json
    assert len(shown["corridors"]) == 10
    c, s = np.cos(np.deg2rad(12.0)), np.sin(np.deg2rad(12.0))
    corners = [[float(c * x + s * 2.0), float(s * x - c * 2.0)] for x in (6.4, 7.6)]
    door = {"name": "room", "door_corner_pt_1": corners[0], "door_corner_pt_2": corners[1]}
    doors = tmp_path / "doors.yaml"
    doors.write_text(yaml.safe_dump([door]))
    closed = waywiser("map", str(building), "--door-stub", "4", "--doors", str(doors), "--json")
    assert len(closed.json["corridors"]) == 7


def test_the_scenario_is_ready_to_launch(building: Path, tmp_path: Path) -> None:
    file, log = tmp_path / "found.toml", tmp_path / "run.mcap"
    said = waywiser("map", str(building), "--scenario", str(file))
    assert f"scenario: {file}" in said.out
    scenario = load(file)
    assert scenario.world.columns_m == pytest.approx(COLUMNS_M, abs=0.4)
    assert isinstance(scenario.world.corridors, tuple)
    assert len(scenario.world.corridors) == 7
    assert 1.5 <= scenario.world.corridor_width_m <= 2.2
    run = waywiser("launch", str(file), "--in-process", "--log", str(log), "--json")
    assert (run.status, run.json["reason"]) == (0, "done")
    with_echoes = file.read_text().replace("# floor_plan", "floor_plan")
    file.write_text(with_echoes)
    assert load(file).world.floor_plan == str(building)


def test_the_picture_holds_plan_lines_and_names(building: Path, tmp_path: Path) -> None:
    picture = tmp_path / "found.svg"
    assert waywiser("map", str(building), "--picture", str(picture)).status == 0
    svg = ElementTree.fromstring(picture.read_text())
    space = "{http://www.w3.org/2000/svg}"
    assert len(svg.findall(f".//{space}image")) == 1
    assert [t.text for t in svg.iter(f"{space}text")][:2] == ["0,0 NE", "0,1 ES"]
    assert len(list(svg.iter(f"{space}line"))) == 3 + 2 + 7


def scans(folder: Path) -> Path:
    """A log of scans that see a wall all around at 3 m: no corridors."""
    path = folder / "robot.log"
    lines = [f"FLASER 180 {'3.0 ' * 180}0 0 {h} 0 0 0 1 host 1\n" for h in (0.0, 3.14159)]
    path.write_text("".join(lines) * 3)
    return path


def test_a_log_gives_a_plan_first(tmp_path: Path) -> None:
    plan = tmp_path / "built.yaml"
    said = waywiser("map", str(scans(tmp_path)), "--plan", str(plan), "--json")
    assert said.status == 2
    assert "robot.log: found free space without corridors" in said.json["error"]
    again = waywiser("map", str(plan), "--json")
    assert "built.yaml: found free space without corridors" in again.json["error"]


def rewritten(path: Path, **changes: object) -> None:
    keys = yaml.safe_load(path.read_text()) | changes
    path.write_text(yaml.safe_dump({k: v for k, v in keys.items() if v is not None}))


def open_floor(path: Path) -> None:
    write_floor_plan(drawn_plan([(0.0, 0.0, 30.0, 20.0)]), path)


def no_plan(path: Path) -> None:
    grey = np.random.default_rng(1).integers(0, 255, (80, 90)).astype(np.uint8)
    Image.fromarray(grey).save(path.with_suffix(".pgm"))


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (lambda p: rewritten(p, resolution=None), "resolution: found no such key, expected a pos"),
        (lambda p: rewritten(p, free_thresh=0.9), "free_thresh: found 0.9, expected a number from"),
        (lambda p: rewritten(p, image="gone.pgm"), "gone.pgm: found No such file or directory"),
        (lambda p: rewritten(p, negate=1), "no free space wider than 0.6 m, expected corridors"),
        (no_plan, "map.pgm: found a picture of many greys (the commonest three of 16 make up"),
        (open_floor, "found free space without corridors, expected passages longer than wide"),
        (lambda p: p.with_suffix(".pgm").write_text("no image"), "found no image in it"),
        (lambda p: p.unlink(), "found No such file or directory"),
    ],
)
def test_bad_maps_are_bad_input(building: Path, spoil: Callable[[Path], object], says: str) -> None:
    spoil(building)
    said = waywiser("map", str(building))
    assert (said.status, said.out) == (2, "")
    assert says in said.err
    assert str(building.parent) in said.err
    assert len(said.err.splitlines()) == 1


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (None, "doors.yaml: found No such file or directory"),
        ("a: 1", "doors.yaml: found dict, expected a list of doors"),
        ("- name: d", "door 0: door_corner_pt_1: found no such key, expected x and y in metres"),
        ("- {door_corner_pt_1: [1, here]}", "door_corner_pt_1: found [1, 'here'], expected x and"),
        ("- 7", "door 0: found 7, expected keys and values"),
    ],
)
def test_bad_doors_are_bad_input(
    building: Path, tmp_path: Path, text: str | None, says: str
) -> None:
    doors = tmp_path / "doors.yaml"
    if text is not None:
        doors.write_text(text)
    said = waywiser("map", str(building), "--doors", str(doors))
    assert said.status == 2
    assert says in said.err


@pytest.mark.parametrize(
    ("option", "name"), [("--picture", "file.svg"), ("--scenario", "x.toml"), ("--plan", "x.yaml")]
)
def test_what_cannot_be_written_is_bad_input(building: Path, option: str, name: str) -> None:
    said = waywiser("map", str(building), option, str(building / "nowhere" / name))
    assert said.status == 2
    assert "cannot be written" in said.err


def test_a_picture_of_another_kind_is_refused(building: Path, tmp_path: Path) -> None:
    said = waywiser("map", str(building), "--picture", str(tmp_path / "found.png"))
    assert said.status == 2
    assert "found.png: found .png, expected .svg" in said.err
    assert not (tmp_path / "found.png").exists()


def test_a_cut_log_and_a_bad_door_stub_are_bad_input(building: Path, tmp_path: Path) -> None:
    log = scans(tmp_path)
    log.write_text(log.read_text()[:-30])
    said = waywiser("map", str(log))
    assert said.status == 2
    assert "line 6: FLASER: found 180 values, expected 189; is it cut off?" in said.err
    assert "found 0.0 m" in waywiser("map", str(building), "--door-stub", "0").err


def test_an_image_without_its_yaml_is_bad_input(building: Path) -> None:
    said = waywiser("map", str(building.with_suffix(".pgm")))
    assert said.status == 2
    assert "map.pgm: found an image, expected the YAML file of a ROS map that names it" in said.err


def test_a_building_that_is_no_clean_grid_is_said_to_be_none(tmp_path: Path) -> None:
    boxes = corridor_boxes(COLUMNS_M, ROWS_M, np.ones(7, np.uint8), 2.0)
    assert "off the grid:" not in waywiser("map", str(drawn(tmp_path / "grid.yaml", boxes))).out
    # A fourth rung, which begins 2.9 m further west than it ends: one line, for want of room.
    bent = [(19.0, -1.0, 21.0, 4.0), (19.0, 2.0, 23.9, 4.0), (21.9, 2.0, 23.9, 14.0)]
    said = waywiser("map", str(drawn(tmp_path / "bent.yaml", [*boxes, *bent]))).out
    assert "off the grid: [" in said
    assert "more than 1.5 m from where their lines cross" in said


def drawn(path: Path, boxes: list[Box]) -> Path:
    write_floor_plan(drawn_plan(boxes), path)
    return path


def repainted(path: Path, greys: dict[int, int]) -> None:
    """Change the greys of a map's image."""
    table = np.arange(256, dtype=np.uint8)
    for old, new in greys.items():
        table[old] = new
    with Image.open(path.with_suffix(".pgm")) as image:
        pixels = table[np.asarray(image)]
    Image.fromarray(pixels).save(path.with_suffix(".pgm"))


def test_origin_negate_and_thresholds_are_honoured(building: Path) -> None:
    before = waywiser("map", str(building), "--json").json
    origin = yaml.safe_load(building.read_text())["origin"]
    rewritten(building, origin=[origin[0] + 100.0, origin[1], origin[2]])
    shifted = waywiser("map", str(building), "--json").json
    c = np.cos(np.deg2rad(before["turn_deg"]))
    moved = np.subtract(shifted["columns_m"], before["columns_m"])
    assert moved == pytest.approx([100.0 * c] * 3, abs=0.01)
    repainted(building, {0: 255, 205: 50, 254: 1})
    rewritten(building, origin=origin, negate=1)
    assert waywiser("map", str(building), "--json").json == before
    # p is 0.22 where it is free, 0.41 where unknown, 0.55 where occupied.
    repainted(building, {1: 55, 50: 105, 255: 140})
    assert waywiser("map", str(building)).status == 2
    rewritten(building, free_thresh=0.25, occupied_thresh=0.5)
    assert waywiser("map", str(building), "--json").json == before
