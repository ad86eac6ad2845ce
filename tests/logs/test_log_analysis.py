"""What an analysis says of a run whose numbers are known by construction (see conftest)."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

import msgspec
import numpy as np
import pytest

from bus.topics import TOPICS
from bus.wire import Sent
from logs.analysis import Analysis, Errand, RefusedMessages, analyse, to_json
from logs.decisions import Decisions, LateDecision
from logs.loads import Load
from logs.reader import LogReadError

MakeLog: TypeAlias = Callable[[list[Sent]], Path]


@pytest.fixture
def analysis(run_path: Path) -> Analysis:
    return analyse(run_path)


def _changed(run: list[Sent], topic: str, **fields: object) -> list[Sent]:
    """A run with fields of every message on one topic changed."""
    return [
        replace(sent, message=msgspec.structs.replace(sent.message, **fields))
        if sent.topic == topic
        else sent
        for sent in run
    ]


def test_each_kind_of_decision_is_summed_up(analysis: Analysis) -> None:
    sensing, path, reaction = analysis.decisions
    # asked at 40 s until 70 s, decided at 60 s: 10 s to spare. A second one was asked for at
    # 570 s and the run ended before it was settled
    assert sensing == Decisions("sensing", 1, 1, 0, 0, 1, 10.0, 10.0, 10.0, 0.0, {})
    # slack 240 - 50 = 190 s, 480 - 500 = -20 s, never: median of the two that came
    # (190 - 20) / 2 = 85 s; idle 20 s and 10 s
    causes = {"message lost": 1, "overrun": 1}
    assert path == Decisions("path", 3, 1, 2, 1, 0, -20.0, 85.0, 190.0, 30.0, causes)
    assert reaction == Decisions("reaction", 1, 1, 0, 0, 0, 1.0, 1.0, 1.0, 0.0, {})


def test_each_late_decision_says_by_how_much_and_why(analysis: Analysis) -> None:
    assert analysis.late == (
        LateDecision(4, "path", 2, 300.0, 480.0, 500.0, -20.0, 4000, 4, 20.0, "stand", "overrun"),
        LateDecision(
            6, "path", 3, 500.0, 550.0, None, None, 6000, 4, 10.0, "stand", "message lost"
        ),
    )


def test_a_late_decision_makes_the_verdict(
    analysis: Analysis, run: list[Sent], make_log: MakeLog
) -> None:
    assert (analysis.verdict, analysis.reasons, analysis.inconclusive) == ("late", (), False)
    in_time = _changed(run, "ledger", decided_ns=0, slack_ns=0, cause="")
    assert analyse(make_log(in_time)).verdict == "in time"  # a slack of nothing is in time
    just_late = analyse(make_log(_changed(run, "ledger", decided_ns=0, slack_ns=-1, cause="")))
    assert just_late.verdict == "late"
    assert just_late.decisions[1].causes == {"unknown": 3}


def test_errands_are_compared_with_the_shortest_way(analysis: Analysis) -> None:
    errands = analysis.errands
    assert errands.each == (
        Errand(1, (0, 0), (1, 1), 500.0, 400.0, 1.25),
        Errand(2, (1, 1), (0, 0), 90.0, 200.0, 0.45),
    )
    assert (errands.number, errands.time_s, errands.shortest_s) == (2, 590.0, 600.0)
    assert errands.ratio == pytest.approx(590 / 600)


def test_an_errand_of_no_length_has_no_ratio(run: list[Sent], make_log: MakeLog) -> None:
    errands = analyse(make_log(_changed(run, "truth/errand", shortest_s=0.0))).errands
    assert [errand.ratio for errand in errands.each] == [None, None]
    assert errands.ratio is None


def test_sensing_actions_are_counted_per_classified_junction(analysis: Analysis) -> None:
    sensing = analysis.sensing
    assert (sensing.readings, sensing.visits, sensing.per_visit) == (2, 1, 2.0)


def test_the_final_belief_is_compared_with_the_building(analysis: Analysis) -> None:
    belief = analysis.belief
    assert belief is not None
    # corridors 1 0 1 1 at .999 .002 .995 .4: three known rightly, the last one open
    assert (belief.right, belief.wrong, belief.open) == (3, 0, 1)
    # the true map is the first of the list
    assert belief.true_map == math.exp(-0.5)
    assert (belief.sampled, belief.note, belief.at_s, belief.visit) == (True, "", 598.0, 2)
    assert belief.entropy == 0.25


def test_a_true_map_that_was_not_sampled_is_said_to_be_so(
    run: list[Sent], make_log: MakeLog
) -> None:
    corridors = np.array([0, 0, 1, 1], np.uint8)
    belief = analyse(make_log(_changed(run, "truth/building", corridors=corridors))).belief
    assert belief is not None
    assert (belief.true_map, belief.sampled) == (0.0, False)
    assert belief.note == "not among the sampled maps"
    # corridor 0 is believed in at .999 and does not exist
    assert (belief.right, belief.wrong, belief.open) == (2, 1, 1)


@pytest.mark.parametrize("topic", ["truth/building", "belief/map"])
def test_without_belief_or_truth_nothing_is_compared(
    topic: str, run: list[Sent], make_log: MakeLog
) -> None:
    analysis = analyse(make_log([sent for sent in run if sent.topic != topic]))
    assert analysis.belief is None


def test_encounters_are_summed_up(analysis: Analysis) -> None:
    met = analysis.encounters
    assert (met.number, met.collisions, met.closest_m, met.delay_s) == (2, 1, 0.1, 15.0)


def test_refused_messages_are_counted_by_reason(analysis: Analysis) -> None:
    assert analysis.refused == (RefusedMessages("ledger", "intruder", "unknown source", 1),)


def test_the_load_of_a_process_is_its_busy_time_over_the_duration(analysis: Analysis) -> None:
    # geographer: 1 s; decider: 50 s and 10 s, of 600 s; in the order of their priority
    assert analysis.loads == (
        Load("geographer", 1, 300, 1.0, 1 / 600),
        Load("decider", 2, 10_000, 60.0, 0.1),
    )


def test_the_end_of_the_run_and_the_messages_of_each_topic(
    analysis: Analysis, run: list[Sent]
) -> None:
    assert (analysis.ended, analysis.duration_s) == ("done", 600.0)
    assert analysis.metadata["scenario"] == "two by two"
    counts = {topic: sum(sent.topic == topic for sent in run) for topic in TOPICS}
    assert list(analysis.topics.items()) == list(counts.items())


def test_a_log_without_an_end_is_inconclusive(run: list[Sent], make_log: MakeLog) -> None:
    analysis = analyse(make_log(run[:-1]))
    assert analysis.inconclusive
    assert analysis.reasons == ("the log does not say why the run ended",)
    assert analysis.duration_s == 598.0  # when the last message was said


def test_a_truncated_log_is_inconclusive(run_path: Path) -> None:
    run_path.write_bytes(run_path.read_bytes()[:-1])
    analysis = analyse(run_path)
    (reason,) = analysis.reasons
    assert reason.startswith("the log is truncated: it ends without a footer; ")
    assert analysis.verdict == "inconclusive"
    assert len(analysis.late) == 2  # what the log holds is told all the same


def test_a_log_cut_before_its_messages_is_inconclusive(run_path: Path) -> None:
    run_path.write_bytes(run_path.read_bytes()[:600])
    analysis = analyse(run_path)
    assert [reason.split(":")[0] for reason in analysis.reasons] == [
        "the log is truncated",
        "the log does not say why the run ended",
        "the ledger is empty",
    ]
    assert analysis.decisions[0].asked == 0
    assert analysis.decisions[0].slack_median_s is None


def test_a_lost_message_makes_a_log_inconclusive(run: list[Sent], make_log: MakeLog) -> None:
    without = [sent for sent in run if sent.topic != "deadline/missed"]
    assert analyse(make_log(without)).reasons == ("1 of the messages of world are not in the log",)


def test_a_process_that_died_makes_a_log_inconclusive(run: list[Sent], make_log: MakeLog) -> None:
    died = _changed(run, "run/ended", reason="process down: decider")
    (reason,) = analyse(make_log(died)).reasons
    assert reason == "the run ended because of a process down: decider"


def test_an_empty_ledger_is_no_success(run: list[Sent], make_log: MakeLog) -> None:
    silent = analyse(make_log([replace(run[-1], sequence=0)]))
    assert silent.reasons == ("the ledger is empty: no decision was settled",)


def test_a_belief_about_another_grid_is_inconclusive(run: list[Sent], make_log: MakeLog) -> None:
    other = _changed(run, "truth/building", corridors=np.ones(7, np.uint8))
    analysis = analyse(make_log(other))
    assert analysis.reasons == ("belief/map is about 4 corridors, truth/building has 7",)
    assert analysis.belief is None


def test_the_json_is_plain_strict_and_stable(analysis: Analysis) -> None:
    plain = to_json(analysis)
    assert json.loads(json.dumps(plain, allow_nan=False)) == plain
    assert list(plain) == [
        "path",
        "metadata",
        "verdict",
        "reasons",
        "ended",
        "duration_s",
        "decisions",
        "late",
        "errands",
        "sensing",
        "belief",
        "encounters",
        "refused",
        "loads",
        "topics",
    ]
    assert plain["decisions"][1]["causes"] == {"message lost": 1, "overrun": 1}
    assert plain["errands"]["each"][0]["goal"] == [1, 1]


def test_a_number_that_is_not_finite_becomes_nothing_in_json(
    run: list[Sent], make_log: MakeLog
) -> None:
    analysis = analyse(make_log(_changed(run, "truth/encounter", closest_m=math.inf)))
    assert to_json(analysis)["encounters"]["closest_m"] is None


def test_an_unknown_kind_of_decision_gets_its_own_row(run: list[Sent], make_log: MakeLog) -> None:
    analysis = analyse(make_log(_changed(run, "ledger", kind="lunch")))
    assert [(of.kind, of.asked) for of in analysis.decisions] == [
        ("sensing", 0),
        ("path", 0),
        ("reaction", 0),
        ("lunch", 5),
    ]


def test_what_is_not_a_log_is_refused(tmp_path: Path) -> None:
    with pytest.raises(LogReadError, match=r"nothing\.mcap: cannot be read"):
        analyse(tmp_path / "nothing.mcap")
