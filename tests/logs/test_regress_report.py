"""The report of a regression: text, JSON, JUnit."""

from __future__ import annotations

import json
from dataclasses import replace
from xml.etree import ElementTree

from logs.regress.regression import FAILED, GOOD, INCONCLUSIVE, Regression, regress
from logs.regress.report import SHOWN, junit, text_lines, to_json
from logs.regress.wall import compare_wall
from tests.logs.made_regress import summary, with_decision, with_work

WORSE = with_decision(with_work(summary(), 1, cells=44_000), 1, slack_ns=-1, cause="overrun")


def slower(*, blocks: bool) -> Regression:
    found = regress([summary()], [summary()], wall=blocks)
    wall = compare_wall([1.0 + k / 1000 for k in range(8)], [2.0 + k / 1000 for k in range(8)])
    return replace(found, runs=(replace(found.runs[0], wall=wall),))


def test_the_text_names_the_cause_and_what_changed() -> None:
    text = "\n".join(text_lines(regress([summary()], [WORSE])))
    assert "two by two, seed 7, profile host: failed" in text
    assert "cause: geographer's percept/departure takes 10.00 % more cells" in text
    assert "1 decisions changed, 1 of them late now" in text
    assert "sensing 2 (visit 2, asked at 200 s): slack 5 s -> -0.000000001 s, cause" in text
    assert "geographer's percept/departure: cells 40,000 -> 44,000 (+10.00 %)" in text


def test_the_text_leaves_out_what_is_too_much_and_says_so() -> None:
    text = "\n".join(text_lines(regress([summary(40)], [summary(0)])))
    assert f"and {40 - SHOWN} more" in text


def test_the_json_has_all_of_it() -> None:
    found = json.loads(json.dumps(to_json(regress([summary(40)], [summary(0)]))))
    (run,) = found["runs"]
    assert (found["outcome"], run["outcome"], run["seed"]) == (FAILED, FAILED, 7)
    assert len(run["checks"][0]["changes"]) == 40


def test_junit_counts_what_it_holds() -> None:
    found = regress(
        [summary(seed=1), summary(seed=2), summary(seed=3), summary(seed=4)],
        [
            summary(seed=1),
            replace(WORSE, identity=summary(seed=2).identity),
            replace(summary(seed=3), reasons=("it is cut",)),
        ],
    )
    suite = ElementTree.fromstring(junit(found))
    cases = suite.findall("testcase")
    assert suite.tag == "testsuite"
    assert suite.get("tests") == str(len(cases)) == "7"  # two checks of three runs, one missing
    assert suite.get("failures") == str(len(suite.findall("testcase/failure"))) == "2"
    assert suite.get("errors") == str(len(suite.findall("testcase/error"))) == "3"
    failure = suite.find("testcase/failure")
    assert failure is not None
    assert "geographer's percept/departure" in str(failure.get("message"))


def test_wall_time_is_advice_unless_asked() -> None:
    advice, asked = slower(blocks=False), slower(blocks=True)
    assert (advice.outcome, asked.outcome) == (GOOD, FAILED)
    assert "  (failed)      wall time: slower: +99." in "\n".join(text_lines(advice))
    assert "  failed        wall time: slower: +99." in "\n".join(text_lines(asked))
    assert ElementTree.fromstring(junit(advice)).get("failures") == "0"
    assert ElementTree.fromstring(junit(asked)).get("failures") == "1"


def test_asked_for_wall_time_that_is_not_there_is_no_verdict() -> None:
    found = regress([summary()], [summary()], wall=True)
    assert found.outcome == INCONCLUSIVE
    text = "\n".join(text_lines(found))
    assert "inconclusive  wall time: no wall stamps on both sides" in text
    suite = ElementTree.fromstring(junit(found))
    assert suite.get("errors") == "1"
