"""The response times of a path, by hand, and what holds of them for any."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from logs.ancestry import ancestors
from logs.paths import Paths
from logs.spread import Spread, spread
from tests.logs.made_index import MadeIndex

S = 10**9


def _spread(*seconds: float) -> Spread:
    return spread([round(s * S) for s in seconds])


def test_the_readings_of_a_path() -> None:
    index = MadeIndex()
    pings = [index.say("percept/sonar", "world", k, k * S) for k in range(6)]
    paths = Paths()
    first = index.say("decision/reaction", "reactor", 0, 4 * S, pings[1].id, pings[3].id)
    second = index.say("decision/reaction", "reactor", 1, 10 * S, pings[4].id, pings[5].id)
    for decision in (first, second):
        paths.decided(ancestors(index, decision))
    (path,) = paths.times()
    assert path.topics == ("percept/sonar", "decision/reaction")
    assert (path.inputs, path.decisions) == (4, 2)
    assert path.all == _spread(3, 1, 6, 5)  # each input: 4-1, 4-3, 10-4, 10-5
    assert path.best == _spread(1, 5)  # the newest: 4-3, 10-5
    assert path.worst == _spread(3, 6)  # the oldest: 4-1, 10-4
    assert path.worst_with_external_latency == _spread(7)  # newest of the decision before: 10-3
    assert path.first == path.last == path.all  # no input went into both


def test_the_first_and_the_last_decision_of_an_input() -> None:
    index = MadeIndex()
    pings = [index.say("percept/sonar", "world", k, k * S) for k in range(4)]
    paths = Paths()
    for k, (at_s, used) in enumerate(((2, pings[:2]), (5, pings[1:3]), (9, pings[1:2]))):
        names = [ping.id for ping in used]
        decision = index.say("decision/reaction", "reactor", k, at_s * S, *names)
        paths.decided(ancestors(index, decision))
    (path,) = paths.times()
    assert (path.inputs, path.decisions) == (3, 3)  # ping 3 came to no decision
    assert path.all == _spread(2, 1, 4, 3, 8)
    assert path.first == _spread(2, 1, 3)  # 2-0, 2-1, 5-2
    assert path.last == _spread(2, 8, 3)  # 2-0, 9-1, 5-2
    assert path.best == _spread(1, 3, 8)  # 2-1, 5-2, 9-1
    assert path.worst == _spread(2, 4, 8)  # 2-0, 5-1, 9-1
    assert path.worst_with_external_latency == _spread(4, 7)  # 5-1, 9-2


_USED = st.lists(
    st.tuples(st.integers(0, 9), st.sets(st.integers(0, 7), min_size=1)), min_size=1, max_size=8
)


@given(_USED)
def test_readings_bound_each_other(decisions: list[tuple[int, set[int]]]) -> None:
    """Decisions some time apart, each made from any of the eight inputs that came before them."""
    index = MadeIndex()
    pings = [index.say("percept/sonar", "world", k, k) for k in range(8)]
    paths, at_ns = Paths(), 8
    for number, (pause_ns, used) in enumerate(decisions):
        at_ns += pause_ns
        names = [pings[k].id for k in sorted(used)]
        decision = index.say("decision/path", "decider", number, at_ns, *names)
        paths.decided(ancestors(index, decision))
    (path,) = paths.times()
    for low, high in ((path.best, path.worst), (path.first, path.last)):
        assert low.number == high.number
        for of in ("min_s", "median_s", "p95_s", "max_s"):
            assert getattr(low, of) <= getattr(high, of)
    assert path.all.min_s == path.best.min_s == path.first.min_s
    assert path.all.max_s == path.worst.max_s == path.last.max_s
    assert path.inputs == len(set().union(*(used for _, used in decisions)))


def test_ways_over_other_topics_are_other_paths_and_the_shortest_counts() -> None:
    index = MadeIndex()
    ping = index.say("percept/sonar", "world", 0, 0)
    ranges = index.say("belief/ranges", "sensor", 0, S, ping.id)
    reading = index.say("reading/feature", "detectors", 0, 2 * S, ranges.id)
    asked = index.say("asked/sensing", "world", 1, 2 * S)
    decision = index.say(
        "decision/sensing", "classifier", 0, 3 * S, asked.id, reading.id, ranges.id
    )
    paths = Paths()
    paths.decided(ancestors(index, decision))
    assert [path.topics for path in paths.times()] == [
        ("asked/sensing", "decision/sensing"),
        ("percept/sonar", "belief/ranges", "decision/sensing"),
    ]


def test_a_quantile_is_a_time_that_occurred() -> None:
    assert _spread(4, 1, 3, 2) == Spread(4, 1.0, 2.0, 4.0, 4.0)
    assert spread([]) == Spread(0)
