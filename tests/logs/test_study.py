"""What a study says of the made-up run (see conftest), by hand, and of a real one."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

import msgspec
import numpy as np
import pytest

from bus import messages as m
from bus.wire import Sent
from logs.analysis import analyse
from logs.loads import HandlerTimes, SpanRow
from logs.reader import LogReadError, read_run
from logs.run_log import RunLog
from logs.spread import Spread
from logs.study import Study, study, study_to_json
from tests.logs.conftest import EPOCH_NS

MakeLog: TypeAlias = Callable[[list[Sent]], Path]
S = 10**9


@pytest.fixture
def found(run_path: Path) -> Study:
    return study(run_path)


@pytest.fixture(scope="module")
def late(late_run: Path) -> Study:
    return study(late_run)


def test_it_says_what_an_analysis_says(found: Study, run_path: Path) -> None:
    assert found.analysis == analyse(run_path)


def test_handlers_and_their_waiting(found: Study) -> None:
    geographer, decider = found.processes
    # likelihood/junction is number 0 of the classifier, said at 66 s: after its handler began
    assert geographer.handlers == (
        HandlerTimes("likelihood/junction", 300, Spread(1, 1.0, 1.0, 1.0, 1.0)),
    )
    assert [(h.topic, h.cells, h.took.max_s) for h in decider.handlers] == [
        ("asked/path", 4000, 50.0),
        ("belief/map", 6000, 10.0),
    ]


def test_without_the_length_of_a_hop_all_waiting_is_queueing(
    run: list[Sent], tmp_path: Path
) -> None:
    asked = next(sent for sent in run if sent.topic == "asked/path")
    start_ns = asked.said_ns + 3 * S
    span = m.Span("decider", "asked/path", "world", asked.sequence, start_ns, start_ns + S, 1)
    waited = []
    for metadata in ({}, {"hop_ns": str(2 * S)}, {"hop_ns": str(9 * S)}):
        path = tmp_path / "RUN.mcap"
        with RunLog(path, EPOCH_NS, metadata, {}) as log:
            log.write(asked)
            log.write(Sent("clock/span", "clock", 0, -1, span.end_ns, (asked.id,), span))
        (process,) = study(path).processes
        waited.append((process.waited.max_s, process.waited_at_all))
    assert waited == [(3.0, 1), (1.0, 1), (0.0, 0)]


def test_a_hop_that_is_no_number_is_refused(run: list[Sent], tmp_path: Path) -> None:
    path = tmp_path / "RUN.mcap"
    with RunLog(path, EPOCH_NS, {"hop_ns": "soon"}, {}) as log:
        log.write(run[0])
    with pytest.raises(LogReadError, match="hop_ns: found 'soon', expected nanoseconds"):
        study(path)


def test_each_topic_that_spoke_is_counted(found: Study) -> None:
    by_topic = {of.topic: of for of in found.traffic}
    path = by_topic["asked/path"]
    assert (path.number, path.gaps) == (2, 0)
    assert path.rate_hz == pytest.approx(1 / 300)  # at 0 and at 300 s
    assert path.period == Spread(1, 300.0, 300.0, 300.0, 300.0)
    assert path.jitter_s is None
    ledger = by_topic["ledger"]  # at 50, 60, 252, 500, 560: periods 10, 192, 248, 60
    assert ledger.jitter_s == pytest.approx(float(np.std([10, 192, 248, 60])))
    assert "percept/sonar" not in by_topic


def test_a_message_that_the_next_one_names_is_missed(run: list[Sent], make_log: MakeLog) -> None:
    second = [sent for sent in run if sent.topic == "ledger"][1]
    found = study(make_log([sent for sent in run if sent is not second]))
    assert {of.topic: of.gaps for of in found.traffic if of.gaps} == {"ledger": 1}


def test_the_slack_is_spread(found: Study) -> None:
    sensing, path, reaction = found.slack
    assert path.quantiles_s == (-20.0, -20.0, -20.0, -20.0, 190.0, 190.0, 190.0)
    assert (path.edges_s[0], path.edges_s[-1]) == (-20.0, 190.0)
    assert path.counts == (1, 0, 0, 0, 0, 0, 0, 0, 0, 1)
    assert path.idle_s == {"message lost": 10.0, "overrun": 20.0}
    assert (sensing.number, sensing.idle_s, reaction.quantiles_s[3]) == (1, {}, 1.0)


def test_corridors_are_scored_by_hand(found: Study) -> None:
    corridors = found.calibration[3]
    # truth 1 0 1 1; believed .9 .5 .6 .5 and .999 .002 .995 .4
    missed = np.array([0.1, 0.5, 0.4, 0.5, 0.001, 0.002, 0.005, 0.6])
    assert corridors.distributions == 8
    assert corridors.brier == pytest.approx(float((2 * missed**2).mean()))
    assert corridors.log_score == pytest.approx(float(-np.log(1 - missed).mean()))
    assert sum(of.number for of in corridors.bins) == 16
    top = corridors.bins[-1]  # .9 .999 .995 true, .998 that corridor 1 is not: all true
    assert (top.low, top.number, top.true) == (0.9, 4, 1.0)
    assert top.mean == pytest.approx((0.9 + 0.999 + 0.995 + 0.998) / 4)


def test_a_truth_thought_impossible_is_counted_apart(run: list[Sent], make_log: MakeLog) -> None:
    sure = [
        replace(s, message=msgspec.structs.replace(s.message, corridors=np.array([0.0, 0, 1, 1])))
        if s.topic == "belief/map"
        else s
        for s in run
    ]
    corridors = study(make_log(sure)).calibration[3]
    assert (corridors.impossible, corridors.log_score) == (2, 0.0)
    assert corridors.brier == pytest.approx(0.5)  # one of four, each time wrong by 2


def test_the_json_is_strict_and_has_the_ledger(found: Study) -> None:
    plain = study_to_json(found)
    assert json.loads(json.dumps(plain, allow_nan=False)) == plain
    assert plain["verdict"] == "late"
    assert [entry["decision"] for entry in plain["ledger"]] == [1, 2, 3, 4, 6]


def test_spans_are_told_one_by_one(run_path: Path) -> None:
    told: list[SpanRow] = []
    study(run_path, told.append)
    assert told[1] == SpanRow("decider", "asked/path", "world", 2, 0, 0, 50 * S, 4000)
    assert len(told) == 3


def test_every_decision_of_a_real_run_has_its_whole_chain(late: Study) -> None:
    came = [entry for entry in late.ledger if entry.decided_ns >= 0]
    assert len(late.chains) == len(came) > 40
    assert late.unknown_parents == 0
    decided_ns = {entry.decision: entry.decided_ns for entry in came}
    for one in late.chains:
        chain = one.chain
        assert chain.whole
        assert chain.heard_ns == decided_ns[one.decision]
        assert sum(hop.total_ns for hop in chain.hops) == chain.response_ns
        assert chain.hops[0].topic.startswith(("percept/", "asked/"))
        assert all(hop.transport_ns == late.hop_ns for hop in chain.hops)
        assert all(hop.queueing_ns >= 0 for hop in chain.hops)
        assert one.slack_ns == one.until_ns - decided_ns[one.decision]


def test_late_chains_come_first_and_say_what_took_the_time(late: Study) -> None:
    slack_ns = [one.slack_ns for one in late.chains]
    assert slack_ns == sorted(slack_ns)
    worst = late.chains[0]
    assert worst.slack_ns < 0
    longest = worst.chain.longest
    assert longest is not None
    assert (longest[0].process, longest[1], longest[2]) == ("classifier", "computing", 45 * S)


def test_remembered_messages_are_named_as_parents(late_run: Path) -> None:
    with read_run(late_run) as reader:
        said = list(reader)
    topic_of = {sent.id: sent.topic for sent in said}
    parents = {
        topic: [
            {topic_of[parent] for parent in sent.parents} for sent in said if sent.topic == topic
        ]
        for topic in ("decision/path", "decision/sensing", "prior/junction", "belief/ranges")
    }
    assert all(of == {"asked/path", "belief/map"} for of in parents["decision/path"])
    assert all({"asked/sensing", "prior/junction"} <= of for of in parents["decision/sensing"])
    assert any("reading/feature" in of for of in parents["decision/sensing"])
    assert {"percept/departure", "percept/arrival", "likelihood/junction"} in parents[
        "prior/junction"
    ]
    assert {"percept/sonar", "percept/odometry"} in parents["belief/ranges"]
    scans = [len(sent.parents) for sent in said if sent.topic == "reading/feature"]
    assert min(scans) > 3  # the action that ended, and all that it heard
    assert all(len(set(sent.parents)) == len(sent.parents) for sent in said)


def test_a_real_run_is_placed_and_believed_rightly(late: Study) -> None:
    of = late.registration
    assert (of.right, of.wrong, of.unknown) == (of.beliefs, 0, 0)
    last = late.knowledge[-1].belief
    assert last == late.analysis.belief
    features, priors, junctions, corridors = late.calibration
    assert features.distributions == late.analysis.sensing.readings
    assert priors.distributions == late.registration.beliefs
    assert junctions.distributions == 9 * late.registration.beliefs
    assert corridors.impossible == junctions.impossible == priors.impossible == 0


def test_the_readings_of_a_real_path_are_in_order(late: Study) -> None:
    assert {path.topics[-1] for path in late.paths} >= {"decision/path", "decision/sensing"}
    for path in late.paths:
        for low, high in ((path.best, path.worst), (path.first, path.last)):
            assert (low.median_s or 0.0) <= (high.median_s or 0.0)
            assert (low.max_s or 0.0) <= (high.max_s or 0.0)
        assert path.all.max_s == path.worst.max_s == path.last.max_s
    # what a sensing decision was made from goes into the ones after it, too
    assert any((p.first.median_s or 0.0) < (p.last.median_s or 0.0) for p in late.paths)
