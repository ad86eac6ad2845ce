"""[[expect]] tables: each holds where it should, and fails the launch where it does not."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest

from bus import messages as m
from bus.topics import PRIORITY, TOPIC_OF
from bus.wire import Sent
from logs.analysis import Analysis, analyse
from logs.run_log import RunLog
from scenarios.expectations import Verdict, judge
from scenarios.scenario import Expect
from tests.scenarios.launches import SHORT, waywiser

S = 10**9


def said(*messages: m.Message) -> list[Sent]:
    """Messages as the bus numbers them, one a second."""
    sequence: dict[str, int] = dict.fromkeys(PRIORITY, -1)
    sent: list[Sent] = []
    for k, message in enumerate(messages):
        topic = TOPIC_OF[type(message)]
        before = [s.sequence for s in sent if s.topic == topic.name]
        sequence[topic.publisher] = number = sequence.get(topic.publisher, -1) + 1
        last = before[-1] if before else -1
        sent.append(Sent(topic.name, topic.publisher, number, last, k * S, (), message))
    return sent


def settled(decision: int, kind: str, slack_s: float) -> m.LedgerEntry:
    """A decision asked at 0 s for 10 s; late ones are overruns."""
    decided_ns = 10 * S - round(slack_s * S)
    cause = "" if slack_s >= 0 else "overrun"
    return m.LedgerEntry(
        decision, kind, 1, 0, 10 * S, decided_ns, round(slack_s * S), 5, 1, 0, "", cause
    )


@pytest.fixture
def analysis(tmp_path: Path) -> Analysis:
    """Sensing decided in time, one path of two 1.5 s late, one errand done, one collision."""
    path = tmp_path / "run.mcap"
    with RunLog(path, 0, {}, {}) as log:
        for sent in said(
            settled(1, "sensing", 4.0),
            settled(2, "path", 2.5),
            settled(3, "path", -1.5),
            m.TrueErrand(0, 0, 1, 0, 9 * S, 8.0),
            m.TrueEncounter(1, True, 0.1, 3.0),
            m.RunEnded("done"),
        ):
            log.write(sent)
    return analyse(path)


CASES = [
    (Expect(late=0), "all decisions late: at most 0", "1", False),
    (Expect(late=1), "all decisions late: at most 1", "1", True),
    (Expect(decision="sensing", late=0), "sensing decisions late: at most 0", "0", True),
    (Expect(decision="path", late=0), "path decisions late: at most 0", "1", False),
    (Expect(slack_at_least_s=-1.5), "all decisions' slack: at least -1.5 s", "-1.500 s", True),
    (Expect(slack_at_least_s=-1.4), "all decisions' slack: at least -1.4 s", "-1.500 s", False),
    (
        Expect(decision="sensing", slack_at_least_s=4.0),
        "sensing decisions' slack: at least 4 s",
        "4.000 s",
        True,
    ),
    (
        Expect(decision="reaction", slack_at_least_s=1.0),
        "reaction decisions' slack: at least 1 s",
        "no decision",
        True,
    ),
    (Expect(errands_done="all"), "errands done: 2", "1", False),
    (Expect(errands_done=1), "errands done: 1", "1", True),
    (Expect(errands_done=0), "errands done: 0", "1", True),
    (
        Expect(true_map_at_least=0.5),
        "probability of the true map: at least 0.5",
        "no belief",
        False,
    ),
    (Expect(collisions=0), "collisions: at most 0", "1", False),
    (Expect(collisions=1), "collisions: at most 1", "1", True),
]


@pytest.mark.parametrize(("expect", "expected", "found", "holds"), CASES)
def test_verdict(
    analysis: Analysis, expect: Expect, expected: str, found: str, holds: bool
) -> None:
    assert judge([expect], analysis, errands=2) == [Verdict(expected, found, holds)]


def test_one_table_may_ask_for_several_things(analysis: Analysis) -> None:
    verdicts = judge([Expect(late=1, collisions=0)], analysis, errands=1)
    assert [verdict.holds for verdict in verdicts] == [True, False]


def run(tmp_path: Path, *expects: str) -> tuple[int, list[Verdict], str]:
    path, log = tmp_path / "short.toml", str(tmp_path / "run.mcap")
    path.write_text(SHORT + "".join(f"[[expect]]\n{expect}\n" for expect in expects))
    ended = waywiser("launch", str(path), "--in-process", "--log", log, "--json")
    words = waywiser("launch", str(path), "--in-process", "--log", log)
    assert words.status == ended.status
    return ended.status, msgspec.convert(ended.json["expectations"], list[Verdict]), words.out


def test_a_launch_whose_expectations_hold_ends_with_0(tmp_path: Path) -> None:
    status, verdicts, words = run(
        tmp_path, "late = 0", 'errands_done = "all"', "true_map_at_least = 0.99", "collisions = 0"
    )
    assert status == 0
    assert [verdict.holds for verdict in verdicts] == [True] * 4
    assert "expected all decisions late: at most 0: found 0, holds\n" in words


def test_a_launch_says_which_expectation_does_not_hold_and_ends_with_1(tmp_path: Path) -> None:
    status, verdicts, words = run(tmp_path, "late = 0", "errands_done = 2")
    assert status == 1
    assert [verdict.holds for verdict in verdicts] == [True, False]
    assert "expected errands done: 2: found 1, does not hold\n" in words


def test_the_true_map_is_found_with_the_probability_that_the_belief_gives_it(
    tmp_path: Path,
) -> None:
    status, (verdict,), _ = run(tmp_path, "true_map_at_least = 1.0")
    assert verdict.expected == "probability of the true map: at least 1.0"
    # One corridor is the only map of this grid.
    assert (status, verdict.found, verdict.holds) == (0, "1.0000", True)
