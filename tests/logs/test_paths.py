"""The four response times of a path, by hand."""

from __future__ import annotations

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
    assert path.cycles == 2
    assert path.all == _spread(3, 1, 6, 5)  # each input: 4-1, 4-3, 10-4, 10-5
    assert path.best == _spread(1, 5)  # the newest: 4-3, 10-5
    assert path.worst == _spread(3, 6)  # the oldest: 4-1, 10-4
    assert path.worst_with_external_latency == _spread(7)  # newest of the cycle before: 10-3


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
