"""The data of a page: the right numbers, and never too many of them."""

from __future__ import annotations

import json
from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from bus import messages as m
from bus.wire import Sent
from logs.chains import Chain, DataAge, DecisionChain, Hop
from logs.page.data import (
    MOST_HOPS,
    MOST_IN_TIME,
    MOST_LATE,
    MOST_PINGS,
    as_script,
    notes,
    page_data,
)
from logs.page.plots import BINS, belief_figures, slack_bins, slack_figure
from logs.page.record import Record
from logs.page.spans import MOST, Spans
from logs.page.thin import evenly
from tests.logs.browser import Document
from tests.logs.conftest import S, Speaker, entry, may_be_at

TOO_LARGE = 8_000_000


def _recorded(said: list[Sent]) -> tuple[Record, list[m.LedgerEntry]]:
    record = Record()
    for sent in said:
        record.hear(sent)
    return record, [s.message for s in said if isinstance(s.message, m.LedgerEntry)]


def test_where_a_lost_robot_may_be_is_told_until_it_knows(run: list[Sent]) -> None:
    assert page_data(*_recorded(run), (), 600.0)["places"] == []
    said = [Speaker().say(3, may_be_at(1, [1, 2], [0.25, 0.75])), *run]
    data = page_data(*_recorded(said), (), 600.0)
    # the belief of visit 0 and that of visit 2 have no registrations beside them
    assert data["places"] == [[3, [2, 0.75], [1, 0.25]], [1, [0, 1.0]], [598, [0, 1.0]]]


def test_the_data_of_a_run(run: list[Sent]) -> None:
    record, ledger = _recorded(run)
    data = json.loads(as_script(page_data(record, ledger, (), 600.0)))
    assert data["building"]["ends"] == [[0, 1], [2, 3], [0, 2], [1, 3]]
    assert data["beliefs"] == [[1, 0.9, 0.5, 0.6, 0.5], [598, 0.999, 0.002, 0.995, 0.4]]
    assert data["goals"] == [[0, 3]]
    by_id = {decision["id"]: decision for decision in data["decisions"]}
    assert [by_id[n]["late"] for n in (1, 2, 3, 4, 6)] == [False, False, False, True, True]
    assert (by_id[6]["decided"], by_id[6]["slack"], by_id[6]["idle"]) == (None, None, 10)
    assert data["spans"]["decider"] == [[0, 50, 1, 4000, 50], [500, 510, 1, 6000, 10]]
    assert [meeting["collided"] for meeting in data["meetings"]] == [False, True]
    assert data["errands"][0] == [1, 0, 500, 400]
    assert data["notes"] == []


def test_a_chain_is_told_hop_by_hop_last_first_and_cut_where_it_is_long() -> None:
    ledger = [entry(number, "path", 0, 240, 50) for number in (1, 2)]
    hops = tuple(
        Hop("belief/map", "geographer", n, "decider", n * S, S // 1000, n * S, 2 * S)
        for n in range(MOST_HOPS + 1)
    )
    age = DataAge(12, 60 * S, S // 4)
    chains = [
        DecisionChain(
            *(number, "path", 0, 0, 240 * S, 190 * S),
            Chain("decision/path", "decider", number, 50 * S, None, some, True, age),
        )
        for number, some in ((1, hops[:2]), (2, hops))
    ]
    short, long = page_data(Record(), ledger, chains, 600.0)["decisions"]
    assert short["chain"] == [
        ["belief/map", "geographer", 1, "decider", 1, 0.001, 1, 2],
        ["belief/map", "geographer", 0, "decider", 0, 0.001, 0, 2],
    ]
    assert (short["whole"], short["age"]) == (True, [12, 0.25, 60])
    assert [hop[2] for hop in long["chain"]] == list(range(MOST_HOPS, 0, -1))
    assert not long["whole"]
    (alone,) = page_data(Record(), ledger[:1], (), 600.0)["decisions"]
    assert (alone["chain"], alone["age"]) == ([], None)


def test_data_cannot_end_its_element_and_is_strict_json() -> None:
    text = as_script({"words": "</script><!--", "far": float("inf"), "none": float("nan")})
    assert "<" not in text
    assert json.loads(text) == {"words": "</script><!--", "far": None, "none": None}


def test_a_long_run_is_thinned_and_the_page_says_so(run: list[Sent]) -> None:
    speaker = Speaker()
    for n in range(3 * MOST_PINGS):
        speaker.say(n, m.Sonar(n, 0, n * S, np.full(24, 10.7)))
        speaker.say(n, m.Span("sensor", "percept/sonar", "world", n, n * S + n, n * S + S // 3, 1))
    for n in range(4 * MOST_LATE):
        late = n % 2 == 1
        speaker.say(n, entry(n, "path", n, n + 9, n + 9 + n if late else n, cause="overrun" * late))
    record, ledger = _recorded(run[:1] + speaker.said)
    data = page_data(record, ledger, (), 3.0 * MOST_PINGS)
    assert len(data["pings"]) == MOST_PINGS
    assert (data["pings"][0][0], data["pings"][-1][0]) == (0, 3 * MOST_PINGS - 1)
    assert len(data["spans"]["sensor"]) <= 2 * MOST
    assert len(data["decisions"]) == MOST_LATE + MOST_IN_TIME
    lateness = [d["slack"] for d in data["decisions"] if d["late"]]
    assert max(lateness) < -2 * MOST_LATE + 2  # the milder half is what is left out
    assert len(as_script(data)) < TOO_LARGE / 2
    said = " ".join(notes(record, ledger))
    assert f"{MOST_PINGS:,} of {3 * MOST_PINGS:,} pings" in said
    assert "3,000 of 6,000 decisions" in said
    assert "is drawn as one bar" in said


@given(st.lists(st.integers(), max_size=50), st.integers(2, 20))
def test_thinning_keeps_order_and_ends(items: list[int], most: int) -> None:
    kept = evenly(list(enumerate(items)), most)
    assert len(kept) == min(len(items), most)
    assert kept == sorted(set(kept), key=lambda pair: pair[0])
    if items:
        assert (kept[0], kept[-1]) == ((0, items[0]), (len(items) - 1, items[-1]))


@given(st.lists(st.tuples(st.integers(0, 5), st.integers(0, 3)), min_size=1, max_size=9000))
def test_merged_spans_lose_no_work(pairs: list[tuple[int, int]]) -> None:
    spans, at = Spans(), 0
    for wait, work in pairs:
        spans.hear(m.Span("x", "t", "s", 0, at + wait, at + wait + work, 2))
        at += wait + work
    row = spans.rows()["x"]
    assert len(row) <= 2 * MOST
    assert sum(of.handlers for of in row) == len(pairs)
    assert sum(of.busy_ns for of in row) == sum(work for _, work in pairs)
    assert (row[0].start_ns, row[-1].end_ns) == (pairs[0][0], at)
    assert all(a.end_ns < b.start_ns for a, b in pairwise(row))


@given(st.lists(st.integers(-(10**15), 10**15), min_size=1, max_size=60))
def test_no_bar_of_a_histogram_is_both_late_and_in_time(slack_ns: list[int]) -> None:
    counts, edges = slack_bins(slack_ns)
    assert len(edges) == len(counts) + 1 <= BINS + 1
    assert 0.0 in edges
    assert edges[0] <= min(0, *slack_ns) / S and max(0, *slack_ns) / S <= edges[-1]
    assert counts[edges[:-1] < 0].sum() == sum(ns < 0 for ns in slack_ns)
    assert counts.sum() == len(slack_ns)


def test_slack_is_drawn_by_kind_and_told_as_a_table(run: list[Sent]) -> None:
    _, ledger = _recorded(run)
    drawn = Document(slack_figure("path", [e for e in ledger if e.kind == "path"]))
    (figure,) = drawn.all("figure")
    assert "2 path decisions came, 1 of them late" in figure.words  # the third never came
    assert [e.attributes["class"] for e in drawn.all("rect")] == ["late", "good"]
    assert [row.words.split()[-1] for row in drawn.all("tr")[1:]] == ["1", "1"]
    assert slack_figure("path", []) == ""


def test_the_belief_is_drawn_over_time(run: list[Sent]) -> None:
    record, _ = _recorded(run)
    drawn = Document(belief_figures(record.beliefs, 600.0))
    entropy, true_map, corridors = drawn.all("figure")
    assert "from 0.75 at 1 s to 0.25 at the end" in entropy.words
    assert "from 0.135 at 1 s to 0.607 at the end" in true_map.words
    assert "Corridors known rightly (solid)" in corridors.words
    assert drawn.all("tr")[-1].words == "598.0 0.250 0.606531 3 0 1"
