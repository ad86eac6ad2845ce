"""Whatever a user gets wrong: status 2, one message with file, key, found, expected, no trace."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.scenarios.launches import SHORT, Ended, ended, start, waywiser

OFFICE = """\
about = "Six intersections"
[world]
columns_m = [0.0, 20.0, 41.0]
rows_m = [0.0, 19.0]
corridors = "all"
[[errand]]
from = [0, 0]
to = [2, 1]
"""

PLAN = "image: plan.png\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
L_SHAPE = "[[[0, 0], [0, 1]], [[0, 1], [1, 1]], [[1, 1], [2, 1]]]"


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def corridors(text: str) -> str:
    return OFFICE.replace('"all"', text)


def world(line: str) -> str:
    return OFFICE.replace('"all"', f'"all"\n{line}')


def launch(text: str, *options: str) -> Ended:
    Path("office.toml").write_text(text)
    return waywiser("launch", "office.toml", "--in-process", "--log", "run.mcap", *options)


def refused(said: Ended, message: str) -> None:
    """One message, status 2, and no log left."""
    assert said.err == f"waywiser: {message}\n"
    assert (said.status, said.out) == (2, "")
    assert not Path("run.mcap").exists()
    assert not Path("run.output").exists()


FILES = {
    "unknown key": ("sede = 3\n" + OFFICE, "sede: found an unknown key, expected seed?"),
    "unknown key of a table": (
        world('floorplan = "x"'),
        "world.floorplan: found an unknown key, expected floor_plan?",
    ),
    "unknown key of an entry": (
        OFFICE + "expects_again = 3\n",
        "errand[0].expects_again: found an unknown key, expected expected_again?",
    ),
    "unknown key, nothing like it": (
        OFFICE + "colour = 3\n",
        "errand[0].colour: found an unknown key, expected one of from, to, expected_again, due_s, "
        "late_price",
    ),
    "unknown key deep down": (
        OFFICE + "[[world.person]]\nenters = { at_s = 3, corrdor = 1 }\n",
        "world.person[0].enters.corrdor: found an unknown key, expected corridor?",
    ),
    "missing key": (
        OFFICE.replace("rows_m = [0.0, 19.0]\n", ""),
        "world.rows_m: found nothing, expected array of float",
    ),
    "empty file": ("", "about: found nothing, expected string"),
    "wrong type": (
        OFFICE.replace("20.0", '"wide"'),
        "world.columns_m[1]: found 'wide', expected float",
    ),
    "wrong type, true": (
        world("speed_m_s = true"),
        "world.speed_m_s: found true, expected float >= 0.001 and <= 10",
    ),
    "wrong length": (
        OFFICE.replace("[2, 1]", "[2]"),
        "errand[0].to: found [2], expected [integer, integer]",
    ),
    "wrong word": (
        OFFICE + '[compute]\nprofile = "fast"\n',
        'compute.profile: found \'fast\', expected "free", "host" or "huey-1990"',
    ),
    "wrong alternative": (
        OFFICE + "[compute]\nprocessors = 0\n",
        'compute.processors: found 0, expected integer >= 1 or "one each"',
    ),
    "wrong entry of a free table": (
        OFFICE + '[compute.slower]\npath = "much"\n',
        "compute.slower.path: found 'much', expected float >= 0 and <= 1e+09",
    ),
    "unknown kind of work": (
        OFFICE + "[compute.slower]\npaths = 1\n",
        "compute.slower.paths: found an unknown kind of work, expected path?",
    ),
    "not a date": (
        "epoch = 3\n" + OFFICE,
        "epoch: found 3, expected date and time with its offset, for example 2026-01-01T00:00:00Z",
    ),
    "a date that depends on the machine": (
        "epoch = 2026-01-01T00:00:00\n" + OFFICE,
        "epoch: found 2026-01-01T00:00:00, expected date and time with its offset, "
        "for example 2026-01-01T00:00:00Z",
    ),
    "a date that no log can hold": (
        "epoch = 1969-01-01T00:00:00Z\n" + OFFICE,
        "epoch: found the year 1969, expected one from 1970 to 2500",
    ),
    "not a number": (
        OFFICE.replace("20.0", "nan"),
        "world.columns_m[1]: found nan, expected a finite number",
    ),
    "infinity": (world("until_s = inf"), "world.until_s: found inf, expected a finite number"),
    "more than 64 bits": (
        f"seed = {2**63}\n" + OFFICE,
        f"seed: found {2**63}, expected at most {2**63 - 1}",
    ),
    "negative time": (
        OFFICE + "[[world.person]]\nenters = { at_s = -3 }\n",
        "world.person[0].enters.at_s: found -3, expected float >= 0 and <= 1e+09",
    ),
    "a hop of no time": (
        OFFICE + "[bus]\nhop_s = 1e-12\n",
        "bus.hop_s: found 1e-12, expected float >= 1e-09 and <= 1",
    ),
    "corridor outside the grid": (
        corridors("[[[0, 0], [0, 7]]]"),
        "world.corridors[0]: found intersection [0, 7], expected x from 0 to 2 and y from 0 to 1",
    ),
    "no neighbours": (
        corridors("[[[0, 0], [1, 0]], [[0, 0], [2, 0]]]"),
        "world.corridors[1]: found [0, 0] to [2, 0], expected two neighbouring intersections",
    ),
    "disconnected": (
        corridors("[[[0, 0], [0, 1]], [[2, 0], [2, 1]]]"),
        "world.corridors: found [2, 0]-[2, 1] apart from [0, 0] and what it leads to, "
        "expected one connected building",
    ),
    "no corridors": (corridors("[]"), "world.corridors: found none, expected at least one"),
    "no density": (
        corridors("{ random = true, density = 0.0 }"),
        "world.corridors.density: found 0.0, expected float > 0 and <= 1",
    ),
    "one intersection": (
        OFFICE.replace("[0.0, 20.0, 41.0]", "[0.0]").replace("[0.0, 19.0]", "[0.0]"),
        "world.columns_m and world.rows_m: found 1 and 1 lines, "
        "expected at least one each and two intersections",
    ),
    "lines out of order": (
        OFFICE.replace("20.0", "50.0"),
        "world.columns_m: found 50.0 then 41.0 at 1 and 2, expected increasing lines",
    ),
    "unknown module": (
        OFFICE + "[modules.decidr]\n",
        "modules.decidr: found an unknown module, expected decider?",
    ),
    "unknown module setting": (
        OFFICE + "[modules.decider]\nhypothesis = 1\n",
        "modules.decider.hypothesis: found an unknown key, expected hypotheses?",
    ),
    "a module without settings": (
        OFFICE + "[modules.sensor]\nrange_m = 1\n",
        "modules.sensor.range_m: found an unknown key, expected none here",
    ),
    "wrong module setting": (
        OFFICE + '[modules.decider]\nhypotheses = "some"\n',
        "modules.decider.hypotheses: found 'some', "
        'expected integer >= 1 and <= 64 or "as many as fit"',
    ),
    "a module that is no table": (
        OFFICE + "[modules]\nsensor = {}\ndecider = 3\n",
        "modules.decider: found 3, expected table",
    ),
    "errand off the map": (
        corridors("[[[0, 0], [0, 1]]]"),
        "errand[0].to: found [2, 1], where no corridor leads, expected a junction of the building",
    ),
    "errand off the grid": (
        OFFICE.replace("[2, 1]", "[2, 7]"),
        "errand[0].to: found intersection [2, 7], expected x from 0 to 2 and y from 0 to 1",
    ),
    "both kinds of errands": (
        OFFICE + "[random_errands]\ncount = 3\n",
        "random_errands: found beside [[errand]], expected only one of the two",
    ),
    "no way to the start": (
        corridors(L_SHAPE + '\nstart = { junction = [0, 0], heading = "E" }'),
        "world.start: found heading E into [0, 0], "
        "expected one by which a corridor of the building leads there",
    ),
    "a start too far ahead": (
        world('start = { junction = [0, 0], heading = "W", ahead_m = 90.0 }'),
        "world.start.ahead_m: found 90, expected at most the corridor's 18 m",
    ),
    "person off the grid": (
        OFFICE + '[[world.person]]\nenters = { at_s = 3, corridor = "0,0-7,0" }\n',
        "world.person[0].enters.corridor: found intersection [7, 0], "
        "expected x from 0 to 2 and y from 0 to 1",
    ),
    "person in a corridor that is not there": (
        corridors(L_SHAPE) + '[[world.person]]\nenters = { at_s = 3, corridor = "0,0-1,0" }\n',
        "world.person[0].enters.corridor: found '0,0-1,0', expected a corridor of the building",
    ),
    "person nowhere": (
        OFFICE + '[[world.person]]\nenters = { at_s = 3, corridor = "lobby" }\n',
        "world.person[0].enters.corridor: found 'lobby', expected a pair as \"0,0-1,0\"",
    ),
    "an expectation of nothing": (
        OFFICE + '[[expect]]\ndecision = "path"\n',
        "expect[0]: found no condition, expected one of late, slack_at_least_s, errands_done, "
        "true_map_at_least, collisions",
    ),
    "broken TOML": (
        OFFICE + "[world\n",
        "found Cannot declare ('world',) twice (at line 9, column 7), expected TOML",
    ),
    "missing floor plan": (
        world('floor_plan = "nosuch.yaml"'),
        "world.floor_plan: nosuch.yaml: found No such file or directory, "
        "expected a map_server YAML file",
    ),
    "a grid that the geographer cannot do": (
        OFFICE.replace("[0.0, 20.0, 41.0]", str([20.0 * k for k in range(11)])).replace(
            "[0.0, 19.0]", str([20.0 * k for k in range(11)])
        ),
        "geographer: a grid of 11 by 11 lines has 2476901 frontier states for each of 121 "
        "intersections: 2997048274 cells an update, 2.2 GiB a belief; the shorter side may have at "
        "most 10 lines",
    ),
}


@pytest.mark.parametrize(("text", "message"), FILES.values(), ids=FILES)
def test_a_bad_file_is_refused_with_its_key(text: str, message: str) -> None:
    refused(launch(text), f"office.toml: {message}")


PLANS = {
    "no resolution": (
        PLAN,
        "plan.yaml: resolution: found no such key, expected a positive number of metres",
    ),
    "no image file": (
        PLAN + "resolution: 0.05\n",
        "plan.png: found No such file or directory, expected an image file",
    ),
    "no image": (
        (PLAN + "resolution: 0.05\n").replace("plan.png", "plan.yaml"),
        "plan.yaml: found no image in it, expected an image file",
    ),
    "no map_server file": (
        "just words",
        "plan.yaml: found str, expected keys and values as map_server's",
    ),
}


@pytest.mark.parametrize(("plan", "message"), PLANS.values(), ids=PLANS)
def test_a_bad_floor_plan_is_refused_with_its_file(plan: str, message: str) -> None:
    Path("plan.yaml").write_text(plan)
    said = launch(world('floor_plan = "plan.yaml"'))
    refused(said, f"office.toml: world.floor_plan: {message}")


CHANGES = {
    "an entry that there is not": (
        "errand.1.due_s=3",
        "--set errand.1.due_s=3: found errand with 1 entries, expected a table there",
    ),
    "a name for a number": (
        "errand.first.due_s=3",
        "--set errand.first.due_s=3: found errand with 1 entries, expected a table there",
    ),
    "an array for a table": (
        "errand.due_s=3",
        "--set errand.due_s=3: found errand = [{'from': [0, 0], 'to': [2, 1]}], expected a table "
        "there",
    ),
    "no value": ("seed", "--set seed: found no KEY=VALUE, expected for example seed=2"),
    "no key": ("=3", "--set =3: found no KEY=VALUE, expected for example seed=2"),
    "a gap in the key": (
        "world..x=3",
        "--set world..x=3: found no KEY=VALUE, expected for example seed=2",
    ),
    "unknown key": (
        "world.sped_m_s=3",
        "office.toml --set world.sped_m_s=3: world.sped_m_s: found an unknown key, "
        "expected speed_m_s?",
    ),
    "wrong type": (
        "seed=many",
        "office.toml --set seed=many: seed: found 'many', expected integer >= 0",
    ),
    "into a number": (
        "world.speed_m_s.x=3",
        "office.toml --set world.speed_m_s.x=3: world.speed_m_s: found a table of x, "
        "expected float >= 0.001 and <= 10",
    ),
    "into a list": (
        "errand.to=[1, 1]",
        "--set errand.to=[1, 1]: found errand = [{'from': [0, 0], 'to': [2, 1]}], "
        "expected a table there",
    ),
}


@pytest.mark.parametrize(("change", "message"), CHANGES.values(), ids=CHANGES)
def test_a_bad_change_is_refused(change: str, message: str) -> None:
    refused(launch(OFFICE, "--set", change), message)


def test_a_change_reaches_the_scenario() -> None:
    said = launch(OFFICE, "--json", "--set", "world.until_s=9.5")
    assert (said.status, said.json["simulated_s"]) == (0, 9.5)


def test_a_change_reaches_an_entry_of_an_array() -> None:
    refused(
        launch(OFFICE, "--set", "errand.0.due_s=-1"),
        "office.toml --set errand.0.due_s=-1: errand[0].due_s: found -1, "
        "expected float >= 0 and <= 1e+09",
    )


LOGS = {
    "a folder": (".", "Is a directory"),
    "a folder that cannot be made": ("/proc/nosuch/run.mcap", "No such file or directory"),
    "a file for a folder": ("office.toml/run.mcap", "File exists"),
}


@pytest.mark.parametrize(("log", "why"), LOGS.values(), ids=LOGS)
def test_a_log_that_cannot_be_written_is_refused(log: str, why: str) -> None:
    said = launch(OFFICE, "--log", log)
    expected = "expected a file in a folder that can"
    refused(said, f"--log {log}: found that it cannot be written ({why}), {expected}")


def test_a_full_disk_is_no_verdict() -> None:
    said = launch(OFFICE, "--log", "/dev/full")
    message = "waywiser: /dev/full: cannot write the log: No space left on device\n"
    assert (said.status, said.err) == (3, message)


def test_what_is_refused_leaves_an_older_log_alone() -> None:
    Path("run.mcap").write_bytes(b"an older run")
    Path("office.toml").write_text("seed = -1\n" + OFFICE)
    assert waywiser("launch", "office.toml", "--log", "run.mcap").status == 2
    assert Path("run.mcap").read_bytes() == b"an older run"


@pytest.fixture
def taken_port() -> Iterator[int]:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        yield int(taken.getsockname()[1])


def test_an_occupied_port_is_refused(taken_port: int) -> None:
    Path("office.toml").write_text(f"{OFFICE}[bus]\nport = {taken_port}\n")
    refused(
        waywiser("launch", "office.toml", "--log", "run.mcap"),
        f"office.toml: bus.port: found port {taken_port} taken on 127.0.0.1 "
        "(Address already in use), expected a free port (0 picks one)",
    )


def test_a_missing_file_is_answered_with_the_shipped_scenarios() -> None:
    said = waywiser("launch", "nosuch.toml")
    first, *listed = said.err.splitlines()
    assert first == "waywiser: nosuch.toml: found no such file, expected a TOML file or one of"
    assert said.status == 2
    assert {"aces", "office-4x4"} <= {line.split()[0] for line in listed}


def test_json_is_one_object_also_when_refused() -> None:
    said = launch("seed = -1\n" + OFFICE, "--json")
    assert said.status == 2
    assert said.json == {
        "status": 2,
        "error": "office.toml: seed: found -1, expected integer >= 0",
    }


def test_a_real_process_refuses_alike() -> None:
    Path("office.toml").write_text(SHORT.replace("20.0", '"wide"'))
    said = ended(start("launch", "office.toml", "--log", "run.mcap"))
    refused(said, "office.toml: world.columns_m[1]: found 'wide', expected float")


def test_a_real_process_says_usage_errors_with_status_2() -> None:
    said = ended(start("launch", "--sped", "3"))
    assert said.status == 2
    assert "No such option" in said.err


def test_a_module_that_refuses_in_its_own_process_is_heard() -> None:
    text, message = FILES["a grid that the geographer cannot do"]
    Path("office.toml").write_text(text)
    said = ended(start("launch", "office.toml", "--log", "run.mcap", "--json"))
    assert said.status == 2
    assert said.json == {"status": 2, "error": f"office.toml: {message}"}
    assert not Path("run.mcap").exists()
    assert not Path("run.output").exists()
