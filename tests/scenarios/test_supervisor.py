"""Real processes under the supervisor: clean ends, and every way in which a run is disturbed."""

from __future__ import annotations

import os
import resource
import signal
from collections.abc import Callable
from pathlib import Path

import pytest

from bus import messages as m
from bus.link import endpoint
from bus.topics import WORLD
from bus.wire import Sent
from logs.analysis import analyse
from logs.reader import read_run
from scenarios.launch import Launched, claimed_log, launch_processes, prepare
from scenarios.order import Order, write_order
from scenarios.supervisor import Progress, Supervisor
from tests.scenarios.launches import (
    ENDLESS,
    SHORT,
    ended,
    processes_of,
    start,
    wait_until,
    wait_until_running,
    waywiser,
)

EVERYONE = [
    "classifier",
    "decider",
    "detectors",
    "geographer",
    "reactor",
    "recorder",
    "sensor",
    "world",
]
STILL = 5
"""Simulated time that does not move for so many looks stands still."""

UNDER_WAY_S = 200.0
"""Simulated time at which a test disturbs a run."""


@pytest.fixture(autouse=True)
def _nothing_stays_in_shared_memory() -> object:
    shared = Path("/dev/shm")
    before = sorted(shared.glob("*zenoh*"))
    yield
    assert sorted(shared.glob("*zenoh*")) == before


@pytest.fixture(autouse=True, scope="module")
def _compiled(tmp_path_factory: pytest.TempPathFactory) -> None:
    """One run in this process first: what is compiled once must not look frozen later."""
    folder = tmp_path_factory.mktemp("compiled")
    (folder / "short.toml").write_text(SHORT)
    log = str(folder / "run.mcap")
    assert waywiser("launch", str(folder / "short.toml"), "--in-process", "--log", log).status == 0


def command(tmp_path: Path, text: str, *options: str) -> tuple[list[str], Path, Path]:
    """What to launch, its log, and its output folder."""
    scenario, log = tmp_path / "case.toml", tmp_path / "run.mcap"
    scenario.write_text(text)
    arguments = ["launch", str(scenario), "--log", str(log), *options]
    return arguments, log, log.with_suffix(".output")


def messages(log: Path) -> list[Sent]:
    with read_run(log, ("run/ended", "ledger", "percept/odometry")) as reader:
        return list(reader)


def ends_in(log: Path) -> list[str]:
    return [sent.message.reason for sent in messages(log) if isinstance(sent.message, m.RunEnded)]


def launched(
    tmp_path: Path, disturb: Callable[[int], None], victim: str, *changes: str
) -> Launched:
    """An endless run, disturbed once when it is well under way: ``disturb(pid of victim)``."""
    arguments, log, output = command(tmp_path, ENDLESS)
    disturbed: list[int] = []

    def watch(progress: Progress) -> None:
        if progress.simulated_s > UNDER_WAY_S and not disturbed:
            disturbed.append(processes_of(output)[victim])
            disturb(disturbed[0])

    prepared = prepare(arguments[1], changes, None)
    with claimed_log(prepared, str(log)) as path:
        result = launch_processes(prepared, path, watch)
    assert disturbed
    assert processes_of(output) == {}
    return result


def kill(pid: int) -> None:
    os.kill(pid, signal.SIGKILL)


def freeze(pid: int) -> None:
    os.kill(pid, signal.SIGSTOP)


def test_a_run_starts_everything_and_leaves_nothing_but_its_logs(tmp_path: Path) -> None:
    arguments, log, output = command(tmp_path, SHORT)
    seen: dict[str, dict[str, str]] = {}

    def watch(progress: Progress) -> None:
        if progress.started and "pids" not in seen:
            seen["pids"] = {name: str(pid) for name, pid in processes_of(output).items()}
        seen["states"] = dict(progress.states)

    prepared = prepare(arguments[1], [], None)
    with claimed_log(prepared, str(log)) as path:
        result = launch_processes(prepared, path, watch)
    assert sorted(seen["pids"]) == EVERYONE
    assert sorted(seen["states"].items()) == [(name, "ended") for name in EVERYONE]
    assert (result.reason, result.failed, result.output) == ("done", {}, None)
    assert ends_in(log) == ["done"]
    left = sorted(entry.name for entry in tmp_path.iterdir())
    assert left == ["case.toml", "run.mcap", "run.wall.mcap"]


def test_the_command_ends_with_0_and_says_lines_where_there_is_no_terminal(tmp_path: Path) -> None:
    arguments, _, _ = command(tmp_path, SHORT)
    said = ended(start(*arguments))
    assert said.status == 0
    assert said.err.splitlines()[0].startswith("case, seed 1: starting, ")
    assert said.out.splitlines()[0].startswith("done after 3")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_run_ends_with_a_whole_log(tmp_path: Path, number: int) -> None:
    arguments, log, output = command(tmp_path, ENDLESS, "--json")
    process = start(*arguments)
    wait_until_running(log)
    assert sorted(processes_of(output)) == EVERYONE
    process.send_signal(number)
    said = ended(process)
    assert said.status == 3
    assert said.json["reason"] == "stopped"
    assert said.json["failed"] == {}
    assert processes_of(output) == {}
    assert ends_in(log) == ["stopped"]
    assert analyse(log).reasons == ()
    assert not output.exists()


def test_an_interrupted_run_in_one_process_ends_with_a_whole_log(tmp_path: Path) -> None:
    arguments, log, _ = command(tmp_path, ENDLESS, "--json", "--in-process")
    process = start(*arguments)
    wait_until_running(log)
    process.send_signal(signal.SIGINT)
    said = ended(process)
    assert (said.status, said.json["reason"]) == (3, "stopped")
    assert ends_in(log) == ["stopped"]


def test_an_interrupt_before_the_run_has_begun_leaves_nothing(tmp_path: Path) -> None:
    arguments, log, output = command(tmp_path, ENDLESS, "--json")
    process = start(*arguments)
    wait_until(lambda: len(processes_of(output)) == len(EVERYONE), "every process")
    process.send_signal(signal.SIGINT)
    said = ended(process)
    assert (said.status, said.json["reason"], said.json["failed"]) == (3, "stopped", {})
    assert processes_of(output) == {}
    # It may just have begun; then there is a log, and it says how it ended.
    assert not log.exists() or ends_in(log) == ["stopped"]


def test_a_second_interrupt_ends_at_once(tmp_path: Path) -> None:
    arguments, log, output = command(tmp_path, ENDLESS, "--json")
    process = start(*arguments)
    wait_until_running(log)
    os.kill(processes_of(output)["world"], signal.SIGSTOP)  # or the first one would do
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGTERM)
    said = ended(process)
    assert said.status == 3
    assert said.json == {"status": 3, "error": "ended at once, as asked twice"}
    assert processes_of(output) == {}


def test_a_killed_module_ends_the_run_and_is_named(tmp_path: Path) -> None:
    result = launched(tmp_path, kill, "decider")
    assert result.reason == "process down: decider"
    assert result.failed == {"decider": "killed by SIGKILL"}
    assert ends_in(result.log) == ["process down: decider"]
    for sent in messages(result.log):
        if isinstance(sent.message, m.LedgerEntry) and sent.message.decided_ns < 0:
            assert (sent.message.kind, sent.message.cause) == ("path", "process down")
    assert analyse(result.log).reasons == ("the run ended because of a process down: decider",)


def test_what_a_killed_module_had_still_to_decide_is_in_the_ledger(tmp_path: Path) -> None:
    """Frozen first, killed once the world waits for it: what it was asked stays open."""
    arguments, log, output = command(tmp_path, ENDLESS)
    frozen: list[int] = []
    killed: list[int] = []
    times: list[float] = []

    def watch(progress: Progress) -> None:
        if not frozen and progress.simulated_s > UNDER_WAY_S:
            frozen.append(processes_of(output)["decider"])
            freeze(frozen[0])
        elif frozen and not killed:
            times.append(progress.simulated_s)
            if len(times) > STILL and times[-STILL:] == times[-1:] * STILL:
                killed.append(frozen[0])
                kill(frozen[0])

    prepared = prepare(arguments[1], [], None)
    with claimed_log(prepared, str(log)) as path:
        result = launch_processes(prepared, path, watch)
    assert result.failed == {"decider": "killed by SIGKILL"}
    entries = [sent.message for sent in messages(log) if isinstance(sent.message, m.LedgerEntry)]
    assert [(e.kind, e.cause) for e in entries if e.decided_ns < 0] == [("path", "process down")]


def test_a_killed_recorder_ends_the_run(tmp_path: Path) -> None:
    result = launched(tmp_path, kill, "recorder")
    assert result.reason == "process down: recorder"
    assert result.failed == {"recorder": "killed by SIGKILL"}
    assert analyse(result.log).inconclusive


def test_a_killed_world_leaves_nobody_behind(tmp_path: Path) -> None:
    result = launched(tmp_path, kill, "world")
    assert (result.reason, result.failed) == ("", {"world": "killed by SIGKILL"})
    assert analyse(result.log).inconclusive


def test_a_frozen_module_is_named_after_the_patience(tmp_path: Path) -> None:
    result = launched(tmp_path, freeze, "classifier", "bus.patience_s=4")
    assert result.reason == "process frozen: classifier"
    assert result.failed == {"classifier": "frozen: no answer for 4 s"}
    assert ends_in(result.log) == ["process frozen: classifier"]
    assert analyse(result.log).reasons == ("the run ended because of a process frozen: classifier",)


def test_a_process_that_dies_before_the_run_ends_it(tmp_path: Path) -> None:
    arguments, log, output = command(tmp_path, ENDLESS)
    killed: list[int] = []

    def watch(progress: Progress) -> None:
        # A process has no command line yet for a moment after it has begun.
        decider = processes_of(output).get("decider")
        if not killed and decider is not None:
            assert not progress.started
            killed.append(decider)
            kill(decider)

    prepared = prepare(arguments[1], [], None)
    with claimed_log(prepared, str(log)) as path:
        result = launch_processes(prepared, path, watch)
    assert (result.reason, result.failed) == ("", {"decider": "killed by SIGKILL"})
    assert processes_of(output) == {}
    assert not log.exists()


def test_a_process_that_fails_at_its_start_is_heard(tmp_path: Path) -> None:
    arguments, log, _ = command(tmp_path, ENDLESS)
    whole, broken = tmp_path / "run.json", tmp_path / "decider.json"
    write_order(Order("test", endpoint(0), str(log), prepare(arguments[1], [], None).script), whole)
    broken.write_text("no order at all")
    with Supervisor({WORLD: whole, "decider": broken}, tmp_path, patience_s=60.0) as supervisor:
        result = supervisor.run(lambda _: None)
    assert not supervisor.progress.started
    assert list(result.failed) == ["decider"]
    first, *_, last = result.failed["decider"].splitlines()
    assert first == "ended with status 1"
    assert last.startswith("msgspec.DecodeError: JSON is malformed")
    assert supervisor.progress.states[WORLD] == "ended by the supervisor"


def test_a_supervisor_that_is_killed_takes_all_with_it(tmp_path: Path) -> None:
    arguments, log, output = command(tmp_path, ENDLESS)
    process = start(*arguments)
    wait_until_running(log)
    assert sorted(processes_of(output)) == EVERYONE
    process.kill()
    process.communicate()
    wait_until(lambda: processes_of(output) == {}, "the orphans to leave")
    said = waywiser("analyse", str(log))
    assert said.status == 3
    assert "the log is truncated" in " ".join(said.out.split())


def test_a_disk_that_fills_up_ends_the_run_at_once(tmp_path: Path) -> None:
    arguments, log, output = command(tmp_path, ENDLESS, "--json")
    limit = 300_000

    def fill() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    said = ended(start(*arguments, preexec_fn=fill))
    assert said.status == 3
    assert said.json["reason"] == "process down: recorder"
    assert list(said.json["failed"]) == ["recorder"]
    assert f"{log}: cannot write the log: File too large" in said.json["failed"]["recorder"]
    assert f"{log}: cannot write the log: File too large" in said.json["error"]
    assert log.stat().st_size <= limit
    assert processes_of(output) == {}


def test_a_full_disk_is_noticed_before_the_run(tmp_path: Path) -> None:
    arguments, _, _ = command(tmp_path, SHORT, "--json", "--log", "/dev/full")
    said = ended(start(*arguments, env={**os.environ, "TMPDIR": str(tmp_path)}))
    assert said.status == 3
    assert list(said.json["failed"]) == ["recorder"]
    words = "/dev/full: cannot write the log: No space left on device"
    assert words in said.json["failed"]["recorder"]
