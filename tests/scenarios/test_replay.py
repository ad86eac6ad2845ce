"""A module alone, fed what it heard, says what the log says, or is found out."""

from __future__ import annotations

import re
from collections.abc import Callable
from io import StringIO
from pathlib import Path

import pytest

from bus.coordinator import Coordinator
from bus.topics import MODULES
from bus.turns import Module
from logs.first_difference import first_difference
from logs.reader import read_run
from logs.replay.replay import Replayed
from logs.run_log import RunLog
from scenarios import costs, replaying
from scenarios.debugger import Debugger
from scenarios.parts import PartsError, parts_in, parts_of
from scenarios.replaying import ReplayError, replay
from tests.scenarios import mutants, spoilt
from tests.scenarios.launches import waywiser
from tests.scenarios.mutants import mutant
from tests.scenarios.mutations import little_log
from tests.scenarios.runs import LITTLE, scenario_of

DECIDER_DOWN = "the run ended because of a process down: decider"

Build = Callable[..., Module]


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return little_log(tmp_path_factory.mktemp("base") / "base.mcap")


@pytest.fixture
def built(monkeypatch: pytest.MonkeyPatch) -> Callable[[Build], None]:
    """Makes the working tree's modules others."""

    def change(build: Build) -> None:
        monkeypatch.setattr(replaying, "build_module", build)

    return change


def with_messages(log: Path, out: Path, keep: Callable[[str, int], bool]) -> Path:
    """The same log with only those messages that are kept, told by topic and number."""
    with read_run(log) as reader, RunLog(out, 0, reader.metadata, reader.attachments) as new:
        for sent in reader:
            if keep(sent.topic, sent.sequence):
                new.write(sent)
    return out


def cut(log: Path, out: Path, share: float = 0.6) -> Path:
    data = log.read_bytes()
    out.write_bytes(data[: round(share * len(data))])
    return out


def check_equal(replayed: Replayed) -> None:
    assert (replayed.first, replayed.unlike, replayed.incomplete) == (None, 0, ())
    assert replayed.handlers >= 10
    assert replayed.said >= 5


@pytest.mark.parametrize("module", MODULES)
def test_every_module_says_again_what_the_log_says(module: str, log: Path) -> None:
    check_equal(replay(log, module))


def test_queues_do_not_matter(tmp_path: Path) -> None:
    busy = little_log(
        tmp_path / "busy.mcap", compute__profile="huey-1990", compute__processors=1, seed=3
    )
    for module in MODULES:
        check_equal(replay(busy, module))


def test_a_run_that_lost_a_process_is_replayed_up_to_its_end(tmp_path: Path) -> None:
    killed = little_log(tmp_path / "killed.mcap", fault=[{"kill": "decider", "at_s": 100.0}])
    for module in MODULES:
        replayed = replay(killed, module)
        assert replayed.first is None
        assert replayed.handlers > 0
        assert replayed.incomplete == (DECIDER_DOWN,)


def test_what_a_killed_process_was_about_to_say_is_not_missed(tmp_path: Path) -> None:
    busy = little_log(
        tmp_path / "busy.mcap",
        compute__slower={"path": 20.0},
        fault=[{"kill": "decider", "at_s": 10.0}],
    )
    replayed = replay(busy, "decider")
    assert (replayed.first, replayed.incomplete, replayed.said) == (None, (DECIDER_DOWN,), 0)
    assert replayed.until_ns > 10_000_000_000


@pytest.mark.parametrize("module", MODULES)
def test_a_module_that_costs_more_is_found(
    module: str, log: Path, built: Callable[[Build], None]
) -> None:
    built(mutant(module, mutants.costlier))
    replayed = replay(log, module)
    assert replayed.first is not None
    assert (replayed.first.source, replayed.first.kind) == (module, "cost")
    assert replayed.first.heard_the_same
    assert set(replayed.kinds) == {"cost"}
    others = [other for other in MODULES if other != module]
    check_equal(replay(log, others[0]))


def test_replay_and_diff_name_the_same_event(
    log: Path, tmp_path: Path, built: Callable[[Build], None]
) -> None:
    for change in (mutants.costlier, mutants.contrary, mutants.dropping(2), mutants.repeating(2)):
        build = mutant("decider", change)
        built(build)
        replayed = replay(log, "decider").first
        found = first_difference(log, little_log(tmp_path / "new.mcap", build))
        assert replayed is not None and found is not None
        assert (replayed.at_ns, replayed.source, replayed.kind, replayed.what) == (
            found.at_ns,
            found.source,
            found.kind,
            found.what,
        )


def test_one_message_less_is_one_difference(log: Path, built: Callable[[Build], None]) -> None:
    built(mutant("sensor", mutants.dropping(20)))
    replayed = replay(log, "sensor")
    assert replayed.first is not None
    assert (replayed.first.kind, replayed.first.topic) == ("missing", "belief/ranges")
    assert (replayed.unlike, replayed.kinds) == (1, {"missing": 1})


def test_choices_that_are_others_are_told(log: Path, built: Callable[[Build], None]) -> None:
    built(mutant("decider", mutants.contrary))
    replayed = replay(log, "decider")
    assert replayed.flipped
    assert replayed.unlike == len(replayed.flipped)
    assert all(one.flips[0].startswith("type NESW: ") for one in replayed.flipped)


def test_what_is_printed_is_compared(log: Path, built: Callable[[Build], None]) -> None:
    built(mutant("detectors", mutants.talkative))
    replayed = replay(log, "detectors")
    assert replayed.first is not None
    assert (replayed.first.kind, replayed.first.topic) == ("extra", "output")


def test_a_module_that_prints_is_replayed(tmp_path: Path, built: Callable[[Build], None]) -> None:
    build = mutant("detectors", mutants.talkative)
    log = little_log(tmp_path / "said.mcap", build)
    built(build)
    check_equal(replay(log, "detectors"))


def test_a_module_that_reads_the_wall_clock_does_not_repeat(
    tmp_path: Path, built: Callable[[Build], None]
) -> None:
    log = little_log(tmp_path / "wall.mcap", spoilt.build("wall clock"))
    built(spoilt.build("wall clock"))
    replayed = replay(log, "geographer")
    assert replayed.first is not None
    assert (replayed.first.source, replayed.first.kind) == ("geographer", "cost")
    check_equal(replay(log, "decider"))


@pytest.mark.parametrize("kind", [mutants.SwappedCoordinator, mutants.DeafCoordinator])
def test_modules_are_cleared_of_what_the_clock_did(
    kind: type[Coordinator], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    mutants.coordinated_by(monkeypatch, kind)
    log = little_log(tmp_path / "new.mcap", compute__processors=1)
    for module in MODULES:
        found = replay(log, module)
        assert found.first is None
        # what was lost on its way stands out, for it was heard first and never handled
        assert not found.incomplete or (module, kind.__name__) == ("classifier", "DeafCoordinator")


def test_an_exception_is_a_difference(log: Path, built: Callable[[Build], None]) -> None:
    built(mutant("geographer", mutants.failing(7)))
    replayed = replay(log, "geographer")
    assert replayed.first is not None
    assert (replayed.first.kind, replayed.handlers) == ("failure", 6)
    assert "geographer raised RuntimeError: no more at " in replayed.first.what
    assert "mutants.py:" in replayed.first.what


def test_a_log_that_was_cut_off_is_replayed_as_far_as_it_goes(log: Path, tmp_path: Path) -> None:
    for module in MODULES:
        replayed = replay(cut(log, tmp_path / "cut.mcap"), module)
        assert replayed.first is None
        assert replayed.handlers > 5
        assert "truncated" in replayed.incomplete[0]


def test_the_turn_that_a_module_did_not_survive_is_tried_again(
    tmp_path: Path, built: Callable[[Build], None]
) -> None:
    log, build = tmp_path / "crashed.mcap", mutant("decider", mutants.failing(5))
    with pytest.raises(RuntimeError, match="no more"):
        little_log(log, build)
    sound = replay(log, "decider")
    assert sound.first is None
    assert sound.last_turn.endswith("handled without an exception")
    assert sound.incomplete == ("the log does not say why the run ended",)
    built(build)
    crashed = replay(log, "decider")
    assert crashed.first is None
    assert "it raises RuntimeError: no more at " in crashed.last_turn
    assert crashed.handlers == sound.handlers == 4


def test_it_stops_before_a_time(log: Path) -> None:
    whole, half = replay(log, "sensor"), replay(log, "sensor", 300_000_000_000)
    assert 0 < half.handlers < whole.handlers
    assert half.until_ns < 300_100_000_000
    assert (half.first, half.incomplete) == (None, ())


@pytest.mark.parametrize("lost", ["prior/junction", "clock/span", "decision/sensing"])
def test_what_the_log_lacks_is_told_and_nothing_is_made_up(
    lost: str, log: Path, tmp_path: Path
) -> None:
    with read_run(log, [lost]) as reader:
        numbers = [
            sent.sequence
            for sent in reader
            if getattr(sent.message, "process", "classifier") == "classifier"
        ]
    third = numbers[2]
    holed = with_messages(
        log, tmp_path / "holed.mcap", lambda topic, number: (topic, number) != (lost, third)
    )
    replayed = replay(holed, "classifier")
    assert replayed.incomplete
    assert replayed.handlers < replay(log, "classifier").handlers


def test_prices_are_those_of_the_log(
    log: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(costs, "HOST_FILE", tmp_path / "none.json")
    check_equal(replay(log, "decider"))


def test_the_log_keeps_what_the_modules_were_told(log: Path) -> None:
    with read_run(log) as reader:
        parts = parts_in(reader.attachments, "log")
    assert parts == parts_of(scenario_of(LITTLE))
    with pytest.raises(PartsError, match=r"log: found no attachment modules\.json"):
        parts_in({}, "log")
    with pytest.raises(PartsError, match=r"attachment modules\.json: "):
        parts_in({"modules.json": b"{}"}, "log")
    with pytest.raises(ReplayError, match=r"--module: found 'decide', expected decider\?"):
        replay(log, "decide")


def debugged(monkeypatch: pytest.MonkeyPatch, typed: str, from_ns: int | None) -> Debugger:
    monkeypatch.setattr("sys.stdin", StringIO(typed))
    return Debugger(from_ns)


def test_the_debugger_breaks_in_the_handler_at_a_time(
    log: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    debugger = debugged(monkeypatch, "p turn.start_ns\np said\nc\n", 300_000_000_000)
    check_equal(replay(log, "decider", None, debugger))
    said = capsys.readouterr().out
    assert "handling message ('" in said
    assert "decider/process.py" in said
    start_ns = re.search(r"\(Pdb\) (\d{9,})", said)
    assert start_ns is not None and int(start_ns[1]) >= 300_000_000_000


def test_a_handler_that_is_left_in_its_middle_is_no_difference(
    log: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stdin", StringIO("n\nq\n"))
    ended = waywiser("replay", str(log), "--module", "decider", "--pdb", "--until", "300")
    assert ended.status == 3
    assert "left the debugger, nothing was compared" in ended.err


def test_the_debugger_breaks_at_the_first_difference(
    log: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    built: Callable[[Build], None],
) -> None:
    built(mutant("decider", mutants.contrary))
    debugger = debugged(monkeypatch, "p 'now', said[-1].topic, turn.said[-1].topic\nc\n", None)
    assert replay(log, "decider", None, debugger).flipped
    said = capsys.readouterr().out
    assert "the first difference, at " in said
    assert "('now', 'decision/path', 'decision/path')" in said


def test_the_debugger_looks_at_an_exception(
    log: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    built: Callable[[Build], None],
) -> None:
    built(mutant("decider", mutants.failing(5)))
    debugger = debugged(monkeypatch, "p number\nq\n", None)
    assert replay(log, "decider", None, debugger).first is not None
    said = capsys.readouterr().out
    assert "RuntimeError: no more at" in said
    assert "(Pdb) 5" in said


def test_the_command_says_how_it_went(
    log: Path, tmp_path: Path, built: Callable[[Build], None]
) -> None:
    good = waywiser("replay", str(log), "--module", "geographer")
    assert good.status == 0
    assert "no difference: all that it says is as in the log, bit for bit" in good.out
    short = waywiser(
        "replay", str(cut(log, tmp_path / "cut.mcap")), "--module", "geographer", "--json"
    )
    assert (short.status, short.json["status"], short.json["first"]) == (3, 3, None)
    built(mutant("decider", mutants.contrary))
    other = waywiser("replay", str(log), "--module", "decider")
    assert other.status == 1
    assert "content: decider, handling " in other.out
    assert "decision/path" in other.out and "type NESW: " in other.out
    as_json = waywiser("replay", str(log), "--module", "decider", "--json").json
    assert as_json["first"]["fields"][0]["field"] == "direction[15]"


@pytest.mark.parametrize(
    "arguments, words",
    [
        (("{log}", "--module", "world"), "--module: found 'world', expected one of classifier"),
        (("no.mcap", "--module", "decider"), "no.mcap: cannot be read"),
        (("{log}", "--module", "decider", "--pdb", "--json"), "--pdb: found beside --json"),
        (("{bare}", "--module", "decider"), "found no attachment modules.json"),
    ],
)
def test_bad_input_is_told(
    arguments: tuple[str, ...], words: str, log: Path, tmp_path: Path
) -> None:
    bare = tmp_path / "bare.mcap"
    RunLog(bare, 0, {"hop_ns": "100000"}, {}).close()
    ended = waywiser("replay", *(a.format(log=log, bare=bare) for a in arguments))
    assert ended.status == 2
    assert words in ended.err
